"""An infant at all ages, as arrays that a page interpolates: its solids, joints, poses, eyes and skin points."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc import fits
from mimoc.base.errors import MimocError
from mimoc.bundle.manifest import ChildEntry, Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.bundle.variants import Variant
from mimoc.fits.standards import percentile
from mimoc.render.plots import Line
from mimoc.runtime.sense import bind_sense
from mimoc.studies.growth_plots import PERCENTILES, who_chart
from mimoc.viewer.encoding import Places

IntArray = npt.NDArray[np.intp]
ByAge = Callable[[str, str], npt.NDArray[Any]]

AGES_MONTHS = (*(week / 4 for week in range(4)), *(half / 2 for half in range(2, 12)), *range(6, 19), 20.0, 22.0, 24.0)
"""Ages of which a page has the numbers, close together where children grow fastest. Between them it interpolates
linearly: places and sizes of solids are then off by 0.2 mm at most, and joint limits by 0.06 degrees."""
SKIN_AGES_MONTHS = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 18.0, 24.0)
"""Those for thousands of points: linear interpolation is off by 1 mm at most."""


@dataclass(frozen=True, slots=True)
class Own:
    """Which parts of a model are the infant's."""

    bodies: IntArray
    geoms: IntArray
    joints: IntArray
    cameras: IntArray
    qpos: IntArray  # Addresses of the three numbers of the root's place, the four of its orientation, and each hinge.


def own_parts(model: mujoco.MjModel, manifest: Manifest) -> Own:
    """Return which parts of a model are the infant's; MimocError if it has joints that are no hinges."""
    mine = in_subtrees(model, [model.body(manifest.root_body).id])
    root = model.joint(manifest.root_joint).id
    joints = np.flatnonzero(mine[model.jnt_bodyid] & (np.arange(model.njnt) != root))
    if (model.jnt_type[joints] != mujoco.mjtJoint.mjJNT_HINGE).any():
        raise MimocError(f"'{manifest.name}' has joints that are no hinges; a page can show hinges only")
    first = model.jnt_qposadr[root]
    return Own(
        bodies=np.flatnonzero(mine),
        geoms=np.flatnonzero(mine[model.geom_bodyid]),
        joints=joints,
        cameras=np.array([model.camera(eye.camera).id for eye in manifest.anatomy.eyes], int),
        qpos=np.concatenate([np.arange(first, first + 7), model.jnt_qposadr[joints]]),
    )


def describe_growth(variants: Sequence[Variant], ages_months: Sequence[float]) -> dict[str, Any]:
    """Return an infant's body at some ages, the first axis of arrays that change; MimocError if its parts change."""
    parts = [own_parts(variant.model, variant.bundle.manifest) for variant in variants]
    counts = {tuple(len(getattr(infant, name)) for name in Own.__slots__) for infant in parts}
    if len(counts) > 1:
        raise MimocError(f"'{variants[0].bundle.manifest.name}' has other parts at other ages; a page cannot show that")
    at_ages = list(zip([variant.model for variant in variants], parts, strict=True))

    def by_age(name: str, kind: str) -> npt.NDArray[Any]:
        """Return an array of a model at each age, of what is the infant's."""
        return np.stack([getattr(model, name)[getattr(infant, kind)] for model, infant in at_ages])

    return {"ages_months": list(ages_months), **_anatomy(*at_ages[0], by_age), "poses": dict(_poses(variants, parts))}


def _anatomy(model: mujoco.MjModel, infant: Own, by_age: ByAge) -> dict[str, Any]:
    number = {body: index for index, body in enumerate(infant.bodies.tolist())}
    return {
        "bodies": {
            "names": [model.body(body).name for body in infant.bodies],
            "parent": np.array([number.get(model.body_parentid[body], -1) for body in infant.bodies]),
            "quat": model.body_quat[infant.bodies],
            "pos": by_age("body_pos", "bodies"),
        },
        "joints": {
            "names": [model.joint(joint).name for joint in infant.joints],
            "body": np.array([number[body] for body in model.jnt_bodyid[infant.joints]], int),
            "axis": model.jnt_axis[infant.joints],
            "reference": model.qpos0[infant.qpos[7:]],
            "pos": by_age("jnt_pos", "joints"),
            "range": by_age("jnt_range", "joints"),
        },
        "geoms": {
            "names": [model.geom(geom).name for geom in infant.geoms],
            "body": np.searchsorted(infant.bodies, model.geom_bodyid[infant.geoms]),
            "type": model.geom_type[infant.geoms],
            "material": model.geom_matid[infant.geoms],
            "group": model.geom_group[infant.geoms],
            "solid": (model.geom_contype | model.geom_conaffinity)[infant.geoms] != 0,
            "quat": model.geom_quat[infant.geoms],
            "pos": by_age("geom_pos", "geoms"),
            "size": by_age("geom_size", "geoms"),
        },
        "eyes": {
            "names": [model.camera(camera).name for camera in infant.cameras],
            "body": np.searchsorted(infant.bodies, model.cam_bodyid[infant.cameras]),
            "quat": model.cam_quat[infant.cameras],
            "fovy_deg": model.cam_fovy[infant.cameras],
            "pos": by_age("cam_pos", "cameras"),
        },
    }


def describe_touch(variants: Sequence[Variant], ages_months: Sequence[float]) -> dict[str, Any] | None:
    """Return the skin points of an infant at some ages, in the frames of their bodies; None if it feels nothing."""
    if variants[0].bundle.manifest.senses.touch is None:
        return None
    senses = [bind_sense("touch", variant.bundle, variant.model) for variant in variants]
    bodies = own_parts(variants[0].model, variants[0].bundle.manifest).bodies.tolist()
    return {
        "ages_months": list(ages_months),
        "body": np.array([bodies.index(body) for body in senses[0].receptors.bodies]),
        "points": Places(np.stack([sense.receptors.points_m for sense in senses])),
    }


def _poses(variants: Sequence[Variant], parts: Sequence[Own]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    for pose in variants[0].bundle.manifest.poses:
        if all(pose in variant.bundle.manifest.poses for variant in variants):
            keys = [variant.model.key(pose).qpos[infant.qpos] for variant, infant in zip(variants, parts, strict=True)]
            yield pose, np.stack(keys)


def posed(variant: Variant) -> mujoco.MjData:
    """Return the state of an infant in the pose that its spec says, with what is derived from it."""
    data = mujoco.MjData(variant.model)
    mujoco.mj_resetDataKeyframe(variant.model, data, variant.model.key(variant.bundle.manifest.pose).id)
    mujoco.mj_forward(variant.model, data)
    return data


MEASURES = ("length_cm", "weight_kg", "head_circumference_cm")


def describe_standards(children: Sequence[ChildEntry]) -> dict[str, Any]:
    """Return WHO's percentiles by age for children of a sex, and the measures of a child, given at each age.

    Of a child whose size is not known there are the measures only, and None for percentiles.
    """
    reference = children[0].sex or "mean"
    is_known = children[0].size_is_known
    ages_months = [child.age_months for child in children]
    charts = {}
    for name in MEASURES:
        values = [getattr(child, name) for child in children]
        standard = fits.load_tables().who[name]
        scores = [standard.z_score(value, age, reference) for value, age in zip(values, ages_months, strict=True)]
        chart = who_chart(name, reference) if is_known else replace(who_chart(name, reference), bands=(), lines=())
        charts[name] = {
            "plot": replace(chart, lines=(*chart.lines, Line(ages_months, values, "", "own"))).to_data(),
            "percentile": np.array([percentile(score) for score in scores]) if is_known else None,
        }
    return {"reference": reference, "percentiles": PERCENTILES if is_known else None, "charts": charts}
