"""An infant put into the world of its spec, with toys around it."""

from dataclasses import dataclass, field, replace

import numpy as np

from mimoc.body import BodyTree
from mimoc.body.kinematics import FloatArray
from mimoc.errors import NoRoomError
from mimoc.scene.chance import stream
from mimoc.scene.footprint import floor_reach, footprint, reach_of
from mimoc.scene.props import make_prop
from mimoc.scene.room import Decor
from mimoc.scene.toys.builtin import BUILTIN
from mimoc.scene.toys.choosing import Toybox, choose_toys
from mimoc.scene.toys.placing import Floor, Reach, place_toys
from mimoc.scene.tree import Keyframe, Prop, SceneTree
from mimoc.scene.world import WORLDS, Setting, moved, put
from mimoc.schema.scene import SceneSpec

BUILTIN_TOYS = Toybox(tuple(BUILTIN), lambda name: BUILTIN[name]())


@dataclass(frozen=True, slots=True)
class Supplies:
    """What scenes are made of that does not follow from a spec alone."""

    decor: Decor = field(default_factory=Decor)
    """What rooms are decorated with."""
    toybox: Toybox = BUILTIN_TOYS
    """What toys there are."""


def outline(scene: SceneTree, spec: SceneSpec, tree: BodyTree) -> FloatArray:
    """Return the discs of floor that an infant takes up in all its poses, shape (n, 3); none where nobody asks."""
    if spec.toys is None and spec.kind in ("empty", "flat"):
        return np.empty((0, 3))
    return footprint(tree, [pose.qpos for pose in scene.keyframes])


def furnish(
    scene: SceneTree, spec: SceneSpec, tree: BodyTree, supplies: Supplies, discs: FloatArray | None = None
) -> SceneTree:
    """Return a scene with the world of its spec, and the infant's poses where they are in that.

    Args:
        scene: The infant, with its poses resting on the floor at the origin.
        spec: What is wanted.
        tree: The infant's body.
        supplies: What to make the world of.
        discs: The infant's `outline`, if it is known already: it is the same for every seed.

    Raises:
        NoRoomError: If there is no room for a toy.
        ToyError: If nothing can be made of a toy.
    """
    discs = outline(scene, spec, tree) if discs is None else discs
    setting = WORLDS[spec.kind](spec, supplies.decor, tree, discs)
    starts = {pose.name: put(pose, setting.start) for pose in scene.keyframes}
    props = _toys(spec, setting, tree, starts[spec.pose], moved(discs, setting.start), supplies.toybox)
    resting = tuple(number for prop in props for number in (*prop.pos_m, *prop.quat))
    return replace(
        scene,
        world=replace(setting.world, props=props),
        keyframes=tuple(replace(start, qpos=(*start.qpos, *resting)) for start in starts.values()),
    )


def _toys(
    spec: SceneSpec, setting: Setting, tree: BodyTree, start: Keyframe, taken: FloatArray, toybox: Toybox
) -> tuple[Prop, ...]:
    """Return the toys of a scene, around where the infant starts and clear of the discs that are taken."""
    if spec.toys is None:
        return ()
    toys = choose_toys(spec.toys, spec.seed, toybox)
    here = start.qpos
    reach = floor_reach(tree, here) or Reach((here[0], here[1]), reach_of(taken - (*here[:2], 0.0)), 0.1)
    places = place_toys(
        [toy.radius_m for toy in toys], reach, Floor(setting.half_size_m, taken), stream(spec.seed, "toys.place")
    )
    if places is None:
        raise NoRoomError(
            f"there is no room for {len(toys)} toys around the infant; use fewer, smaller ones or a larger room"
        )
    return tuple(make_prop(toy, number, place) for number, (toy, place) in enumerate(zip(toys, places, strict=True), 1))
