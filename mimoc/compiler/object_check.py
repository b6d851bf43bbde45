"""Whether the objects of a spec are inside of anything in the poses of an infant."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from mimoc.base.errors import ObjectError
from mimoc.bundle.model import TOUCH_M
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree
from mimoc.compiler.model_template import model_without_pictures
from mimoc.compiler.objects.built_object import PlacedThing
from mimoc.schema.objects import ObjectSpec

LONGER_M = 1e-5  # By how much the way of a ribbon may be longer than that is: numbers are rounded.


def free_poses(
    scene: SceneTree, start: str, specs: Sequence[ObjectSpec], things: Sequence[PlacedThing]
) -> tuple[Keyframe, ...]:
    """Return the poses of a scene in which no object is inside of the infant, of another object or of furniture.

    Nor is a ribbon shorter than its way in any of them.

    Raises:
        ObjectError: If the pose in which the infant starts is none of them.
    """
    if not things:
        return scene.keyframes
    bare = scene.without_skin
    model = model_without_pictures({**printing.render_infant(bare), **printing.render_world(bare, b"")})
    return free_keyframes(model, scene.keyframes, start, specs, things)


def free_keyframes(
    model: mujoco.MjModel,
    keyframes: Sequence[Keyframe],
    start: str,
    specs: Sequence[ObjectSpec],
    things: Sequence[PlacedThing],
) -> tuple[Keyframe, ...]:
    """Return those keyframes of a model that are as `free_poses` says.

    Raises:
        ObjectError: If the one of the name *start* is none of them.
    """
    # The number of the object that each geom belongs to, by geom.
    geoms = (
        (geom.name, number)
        for number, thing in enumerate(things)
        for body in thing.elements.root.subtree()
        for geom in body.geoms
    )
    numbers = {model.geom(name).id: number for name, number in geoms}
    data, kept = mujoco.MjData(model), list[Keyframe]()
    for pose in keyframes:
        overlap = _deepest(model, data, pose, numbers)
        if overlap is None:
            kept += [pose] if _ribbons_reach(model, data, things) else []
        elif pose.name == start:
            raise _refusal(model, overlap, numbers, specs)
    return tuple(kept)


def _deepest(
    model: mujoco.MjModel, data: mujoco.MjData, pose: Keyframe, numbers: Mapping[int, int]
) -> tuple[int, int] | None:
    """Return the two geoms, one of an object, that are deepest inside each other in a pose; None if none are."""
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose.name).id)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    is_objects = np.isin(data.contact.geom, list(numbers)).any(axis=1)
    depths_m = np.where(is_objects, -data.contact.dist, 0.0)
    if depths_m.max(initial=0.0) <= TOUCH_M:
        return None
    first, second = data.contact.geom[int(depths_m.argmax())].tolist()
    return first, second


def _ribbons_reach(model: mujoco.MjModel, data: mujoco.MjData, things: Sequence[PlacedThing]) -> bool:
    mujoco.mj_tendon(model, data)
    ribbons = [ribbon for thing in things for ribbon in thing.elements.ribbons]
    return all(data.ten_length[model.tendon(ribbon.name).id] <= ribbon.range_m[1] + LONGER_M for ribbon in ribbons)


def _refusal(
    model: mujoco.MjModel, overlap: tuple[int, int], numbers: Mapping[int, int], specs: Sequence[ObjectSpec]
) -> ObjectError:
    """Return the error of the later of two objects, or of the one that is inside of something else."""
    first, second = sorted(overlap, key=lambda geom: numbers.get(geom, -1))
    other = f"the object '{specs[numbers[first]].name}'" if first in numbers else f"'{_name(model, first)}'"
    number = numbers[second]
    key = "above" if specs[number].above is not None else "at"
    return ObjectError(key, f"it would start inside of {other}; give it another place, or make it smaller", number)


def _name(model: mujoco.MjModel, geom: int) -> str:
    body = model.geom_bodyid[geom]
    return model.body(body).name if body else model.geom(geom).name
