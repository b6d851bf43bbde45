"""Infants at other ages and in other scenes: options of resets, and what is carried over in the midst of episodes."""

import copy
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.base.random_streams import checked_seed
from mimoc.base.rounding import rounded
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import STATE, TOUCH_M, physics_of, pose_of
from mimoc.bundle.variants import Variant
from mimoc.bundle.world import manifests_of, take_pose
from mimoc.runtime.arousal import checked_arousal
from mimoc.runtime.infant import AGE, Binding, Infant
from mimoc.runtime.model_fields import WORLD
from mimoc.runtime.objects import Objects, Pose
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.objects import checked_moves, names_of

OLDEST_MONTHS = 24.0
SEED, POSE, AROUSAL, OBJECTS = "scene_seed", "pose", "arousal", "objects"  # Options of a reset, besides `AGE`.


def options_given(options: Any) -> dict[str, Any]:
    """Return the options of a reset as a dictionary, or raise a TypeError."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"expected a dictionary of options to reset with, got {options!r}")
    return dict(options or {})


def checked_options(options: Any, variants: Any, infant: Infant) -> dict[str, Any]:
    """Return the options of a reset for an infant, or raise an error that names the wrong one."""
    options = options_given(options)
    is_alone = not infant.name
    objects = infant.manifest.objects
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
    """Return the keyframes of poses by infant, and the poses of objects that the options move."""
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
    """Reset a state to the variant's default keyframe, and infants in it to the poses of others."""
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

    *variants*, if there are any, make an infant that is alone of its age and the seed, or a world of ages by name.
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
    """Return the infants of a state, or None if they are the present ones; see `find_variant`."""
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
    """Raise a MimocError unless two models have the same parts, so that states can be carried over."""
    if _parts(former) != _parts(model):
        raise MimocError(
            "the infant has other parts at this age, so it cannot grow in the midst of an episode; reset it with the"
            " option age_months instead, or build its bundle again with this version of mimoc"
        )


def check_same_space(wanted: Any, given: Any) -> None:
    """Check that observations have kept their space."""
    for name in sorted(wanted.keys() | given.keys()):
        if wanted.get(name) != given.get(name):
            raise MimocError(f"the space of the observation '{name}' changes with age or scene; it must not")


def carry_on(former: Sequence[Binding], now: Sequence[Binding]) -> None:
    """Let infants that have just been bound continue from their states and signals at other ages."""
    carry_body(former, now)
    for before, after in zip(former, now, strict=True):
        after.schedule.carry_on(before.schedule, after.data)


def carry_body(former: Sequence[Binding], now: Sequence[Binding]) -> None:
    """Carry over bodies, tasks and objects as `carry_on` does."""
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
    depths = depths_of(old.model, old.data)
    fixed = np.concatenate([after.constraints.fixed_dofs for after in now])
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
    begin = model.name_bodyadr[0]
    end = model.name_keyadr[0] if model.nkey else len(model.names)
    worlds = model.name_geomadr[0]
    bodies = model.name_geomadr[np.count_nonzero(model.geom_bodyid == WORLD)]
    return model.nq, model.nv, model.na, model.nu, model.names[begin:worlds] + model.names[bodies:end]


LEFT_M = 1e-4  # Penetration that is left, so that what supports still does; as in `body.poses`.
ROUNDS = 40  # Most times that it is moved; some are enough.
UPWARDS = 0.1  # Least vertical part of a contact's normal at which lifting helps.
FARTHEST = 0.2  # What a joint turns by in one round at most, in [rad], and what moves freely moves by, in [m].
AT_LIMITS = 5  # Most times in a round that joints which reach the end of their range leave the rest to others.
DAMPING = 1e-5  # Damping for contacts that contradict each other, relative to their strongest coupling.

Mask = npt.NDArray[np.bool_]
Depths = Mapping[tuple[int, int], float]  # Deepest penetration of each pair of bodies, [m]; the world is one.


def resolve_penetrations(
    model: mujoco.MjModel, data: mujoco.MjData, root_bodies: Sequence[str], fixed: IntArray, before: Depths
) -> None:
    """Lift infants by as much as each sinks into what it is on, and part them from themselves and what they touch.

    Joints and loose objects give way by as little as needed, weighted by inertia; nothing else is pushed deeper into
    anything than it was.
    """
    roots = [model.body(name).id for name in root_bodies]
    heights = model.jnt_qposadr[model.body_jntadr[roots]] + 2
    root_of = model.body_rootid[model.geom_bodyid]
    yielding = model.dof_invweight0.copy()
    yielding[fixed] = 0.0
    for _ in range(ROUNDS):
        mujoco.mj_fwdPosition(model, data)
        touching = root_of[data.contact.geom]
        depths_m = -data.contact.dist
        pairs = model.geom_bodyid[data.contact.geom].tolist()
        usual_m = [before.get((first, second), 0.0) for first, second in pairs]
        usual_m = np.where(np.isin(touching, roots).any(axis=1), 0.0, usual_m)
        if not (depths_m > np.maximum(usual_m, TOUCH_M)).any():
            return
        lifts_m = [_lift_m(data, touching == root, depths_m) for root in roots]
        if any(lifts_m):
            data.qpos[heights] += lifts_m
        else:
            excess_m = np.maximum(depths_m - np.maximum(usual_m, LEFT_M), 0.0)
            _part(model, data, np.flatnonzero(depths_m > 0), excess_m, yielding)


def depths_of(model: mujoco.MjModel, data: mujoco.MjData) -> Depths:
    """Return the deepest penetration of each pair of bodies in a state whose contacts have been computed."""
    depths: dict[tuple[int, int], float] = {}
    pairs = model.geom_bodyid[data.contact.geom].tolist()
    for (first, second), distance in zip(pairs, data.contact.dist.tolist(), strict=True):
        depths[first, second] = max(depths.get((first, second), 0.0), -distance)
    return depths


def clip_angles(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Bring the angles of all hinges into their ranges."""
    hinges = np.flatnonzero((model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE) & (model.jnt_limited != 0))
    addresses = model.jnt_qposadr[hinges]
    data.qpos[addresses] = np.clip(data.qpos[addresses], *model.jnt_range[hinges].T)


def _lift_m(data: mujoco.MjData, is_infants: Mask, depths_m: FloatArray) -> float:
    """Return how far an infant must be lifted out of what it is on."""
    alone = is_infants[:, 0] != is_infants[:, 1]
    upwards = data.contact.frame[:, 2] * np.where(is_infants[:, 1], 1.0, -1.0)
    sunk = alone & (upwards > UPWARDS) & (depths_m > TOUCH_M)
    return float(((depths_m[sunk] - LEFT_M) / upwards[sunk]).max()) if sunk.any() else 0.0


def _part(
    model: mujoco.MjModel, data: mujoco.MjData, touching: IntArray, excess_m: FloatArray, yielding: FloatArray
) -> None:
    """Move all degrees of freedom, by how much each yields, so that no contact is too deep.

    Contacts that are not too deep stay as they are: neither a hand between the head and the floor nor a toy beneath a
    leg is pushed into the floor. *touching* are the contacts with penetration, *excess_m*, shape (ncon,), is by how
    much each contact is too deep, and *yielding*, shape (nv,), how much each degree of freedom gives way.
    """
    rows = np.array([_gap_rate(model, data, index) for index in touching])
    yielding, before = yielding.copy(), data.qpos.copy()
    for _ in range(AT_LIMITS):
        weighted = rows * yielding
        coupling = weighted @ rows.T
        coupling[np.diag_indices_from(coupling)] += DAMPING * coupling.diagonal().max() + np.finfo(float).tiny
        move = np.linalg.solve(coupling, excess_m[touching]) @ weighted
        move /= max(1.0, np.abs(move).max() / FARTHEST)
        data.qpos[:] = before
        mujoco.mj_integratePos(model, data.qpos, move, 1.0)
        wanted = data.qpos.copy()
        clip_angles(model, data)
        stopped = np.isin(model.jnt_qposadr, np.flatnonzero(wanted != data.qpos))
        if not stopped.any():
            return
        yielding[model.jnt_dofadr[stopped]] = 0.0


def _gap_rate(model: mujoco.MjModel, data: mujoco.MjData, index: int) -> FloatArray:
    """Return the derivative of a contact's distance by each degree of freedom, shape (nv,)."""
    contact, rates = data.contact[index], np.zeros((2, 3, model.nv))
    for rate, geom in zip(rates, contact.geom, strict=True):
        mujoco.mj_jac(model, data, rate, None, contact.pos, model.geom_bodyid[geom])
    return contact.frame[:3] @ (rates[1] - rates[0])
