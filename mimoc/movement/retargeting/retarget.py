"""The child in a recording of points, and the motion of its joints."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np

from mimoc.base.classes import takes
from mimoc.base.errors import RecordingError, check_name
from mimoc.motion.point_recording import PointRecording
from mimoc.movement.retargeting.fitting import Problem, Run, State
from mimoc.movement.retargeting.observations import OUTLIER
from mimoc.movement.retargeting.result import Retargeted
from mimoc.movement.retargeting.setting import (
    Noise,
    Setting,
    child_of,
    first_state,
    interpolated,
    of_child,
    points_of,
    problem_of,
    setting_of,
    usual_noise,
)
from mimoc.movement.retargeting.sizes import compile_child, starting_spec
from mimoc.movement.retargeting.start import TRUNK
from mimoc.movement.retargeting.uncertainty import Uncertainty, account_of, pull_of, uncertainty_of
from mimoc.schema.infant import InfantSpec

ROUNDS = 3
STEPS_POSTURE, STEPS_THIN, STEPS_AGAIN, STEPS_ALL, STEPS_LAST = 12, 30, 8, 10, 6
"""Most steps: of the first fit, with the sizes of the child that it starts from; with sizes; in each round with the
noise known; of all frames, with sizes; of all frames of that child."""
TOTAL = STEPS_POSTURE + STEPS_THIN + ROUNDS * STEPS_AGAIN + STEPS_ALL + STEPS_LAST
FIRST_OUTLIER = 20 * OUTLIER
FEWEST_POINTS, FEWEST_SEEN = 6, 0.2  # Points that a recording must have, and share of them that must be seen.
FEWEST_FRAMES = 3
POSES = "supine", "prone"
NEARLY_ALWAYS = 0.9
"""Share of frames in which an infant must lie the other way round than is said, to be asked about: others roll."""
AGED = "the spec is of a child of {:g} months: at {:g} months, its sizes are those along its percentiles"


@takes("a recording of points, from mimoc.read_points", PointRecording)
def retarget(
    recording: PointRecording,
    age_months: float | None = None,
    spec: InfantSpec | None = None,
    *,
    camera_height_m: float | None = None,
    camera_pitch_deg: float | None = None,
    pose: Literal["supine", "prone"] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Retargeted:
    """Return the child of a recording of points and its motion.

    A camera looks down on an infant who lies; straight down, unless its pitch is given or the trunk is clearly
    foreshortened. With one camera and no depth, overall size is not known, and that of the average child of the age is
    taken, unless the camera's height is known, or the spec gives the child's length; what else remains open is said in
    the account. Ctrl-C ends the fit with the best motion so far.

    In this order: compile the child that the fit starts from; fit some frames, from likely postures on; fit all frames,
    with sizes; compile the child that has them; fit its motion.

    Args:
        recording: Points on the infant; neck and both hips must be among them.
        age_months: Age of the infant, from 0 to 24; by default, that of the spec.
        spec: Child to start from, with its name, sex, length, hands and scene; by default, the average child.
        camera_height_m: Height of the camera above the floor, if it is known.
        camera_pitch_deg: Angle by which the camera looks down, below the horizon, if it is known: 90 straight down.
        pose: How the infant lies, if it is known; by default as `scene.pose` of *spec* has it. Of points in space or
            with depth, on its back if neither says it.
        progress: Called with the number of steps done, and of all.

    Raises:
        RecordingError: If the recording has too few points or frames, neither age nor spec is given, the camera cannot
            have this pitch, or the infant lies the other way round in nearly all frames.
        SpecError: If there is no such child.

    Example:
        >>> import mimoc
        >>> result = mimoc.retarget(mimoc.read_points("filmed.npz"), age_months=9)
        >>> result.qpos.shape[0], result.account.error_share < 0.01
        (12, True)
    """
    run = Run(progress, TOTAL)
    if pose is not None:
        check_name("pose of an infant who lies", pose, POSES)
    check(recording)
    if age_months is None and spec is None:
        raise RecordingError(f"{recording.name}: how old the infant is, is not known; give age_months, or a spec")
    child = run.compiled(lambda: compile_child(starting_spec(spec, age_months, _name(recording))))
    setting = run.compiled(lambda: setting_of(recording, child, camera_height_m, camera_pitch_deg))
    _check_pose(setting, pose or _stated(spec))
    state, noise = _first_fit(setting, run)
    whole = problem_of(setting, setting.recording, noise)
    state = replace(state, x=interpolated(state.x, setting.every, recording.frames))
    whole = run.improved(whole, lambda: _pulled(whole, state, setting.every))
    state = run.solve(whole, state, STEPS_ALL, setting.free)
    noise = run.improved(noise, lambda: _rescaled(noise, uncertainty_of(whole, state)))
    child, factor = run.compiled(lambda: child_of(setting, state.logs))
    setting = of_child(setting, child, state.logs + np.log(factor) * (np.arange(len(state.logs)) == 0))
    problem = replace(problem_of(setting, setting.recording, noise), pull=whole.pull)
    state = run.solve(problem, _scaled(state, factor), STEPS_LAST, setting.only_height)
    aged = () if spec is None or age_months in (None, spec.age_months) else (AGED.format(spec.age_months, age_months),)
    return run.finished(lambda: _result(recording, setting, problem, state, run, aged))


def _result(
    recording: PointRecording, setting: Setting, problem: Problem, state: State, run: Run, on_spec: tuple[str, ...]
) -> Retargeted:
    """Return what was fitted, within all limits, and its account; *on_spec* are notes on the child it started from."""
    sure = uncertainty_of(replace(problem, shared_sd=setting.shared_sd()), state)
    state = replace(state, x=problem.within_limits(state.x))
    qpos, child = problem.skeleton.qpos(state.x), setting.child
    seen = problem.observed.project(points_of(problem, state), state.height_m)
    fitted = np.full((recording.frames, len(recording.names), seen.shape[-1]), np.nan)
    fitted[:, [recording.names.index(name) for name in setting.recording.names]] = seen
    notes = (*recording.notes, *on_spec, *setting.notes, *run.notes)
    account = account_of(setting, problem, state, sure, seen, run.seconds, notes)
    height_m = None if recording.unit == "m" else state.height_m
    return Retargeted(recording, child.spec, child.bundle, recording.rate_hz, qpos, height_m, fitted, account)


def check(recording: PointRecording) -> None:
    """Check that a recording tells enough for a fit; raise a RecordingError if not."""
    missing = [name for name in TRUNK if name not in recording.names]
    if missing:
        raise RecordingError(
            f"{recording.name}: the points {', '.join(missing)} are missing; a fit needs neck and hips"
        )
    if len(recording.names) < FEWEST_POINTS:
        raise RecordingError(
            f"{recording.name}: {len(recording.names)} points are too few; give {FEWEST_POINTS} or more"
        )
    if recording.frames < FEWEST_FRAMES:
        raise RecordingError(f"{recording.name}: {recording.frames} frames are too few; give {FEWEST_FRAMES} or more")
    seen = np.isfinite(recording.positions).all(-1) & (recording.confidence > 0)
    for name in TRUNK:
        if not seen[:, recording.names.index(name)].any():
            raise RecordingError(f"{recording.name}: the point '{name}' is never seen; a fit needs neck and hips")
    if seen.mean() < FEWEST_SEEN:
        raise RecordingError(
            f"{recording.name}: only {seen.mean():.0%} of the points are seen; give a part where {FEWEST_SEEN:.0%} are"
        )


def _stated(spec: InfantSpec | None) -> str | None:
    return spec.scene.pose if spec and "pose" in spec.scene.model_fields_set else None


def _check_pose(setting: Setting, pose: str | None) -> None:
    """Raise a RecordingError if an infant lies otherwise than it is said to; of pixels alone, readers have asked."""
    recording, start = setting.recording, setting.start
    in_space = recording.unit == "m" or recording.depth_m is not None
    pose = pose or ("supine" if in_space else None)
    share = {"supine": start.face_down, "prone": 1 - start.face_down}.get(pose or "", 0.0)
    if start.lies and share > NEARLY_ALWAYS:
        faces, back, other = ("down", "back", "prone") if pose == "supine" else ("up", "belly", "supine")
        raise RecordingError(
            f"{recording.name}: the infant comes out face {faces} in {share:.0%} of its frames, but is said to lie on"
            f" its {back}; if it does not, give pose='{other}', and otherwise turn or mirror axes (view='mirrored'), or"
            " exchange left and right (view='swapped')"
        )


def _name(recording: PointRecording) -> str:
    """Return the name of a recording's child: letters, digits and underscores, a letter first."""
    name = re.sub(r"\W+", "_", recording.name, flags=re.ASCII).strip("_") or "child"
    return name if name[0].isalpha() else f"child_{name}"


def _first_fit(setting: Setting, run: Run) -> tuple[State, Noise]:
    thin = setting.recording.window(0, setting.recording.frames, setting.every)
    noise = usual_noise(setting.recording)
    problem = problem_of(setting, thin, noise)
    state = first_state(setting, problem)
    state = run.solve(problem, state, STEPS_POSTURE, setting.only_height, (FIRST_OUTLIER, FIRST_OUTLIER))
    state = run.solve(problem, state, STEPS_THIN, setting.free, (FIRST_OUTLIER, OUTLIER))
    for _ in range(ROUNDS):
        sure = run.improved(None, partial(uncertainty_of, problem, state))
        noise = _rescaled(noise, sure) if sure else noise
        problem = problem_of(setting, thin, noise)
        problem = run.improved(problem, partial(_pulled, problem, state))
        state = run.solve(problem, state, STEPS_AGAIN, setting.free)
    return state, noise


def _pulled(problem: Problem, state: State, every: int = 1) -> Problem:
    """Return the problem with what makes sizes the likeliest over all motions, where depth is not seen.

    With depth, data say so much of each frame that this makes no difference.
    """
    return problem if problem.observed.tells_size else replace(problem, pull=pull_of(problem, state, every))


def _scaled(state: State, factor: float) -> State:
    """Return the motion of a child whose sizes are new, and all larger by a factor: to the camera it looks the same."""
    x = state.x.copy()
    x[:, :3] *= factor
    return State(x, state.height_m * factor, 0 * state.logs)


def _rescaled(noise: Noise, sure: Uncertainty) -> Noise:
    factors = (*sure.noise, 1.0)
    return Noise(max(noise.places * factors[0], noise.least), max(noise.depth_m * factors[1], 1e-4), noise.least)
