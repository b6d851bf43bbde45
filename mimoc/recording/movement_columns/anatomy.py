"""Which part of the body, or which other thing, each body and each geom of a model belongs to."""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees

IntArray = npt.NDArray[np.intp]
SCENE = "scene"
"""What has no name of its own and does not move."""


@dataclass(frozen=True)
class Parts:
    """Parts of an infant's body: its bodies, but hands with their fingers, feet with their toes, head with its eyes."""

    model: mujoco.MjModel
    manifest: Manifest

    @cached_property
    def whole(self) -> tuple[str, ...]:
        """Bodies that what hangs on them is a part of."""
        anatomy = self.manifest.anatomy
        ends = [limb.end for limb in (*anatomy.arms, *anatomy.legs)]
        return tuple(body for body in (*ends, anatomy.head) if body)

    @cached_property
    def bodies(self) -> IntArray:
        """The infant's bodies."""
        root = self.model.body(self.manifest.root_body).id
        return np.flatnonzero(in_subtrees(self.model, [root]))

    @cached_property
    def part_of_body(self) -> dict[int, str]:
        """The name of the part that each of its bodies belongs to, in the model's order."""
        parts = {int(body): self.model.body(body).name for body in self.bodies}
        for name in self.whole:
            inside = np.flatnonzero(in_subtrees(self.model, [self.model.body(name).id]))
            parts |= dict.fromkeys(inside.tolist(), name)
        return parts

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
        return {int(self.model.body(item.body).id): item.name for item in self.manifest.objects}

    def _thing(self, geom: int) -> str:
        """Return what a geom belongs to: a part, an object, a fixed thing named as its geom, or the body that moves."""
        body = int(self.model.geom_bodyid[geom])
        if body in self.part_of_body:
            return self.part_of_body[body]
        if (outermost := int(self.model.body_rootid[body])) in self.objects:
            return self.objects[outermost]
        if self.model.body_weldid[body] == 0:
            return self.model.geom(geom).name or self.model.body(body).name or SCENE
        return self.model.body(body).name or self.model.geom(geom).name or SCENE
