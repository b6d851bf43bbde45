"""An infant that gets another age while it lives: what of its present it takes along."""

import copy
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.base.random_streams import checked_seed
from mimoc.base.rounding import rounded
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import pose_of
from mimoc.bundle.physics_state import STATE, physics_of
from mimoc.bundle.variants import Variant
from mimoc.bundle.world import manifests_of as manifests_of, take_pose
from mimoc.runtime.arousal import checked_arousal
from mimoc.runtime.infant import AGE as AGE, Binding, Infant
from mimoc.runtime.model_fields import WORLD
from mimoc.runtime.objects import Objects, Pose
from mimoc.runtime.penetrations import clip_angles, depths_of, resolve_penetrations
from mimoc.schema.object_base import names_of
from mimoc.schema.object_moves import checked_moves

OLDEST_MONTHS = 24.0
SEED, POSE, AROUSAL, OBJECTS = "scene_seed", "pose", "arousal", "objects"
"""Options of a reset, besides `AGE`."""


def options_given(options: Any) -> dict[str, Any]:
    """Return the options of a reset, none for None; raise a TypeError if they are no dictionary."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"expected a dictionary of options to reset with, got {options!r}")
    return dict(options or {})


def checked_options(options: Any, variants: Any, infant: Infant) -> dict[str, Any]:
    """Return the options of a reset for an infant, none for None.

    Raises:
        TypeError: If they are no dictionary.
        UnknownNameError: If there is no such option in an environment with these variants, or no such object.
        ValueError: If an arousal is none from 0 to 2, a seed no whole number, or the place of an object none.
    """
    options, is_alone, objects = options_given(options), not infant.name, infant.manifest.objects
    known = [POSE, AROUSAL, *([AGE] if variants else []), *([OBJECTS] if objects else [])]
    known += [SEED] if is_alone and variants and variants.has_other_scenes else []
    for key in options.keys() - known:
        raise UnknownNameError("reset option" if is_alone else "reset option of an infant in a world", str(key), known)
    if AROUSAL in options:
        options[AROUSAL] = checked_arousal(options[AROUSAL])
    if SEED in options:
        options[SEED] = checked_seed(options[SEED], SEED)
    checked_moves(options.get(OBJECTS, {}), names_of(objects))
    return options


def find_start(
    options: Mapping[str, Mapping[str, Any]], variant: Variant, infants: Mapping[str, Infant], *, is_new: bool
) -> tuple[dict[str, str], dict[str, Pose]]:
    """Return the keyframes whose poses infants start in, by name, and where the objects are put that options move.

    Args:
        options: Of the reset, by infant; see `checked_options`.
        variant: What is reset.
        infants: The infants as they are bound now.
        is_new: Whether the variant is another one than theirs.

    Raises:
        UnknownNameError: If there is no such pose.
        ValueError: If an object would be inside of anything, or there is no such place; nothing has changed then.
    """
    manifests = manifests_of(variant.bundle)
    poses = {
        name: _keyframe_of(manifest, options[name].get(POSE))
        for name, manifest in manifests.items()
        if not name or options[name].get(POSE) is not None
    }
    elsewhere: dict[str, Pose] = {}

    def start(data: mujoco.MjData) -> None:
        put(poses, variant, data)

    for name, manifest in manifests.items():
        if moves := options[name].get(OBJECTS):
            objects = Objects(manifest, variant.bare) if is_new else infants[name].binding.objects
            elsewhere |= objects.find_poses(start, checked_moves(moves, names_of(manifest.objects)), elsewhere)
    return poses, elsewhere


def put(poses: Mapping[str, str], variant: Variant, data: mujoco.MjData) -> None:
    """Put a state of a variant's model into its default keyframe, and infants into the poses of others, at rest."""
    model, default = variant.bare, variant.bundle.manifest.pose
    mujoco.mj_resetDataKeyframe(model, data, model.key(poses.get("", default)).id)
    manifests = manifests_of(variant.bundle)
    for name in poses.keys() - {""}:
        take_pose(manifests[name].root_body, poses[name], data)


def _keyframe_of(manifest: Manifest, pose: str | None) -> str:
    known = {manifest.of_infant(keyframe): keyframe for keyframe in manifest.poses}
    return known[pose] if pose in known else pose_of(manifest, pose)


def find_variant(
    variants: Any, manifest: Any, ages_months: Mapping[str, float], wanted: Mapping[str, Any], seed: int | None = None
) -> Variant | None:
    """Return infants with the ages and the scene that are wanted, or None if they have these already.

    Args:
        variants: Makes an infant that is alone, of (age_months, seed), or a world, of (ages by name, seed); or None.
        manifest: That of the infant or the world now.
        ages_months: Their ages now; the name of an infant that is alone is empty.
        wanted: Their ages then.
        seed: The seed of the scene then; None is that of now.

    Raises:
        ValueError: If an age is none from 0 to 24 months, or the seed is no whole number.
        MimocError: If there are no such infants, or nothing makes them.
    """
    ages = {name: _age(age_months) for name, age_months in wanted.items()}
    seed = checked_seed(manifest.seed if seed is None else seed, SEED)
    if (ages, seed) == (ages_months, manifest.seed):
        return None
    if variants is None:
        raise MimocError(
            "this environment can change neither the infant's age nor its scene, as it was opened by its class;"
            " open it with mimoc.make, or a world with mimoc.make_parallel"
        )
    return variants(ages.get("", ages), seed)


def variant_of_state(
    variants: Any, manifest: Any, ages_months: Mapping[str, float], wanted: Mapping[str, Any], seed: Any
) -> Variant | None:
    """Return the infants that a state is of, or None if it is of the present ones; see `find_variant`.

    Raises:
        ValueError: If this environment cannot make them.
        MimocError: If there are no such infants.
    """
    if checked_seed(seed, SEED) != manifest.seed and not (variants and variants.has_other_scenes):
        raise ValueError(
            f"state has scene_seed {seed}, but this environment has {manifest.seed} and was not made from a spec, so it"
            " cannot change its scene"
        )
    for name, age_months in wanted.items():
        if _age(age_months) != ages_months[name] and variants is None:
            raise ValueError(
                f"state has age_months {age_months:g}, but this environment has {ages_months[name]:g} and cannot change"
                " it; open it with mimoc.make"
            )
    return find_variant(variants, manifest, ages_months, wanted, seed)


def sees_skin(manifest: Manifest) -> bool:
    """Return whether an infant's eyes see skins."""
    return manifest.senses.vision is not None and manifest.senses.vision.body != "solids"


def check_same_body(former: mujoco.MjModel, model: mujoco.MjModel) -> None:
    """Raise a MimocError unless two models have the same parts, so that one can take over the state of the other."""
    if _parts(former) != _parts(model):
        raise MimocError(
            "the infant has other parts at this age, so it cannot grow in the midst of an episode; reset it with the"
            " option age_months instead, or build its bundle again with this version of mimoc"
        )


def carry_on(former: Sequence[Binding], now: Sequence[Binding]) -> None:
    """Let infants that have just been bound go on where they were at other ages, with the signals on their way."""
    carry_body(former, now)
    for before, after in zip(former, now, strict=True):
        after.schedule.carry_on(before.schedule, after.data)


def carry_body(former: Sequence[Binding], now: Sequence[Binding]) -> None:
    """Let the bodies, the tasks and what lies around go on as in `carry_on`."""
    model, data, old = now[0].model, now[0].data, former[0]
    mujoco.mj_setState(model, data, physics_of(old.model, old.data), STATE)
    pairs = list(zip(former, now, strict=True))
    for before, after in pairs:
        after.fields.inherit(before.fields)
        after.arousal.level = before.arousal.level
        after.task.state = copy.deepcopy(before.task.state)
    now[0].objects.stay(old.objects)
    clip_angles(model, data)
    mujoco.mj_fwdPosition(old.model, old.data)
    depths, fixed = depths_of(old.model, old.data), np.concatenate([after.constraints.fixed_dofs for after in now])
    resolve_penetrations(model, data, [after.manifest.root_body for after in now], fixed, depths)
    mujoco.mj_kinematics(model, data)
    for before, after in pairs:
        after.constraints.carry_on(before.constraints, before.data, data)
    mujoco.mj_forward(model, data)


def _age(age_months: Any) -> float:
    months: Any = age_months
    if isinstance(months, bool) or not isinstance(months, Real) or not 0.0 <= age_months <= OLDEST_MONTHS:
        raise ValueError(f"expected an age from 0 to {OLDEST_MONTHS:g} months, got {age_months!r}")
    return rounded(float(age_months))


def _parts(model: mujoco.MjModel) -> tuple[Any, ...]:
    """Return the sizes of a model's state and the names of its elements.

    Left out are the name of the model, which is first, and those of keyframes, which are last; and the world's own
    geoms, which come before those of bodies: a larger crib has more bars.
    """
    begin, end = model.name_bodyadr[0], model.name_keyadr[0] if model.nkey else len(model.names)
    worlds, bodies = model.name_geomadr[0], model.name_geomadr[np.count_nonzero(model.geom_bodyid == WORLD)]
    return model.nq, model.nv, model.na, model.nu, model.names[begin:worlds] + model.names[bodies:end]
