"""An infant that gets another age while it lives: what of its present it takes along."""

import copy
from collections.abc import Mapping
from numbers import Real
from typing import Any

import mujoco
import numpy as np

from mimoc.actuation.arousal import checked_arousal
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.base.model_fields import WORLD
from mimoc.base.random_streams import checked_seed
from mimoc.base.rounding import rounded
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import pose_of
from mimoc.bundle.physics_state import STATE, physics_of
from mimoc.bundle.variants import Variant, Variants
from mimoc.objects.spec_base import names_of
from mimoc.objects.spec_move import checked_moves
from mimoc.runtime.objects import NOWHERE, Objects, Pose
from mimoc.runtime.penetrations import clip_angles, depths_of, resolve_penetrations
from mimoc.runtime.simulation_state import SimulationState

OLDEST_MONTHS = 24.0
"""Age of the oldest infant."""
AGE, SEED, POSE, AROUSAL, OBJECTS = "age_months", "scene_seed", "pose", "arousal", "objects"
"""Options of a reset."""


def options_given(options: Any) -> dict[str, Any]:
    """Return the options of a reset, none for None.

    Raises:
        TypeError: If they are no dictionary.
    """
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"expected a dictionary of options to reset with, got {options!r}")
    return dict(options or {})


def checked_options(options: Any, variants: Variants | None, manifest: Manifest) -> dict[str, Any]:
    """Return the options of a reset, none for None.

    Raises:
        TypeError: If they are no dictionary.
        UnknownNameError: If there is no such option in an environment with these variants.
        ValueError: If the arousal is not a number from 0 to 2, or a place of an object is none.
    """
    options = options_given(options)
    known = [POSE, AROUSAL, *([AGE] if variants else []), *([SEED] if variants and variants.has_other_scenes else [])]
    known += [OBJECTS] if manifest.objects else []
    for key in options.keys() - known:
        raise UnknownNameError("reset option", str(key), known)
    if AROUSAL in options:
        options[AROUSAL] = checked_arousal(options[AROUSAL])
    checked_moves(options.get(OBJECTS, {}), names_of(manifest.objects))
    return options


def find_start(
    options: Mapping[str, Any], infant: Variant, present: SimulationState, *, is_new: bool
) -> tuple[str, Mapping[str, Pose]]:
    """Return the pose that an infant starts in, and where the objects are put that the options of a reset move.

    Args:
        options: Of the reset.
        infant: The infant that is reset.
        present: What lives now.
        is_new: Whether that is another infant.

    Raises:
        UnknownNameError: If there is no such pose or object.
        ValueError: If an object would be inside of anything, or there is no such place; nothing has changed then.
    """
    manifest = infant.bundle.manifest
    pose = pose_of(manifest, options.get(POSE))
    if not options.get(OBJECTS):
        return pose, NOWHERE
    objects = Objects(manifest, infant.bare) if is_new else present.objects
    return pose, objects.find_poses(pose, checked_moves(options[OBJECTS], names_of(manifest.objects)))


def find_variant(variants: Variants | None, manifest: Manifest, wanted: Mapping[str, Any]) -> Variant | None:
    """Return the infant with the age or the scene that is wanted, or None if it has these already.

    Args:
        variants: What makes it, if anything does.
        manifest: The infant now.
        wanted: `age_months` and `scene_seed`; those that are missing stay as they are.

    Raises:
        ValueError: If the age is not one from 0 to 24 months, or the seed is not a non-negative integer.
        MimocError: If there is no such infant.
    """
    age_months = manifest.child.age_months
    age_months, seed = _age(wanted.get(AGE, age_months)), checked_seed(wanted.get(SEED, manifest.seed), SEED)
    if (age_months, seed) == (manifest.child.age_months, manifest.seed):
        return None
    if variants is None:
        raise MimocError(
            "this environment can change neither the infant's age nor its scene, as it was opened by its class;"
            " open it with mimoc.make"
        )
    return variants(age_months, seed)


def variant_of_state(variants: Variants | None, manifest: Manifest, state: Mapping[str, Any]) -> Variant | None:
    """Return the infant that a state is of, or None if it is of the present one.

    Raises:
        ValueError: If this is not a state, or this environment cannot make that infant.
        MimocError: If there is no such infant.
    """
    if not isinstance(state, Mapping) or not {AGE, SEED} <= state.keys():
        raise ValueError("this is not a state of an environment; give one that get_state returned")
    age_months, seed = manifest.child.age_months, manifest.seed
    if checked_seed(state[SEED], SEED) != seed and not (variants and variants.has_other_scenes):
        raise ValueError(
            f"state has scene_seed {state[SEED]}, but this environment has {seed} and was not made from a spec, so it"
            " cannot change its scene"
        )
    if _age(state[AGE]) != age_months and variants is None:
        raise ValueError(
            f"state has age_months {state[AGE]:g}, but this environment has {age_months:g} and cannot change it; open"
            " it with mimoc.make"
        )
    return find_variant(variants, manifest, state)


def sees_skin(manifest: Manifest) -> bool:
    """Return whether an infant's eyes see skins."""
    return manifest.senses.vision is not None and manifest.senses.vision.body != "solids"


def check_same_body(former: mujoco.MjModel, model: mujoco.MjModel) -> None:
    """Check that two models have the same parts, so that one can take over the state of the other.

    Raises:
        MimocError: If they have not.
    """
    if _parts(former) != _parts(model):
        raise MimocError(
            "the infant has other parts at this age, so it cannot grow in the midst of an episode; reset it with the"
            " option age_months instead, or build its bundle again with this version of mimoc"
        )


def carry_on(former: SimulationState, now: SimulationState) -> None:
    """Let an infant that has just been bound go on where it was at another age, with the signals on their way.

    Args:
        former: The infant at the age before.
        now: The same infant at the new age, which has not been started.
    """
    carry_body(former, now)
    now.schedule.carry_on(former.schedule, now.data)


def carry_body(former: SimulationState, now: SimulationState) -> None:
    """Let the body, the task and what lies around go on as in `carry_on`."""
    mujoco.mj_setState(now.model, now.data, physics_of(former.model, former.data), STATE)
    now.fields.inherit(former.fields)
    now.objects.stay(former.objects)
    now.arousal.level = former.arousal.level
    now.task.state = copy.deepcopy(former.task.state)
    clip_angles(now.model, now.data)
    mujoco.mj_fwdPosition(former.model, former.data)
    resolve_penetrations(
        now.model, now.data, now.manifest.root_body, now.constraints.fixed_dofs, depths_of(former.model, former.data)
    )
    mujoco.mj_kinematics(now.model, now.data)
    now.constraints.carry_on(former.constraints, former.data, now.data)
    mujoco.mj_forward(now.model, now.data)


def _age(age_months: Any) -> float:
    """Return an age as files have it."""
    if isinstance(age_months, bool) or not isinstance(age_months, Real) or not _is_age(age_months):
        raise ValueError(f"expected an age from 0 to {OLDEST_MONTHS:g} months, got {age_months!r}")
    return rounded(float(age_months))


def _is_age(age_months: Any) -> bool:
    return bool(0.0 <= age_months <= OLDEST_MONTHS)  # Not for a NaN, either.


def _parts(model: mujoco.MjModel) -> tuple[Any, ...]:
    """Return the sizes of a model's state and the names of its elements.

    Left out are the name of the model, which is first, and those of keyframes, which are last; and the world's own
    geoms, which come before those of bodies: a larger crib has more bars.
    """
    begin, end = model.name_bodyadr[0], model.name_keyadr[0] if model.nkey else len(model.names)
    worlds, bodies = model.name_geomadr[0], model.name_geomadr[np.count_nonzero(model.geom_bodyid == WORLD)]
    return model.nq, model.nv, model.na, model.nu, model.names[begin:worlds] + model.names[bodies:end]
