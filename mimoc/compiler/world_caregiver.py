"""The caregiver of a world with several infants: whom it is by, and where it is within none of the others."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.body.origins import Entry
from mimoc.bundle.world import START
from mimoc.companions.caregiver.build import HEAD, BuiltCaregiver, place_caregiver, settings_at
from mimoc.companions.caregiver.spec import CaregiverEntry, CaregiverSpec
from mimoc.compiler.building import Builder
from mimoc.compiler.model_template import model_without_pictures
from mimoc.compiler.world_places import InfantPart, Poses, Settings
from mimoc.mjcf.world import Persona

IntArray = npt.NDArray[np.intp]
GAP_M = 0.02
"""Between it and the other infants at least, as all start; an assumption."""
PLACES = (
    {"place": "in_front"},
    {"place": "beside", "side": "left"},
    {"place": "beside", "side": "right"},
    {"place": "above"},
)
"""Where it is tried, unless its spec says where it is."""


@dataclass(frozen=True)
class WorldCaregiver:
    """A caregiver at its place by one of several infants."""

    infant: str
    """The infant that it is by."""
    built: BuiltCaregiver
    entries: Mapping[str, CaregiverEntry]
    """What the manifest of each infant says of it: the face and the kicks in it are that infant's."""

    @property
    def persona(self) -> Persona:
        """All of it that stands in the MJCF."""
        return self.built.persona

    @property
    def origins(self) -> Mapping[str, Entry]:
        """Where its numbers come from."""
        return self.built.origins

    def settings_at(self, builders: Mapping[str, Builder], poses: Poses) -> Settings:
        """Return what a keyframe says of its bodies."""
        return settings_at(self.built, builders[self.infant].tree, poses[self.infant].qpos)

    def in_the_way(self, mjcf: Mapping[str, bytes], parts: Mapping[str, InfantPart]) -> str:
        """Return another infant that it would be within as all start, or that would hide its infant from it, or ""."""
        model = model_without_pictures(mjcf)
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(START).id)
        mujoco.mj_kinematics(model, data)
        entry = self.entries[self.infant]
        adult = [model.body(body.name).id for body in self.persona.bodies]
        own = np.flatnonzero(np.isin(model.geom_bodyid, adult))
        head, face = data.body(entry.head), data.body(f"{parts[self.infant].prefix}{HEAD}")
        way_m = face.xpos - head.xpos
        hit = np.full(1, -1, np.int32)
        model.geom_matid[:], model.geom_rgba[:, 3] = -1, 1.0
        model.geom_rgba[own, 3] = 0.0  # Rays pass through what is not drawn.
        mujoco.mj_ray(model, data, head.xpos, way_m, None, 0, -1, hit)
        seen = model.body_rootid[model.geom_bodyid[hit[0]]] if hit[0] >= 0 else -1
        for name, part in parts.items():
            root = model.body(part.tree.roots[0].name).id
            theirs = np.flatnonzero(model.body_rootid[model.geom_bodyid] == root)
            if name != self.infant and (seen == root or _are_near(model, data, own, theirs)):
                return name
        return ""


def _are_near(model: mujoco.MjModel, data: mujoco.MjData, own: IntArray, theirs: IntArray) -> bool:
    """Return whether any two geoms of two groups are nearer to each other than `GAP_M`."""
    apart_m = np.linalg.norm(data.geom_xpos[own][:, None] - data.geom_xpos[theirs], axis=2)
    reach_m = model.geom_rbound[own][:, None] + model.geom_rbound[theirs] + GAP_M
    pairs = np.argwhere(apart_m < reach_m).tolist()
    return any(
        mujoco.mj_geomDistance(model, data, own[one], theirs[other], GAP_M, None) < GAP_M for one, other in pairs
    )


def caregivers(
    spec: CaregiverSpec, builders: Mapping[str, Builder], parts: Mapping[str, InfantPart]
) -> Iterator[WorldCaregiver]:
    """Yield the caregiver at each place that it can have by an infant, the most usual first."""
    is_free = not {"place", "side", "height_cm"} & spec.model_fields_set and len(parts) > 1
    infant = spec.infant or next(iter(parts))
    for place in PLACES if is_free else ({},):
        placed = spec.model_copy(update=place)
        built = {
            name: place_caregiver(placed, builders[name].tree, part.poses[part.start].qpos, part.prefix)
            for name, part in parts.items()
        }
        own = {name: one for name, one in built.items() if one}
        about = {"infant": infant, "answers_all": spec.infant is None}
        yield WorldCaregiver(
            infant, own[infant], {name: one.entry.model_copy(update=about) for name, one in own.items()}
        )
