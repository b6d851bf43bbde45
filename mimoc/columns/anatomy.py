"""Which part of the body, or which other thing, each body and each geom of a model belongs to."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.objects.spec_base import ObjectEntry
from mimoc.runtime.infant import Infant

IntArray = npt.NDArray[np.intp]
SCENE = "scene"
"""What has no name of its own and does not move."""


@dataclass(frozen=True)
class Parts:
    """Parts of an infant's body: its bodies, but hands with their fingers, feet with their toes, head with its eyes.

    Its own parts are named as those of an infant that is alone; those of others in its world begin with their names,
    such as `ben_left_hand`.
    """

    model: mujoco.MjModel
    manifest: Manifest
    others: Sequence[Manifest] = ()
    """The infants that share its world."""
    object_entries: Sequence[ObjectEntry] = ()
    """The objects of the scene."""

    @classmethod
    def of(cls, infant: Infant) -> "Parts":
        """Return the parts of an infant, and what else there is where it is."""
        others = [other.manifest for other in infant.simulation.infants.values() if other is not infant]
        return cls(infant.model, infant.manifest, others, infant.simulation.bundle.manifest.objects)

    @cached_property
    def whole(self) -> tuple[str, ...]:
        """Bodies that what hangs on them is a part of."""
        return _whole(self.manifest)

    @cached_property
    def bodies(self) -> IntArray:
        """The infant's bodies."""
        return _bodies(self.model, self.manifest)

    @cached_property
    def part_of_body(self) -> dict[int, str]:
        """The name of the part that each of its bodies belongs to, in the model's order."""
        parts = _parts_of_bodies(self.model, self.manifest)
        return {body: self.manifest.of_infant(name) for body, name in parts.items()}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all parts, in the model's order."""
        return tuple(dict.fromkeys(self.part_of_body.values()))

    @cached_property
    def things(self) -> tuple[str, ...]:
        """Names of its parts, then of all else that there is in the model."""
        return tuple(dict.fromkeys((*self.names, *map(self._thing, range(self.model.ngeom)))))

    @cached_property
    def thing_of_geom(self) -> IntArray:
        """Index in `things` of what each geom belongs to, shape (ngeom,)."""
        index = {name: number for number, name in enumerate(self.things)}
        return np.array([index[self._thing(geom)] for geom in range(self.model.ngeom)], np.intp)

    @cached_property
    def objects(self) -> dict[int, str]:
        """The name of each of the spec's objects, by its outermost body."""
        return {int(self.model.body(item.body).id): item.name for item in self.object_entries}

    @cached_property
    def _part_of_others(self) -> dict[int, str]:
        parts = (_parts_of_bodies(self.model, other) for other in self.others)
        return {body: name for of_other in parts for body, name in of_other.items()}

    def _thing(self, geom: int) -> str:
        """Return what a geom belongs to: a part, an object, a fixed thing named as its geom, or the body that moves."""
        body = int(self.model.geom_bodyid[geom])
        if part := self.part_of_body.get(body) or self._part_of_others.get(body):
            return part
        if (outermost := int(self.model.body_rootid[body])) in self.objects:
            return self.objects[outermost]
        if self.model.body_weldid[body] == 0:
            return self.model.geom(geom).name or self.model.body(body).name or SCENE
        return self.model.body(body).name or self.model.geom(geom).name or SCENE


def _whole(manifest: Manifest) -> tuple[str, ...]:
    anatomy = manifest.anatomy
    ends = [limb.end for limb in (*anatomy.arms, *anatomy.legs)]
    return tuple(body for body in (*ends, anatomy.head) if body)


def _bodies(model: mujoco.MjModel, manifest: Manifest) -> IntArray:
    return np.flatnonzero(in_subtrees(model, [model.body(manifest.root_body).id]))


def _parts_of_bodies(model: mujoco.MjModel, manifest: Manifest) -> dict[int, str]:
    """Return the name, in the model, of the part that each body of an infant belongs to, in the model's order."""
    parts = {int(body): model.body(body).name for body in _bodies(model, manifest)}
    for name in _whole(manifest):
        inside = np.flatnonzero(in_subtrees(model, [model.body(name).id]))
        parts |= dict.fromkeys(inside.tolist(), name)
    return parts
