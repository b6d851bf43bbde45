"""Reaching by inverse dynamics: hands go to targets, given or random, eyes look at one, and legs and trunk balance.

The behaviour `reach_for` reaches by angles instead, across delays and with servos, as part of a posture.
"""

import copy
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import ControlError, PolicyError
from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.dynamics import arms_with_hands, find_frame, joints_between, limb_of, trunk_of
from mimoc.policies.control.estimate import Estimate, Organs, Reader, SenseNoise, lacking, told_of
from mimoc.policies.control.holding import RESTING_S
from mimoc.policies.control.infant import DrivenInfant
from mimoc.policies.control.inverse_dynamics import InverseDynamics
from mimoc.policies.control.objectives import LOOKING, REACHING, Gains, GazeTask, OrientationTask, PositionTask, Posture
from mimoc.runtime.delays import timing_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation

SHARE = 0.8  # Fraction of each joint's range, about its middle, from which its angle is drawn.
VIEW_RAD = np.deg2rad(70.0)
"""Largest angle between a target, as seen from the eyes, and the forward direction of the chest."""
MAX_DRAWS = 1000  # Number of draws after which the search is given up.


class ReachableTargets:
    """Draws a random position for each hand, where the hand is for random angles of the joints of its arm.

    With these angles, the arms have no contacts with the infant or its world, and the positions are in view.
    """

    def __init__(self, model: mujoco.MjModel, manifest: Manifest):
        """Find the arms of an infant; raise a ControlError if no commanded joint moves a hand."""
        self._model, self._data = model, mujoco.MjData(model)
        self._trunk = trunk_of(manifest.anatomy, model)
        moved = {model.joint(actuator.joint).id for actuator in manifest.actuation.actuators if actuator.commanded}
        arms = [arm for arm in arms_with_hands(manifest.anatomy, model) if moved.intersection(arm[2])]
        self.hands = tuple(model.body(hand).name for _, hand, _ in arms)
        """Bodies of the hands that commanded joints move."""
        eyes = [eye.camera for eye in manifest.anatomy.eyes]
        self.eyes = tuple(eye for eye in eyes if moved.intersection(self._joints_of_eye(eye)))
        """Cameras of the eyes that commanded joints move."""
        if not self.hands:
            raise ControlError("this infant has no hand with a commanded arm; add 'arms' to actuation.regions")
        self._frames = [find_frame(hand, model) for hand in self.hands]
        self._eyes = [find_frame(eye, model) for eye in self.eyes]
        joints = [joint for _, _, joints in arms for joint in joints]
        self._angles = model.jnt_qposadr[joints]
        low_rad, high_rad = model.jnt_range[joints].T
        middle_rad = (low_rad + high_rad) / 2
        half_rad = SHARE * (high_rad - low_rad) / 2
        self._low_rad = middle_rad - half_rad
        self._high_rad = middle_rad + half_rad
        is_arm = in_subtrees(model, [model.body(limb.root).id for limb, _, _ in arms])
        self._is_arm = np.append(is_arm[model.geom_bodyid], False)  # The last is for what has no geom.

    def draw(self, data: mujoco.MjData, generator: np.random.Generator) -> tuple[FloatArray, ...] | None:
        """Return a position in the world for each of `hands`, shape (3,), [m], for an infant in a state.

        Returns None if `MAX_DRAWS` draws find none, as for an infant that lies on its arms.
        """
        model, posed = self._model, self._data
        posed.qpos[:] = data.qpos
        for _ in range(MAX_DRAWS):
            posed.qpos[self._angles] = generator.uniform(self._low_rad, self._high_rad)
            mujoco.mj_kinematics(model, posed)
            mujoco.mj_comPos(model, posed)
            mujoco.mj_camlight(model, posed)
            places_m = tuple(frame.place_m(posed).copy() for frame in self._frames)
            if all(map(self._is_in_view, places_m)) and not self._touches():
                return places_m
        return None

    def _joints_of_eye(self, name: str) -> list[int]:
        body = find_frame(name, self._model).body
        return joints_between(self._model, body, limb_of(body, self._trunk, self._model))

    def _is_in_view(self, place_m: FloatArray) -> bool:
        if not self._eyes:
            return True
        ahead = self._data.xmat[self._trunk[-1]].reshape(3, 3)[:, 0]
        away_m = place_m - np.mean([eye.place_m(self._data) for eye in self._eyes], axis=0)
        return float(away_m @ ahead) > np.cos(VIEW_RAD) * float(np.linalg.norm(away_m))

    def _touches(self) -> bool:
        mujoco.mj_collision(self._model, self._data)
        contact = self._data.contact
        return bool((self._is_arm[contact.geom].any(axis=1) & (contact.dist < 0)).any())


BALANCING = Gains(100.0, viscosity_per_s=20.0)  # Gains for the chest while the arms move, if motors act at once.
LAGGING = Gains(25.0, viscosity_per_s=10.0)
"""Those if torques lag behind commands (by 60 ms, or as muscles do): with stronger ones, commands of hips and trunk
jump between their ends, and no friction of the joints hides it."""
LYING = 0.5  # Cosine of 60°, the tilt of the chest beyond which an infant counts as lying.


@dataclass(frozen=True, slots=True)
class ReachGains:
    """Gains of hands and eyes."""

    hands: Gains = REACHING  # Gains for the distance of each hand.
    eyes: Gains = LOOKING  # Gains for the misalignment of each eye.


GAIN_SETS: Mapping[str, ReachGains] = {
    "low": ReachGains(Gains(50.0, cap=0.1, viscosity_per_s=10.0), Gains(56.25, viscosity_per_s=15.0)),
    "medium": ReachGains(Gains(200.0, cap=0.1, viscosity_per_s=20.0), Gains(225.0, viscosity_per_s=30.0)),
    "high": ReachGains(),
}
"""Three sets of gains, each four times as strong as the one before, with equal damping: each reaches faster, as in the
paper's figure 5."""
GENTLE = "low"
"""Key of `GAIN_SETS` for an infant that sits freely: accelerating the arms (10 % of its weight) with the 80 m/s² of the
strong gains causes a reaction force as large as its weight, and it falls over; with 5 m/s² it does not."""


TRUTH = "truth"  # The word by which the infant reads the state of the simulation.
Targets = tuple[Sequence[Any], Sequence[Any]]
"""Targets of hands and of eyes, shape (3,) each, [m]."""


class ReachController:
    """Makes all commanded hands reach for one target each, and the eyes look at one of the targets."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, manifest: Manifest, gains: ReachGains | None = None):
        """Bind to an infant with motors or muscles, or raise a ControlError; hands stay until `aim` is called.

        Without *gains*, they are gentle for an infant that sits freely, else strong.
        """
        self._model, self._data, self._manifest = model, data, manifest
        self._trunk = trunk_of(manifest.anatomy, model)
        self._places = ReachableTargets(model, manifest)
        self.hands = self._places.hands
        """Bodies of the hands that reach."""
        self.sits_freely = not manifest.constraints.welds and not self.lies
        """Whether the infant was upright and supported only by the ground when the controller was created."""
        gains = gains or (GAIN_SETS[GENTLE] if self.sits_freely else ReachGains())
        self._reaches = [PositionTask(hand, data.body(hand).xipos, gains.hands) for hand in self.hands]
        self._looks = [GazeTask(eye, self._reaches[0].target, gains=gains.eyes) for eye in self._places.eyes]
        steady, feet = self._steady(), self._loose_feet()
        self._control = InverseDynamics(model, data, manifest, [*steady, self._reaches, self._looks], loose=feet)
        self._first = sum(isinstance(objective, OrientationTask) for objective in steady)

    @property
    def lies(self) -> bool:
        """Whether the chest is tilted so far now that the infant lies."""
        return bool(self._data.xmat[self._trunk[-1]].reshape(3, 3)[2, 2] < LYING)

    def __call__(self) -> npt.NDArray[np.float32]:
        """Return the action for the present state."""
        return self._control()

    def aim(self, places_m: Sequence[FloatArray], watched: int = 0) -> None:
        """Set the target of each hand, shape (3,), [m]; the eyes look at the target of hand number *watched*."""
        for reach, place_m in zip(self._reaches, places_m, strict=True):
            reach.target = place_m
        for look in self._looks:
            look.target = places_m[watched % len(places_m)]

    @property
    def targets(self) -> "Targets":
        """The target of each hand, and that of the eyes, shape (3,) each, [m]."""
        return [reach.target for reach in self._reaches], [look.target for look in self._looks]

    @targets.setter
    def targets(self, targets: "Targets") -> None:
        hands_m, eyes_m = targets
        for reach, place_m in zip(self._reaches, hands_m, strict=True):
            reach.target = place_m
        for look, place_m in zip(self._looks, eyes_m, strict=True):
            look.target = place_m

    def draw(self, generator: np.random.Generator) -> tuple[FloatArray, ...] | None:
        """Return a random reachable target for each hand, shape (3,), [m], or None if none is found."""
        return self._places.draw(self._data, generator)

    def errors(self) -> tuple[list[float], list[float]]:
        """Return the present errors of the hands, [m], and of the eyes, [rad]."""
        errors = list(self._control.errors()[self._first :])
        return errors[: len(self._reaches)], errors[len(self._reaches) :]

    def _steady(self) -> list[Posture | OrientationTask]:
        """Return the objectives that keep the infant stable: first the posture of its legs, then an upright chest.

        For an infant that lies, these are only the postures of legs and spine, since the ground supports its chest.
        """
        roots = [self._model.body(leg.root).id for leg in self._manifest.anatomy.legs]
        legs = self._joints_on(np.flatnonzero(in_subtrees(self._model, roots)))
        if self.lies:
            return [Posture(joints=[*legs, *self._joints_on(self._trunk)])]
        actuators = [self._model.actuator(actuator.name) for actuator in self._manifest.actuation.actuators]
        is_late = any(actuator.actadr >= 0 for actuator in actuators)
        chest = self._data.body(self._trunk[-1])
        gains = LAGGING if is_late else BALANCING
        wanted = chest.xmat.reshape(3, 3)
        wanted = _half_upright(wanted) if self.sits_freely else wanted
        return [Posture(joints=legs), OrientationTask(chest.name, wanted, gains=gains)]

    def _loose_feet(self) -> list[str]:
        """Return the feet of a sitting infant, which may slide; counted as sticking, they creep until legs cross.

        The feet of a standing infant, whose hip is high above them, stick.
        """
        feet = [leg.end for leg in self._manifest.anatomy.legs if leg.end]
        root_m = self._data.body(self._manifest.root_body).xpos
        away_m = [root_m - self._data.body(foot).xpos for foot in feet]
        return [foot for foot, way in zip(feet, away_m, strict=True) if way[2] < 0.5 * np.linalg.norm(way)]

    def _joints_on(self, bodies: Collection[int]) -> list[str]:
        actuators = [actuator for actuator in self._manifest.actuation.actuators if actuator.commanded]
        joints = [self._model.joint(actuator.joint) for actuator in actuators]
        names = (joint.name for joint in joints if self._model.jnt_bodyid[joint.id] in bodies)
        return list(dict.fromkeys(map(self._manifest.of_infant, names)))


def _half_upright(orientation: FloatArray) -> FloatArray:
    """Return an orientation, shape (3, 3), with half of its lean.

    It is turned from up to the bisector b of up and the vertical, by I + V + V² / (1 + up b) with V w = (up x b) x w.
    With the whole lean of its start pose, 14 degrees, a nine-month-old needs 2.7 of the 4.1 N m of its hips before it
    reaches.
    """
    up = orientation[:, 2]
    bisector = up + np.array([0.0, 0.0, 1.0])
    bisector /= np.linalg.norm(bisector)
    turn = np.cross(np.cross(up, bisector), np.eye(3)).T
    return (np.eye(3) + turn + turn @ turn / (1.0 + up @ bisector)) @ orientation


NEXT_TARGETS_S = 1.5  # How long hands have to get to their targets.
REACHED_M = 0.02  # A hand that was this near to its target at any time before the next one has reached it; a choice.


class ReachPolicy:
    """Hands reach for random targets, or for the ball of the task `reach`; eyes look at the target of one hand.

    Hands and eyes that take no commands are left out.
    """

    def __init__(
        self,
        env: Infant,
        gains: ReachGains | None = None,
        next_targets_s: float = NEXT_TARGETS_S,
        *,
        reads_truth: bool = False,
    ):
        """Bind it to an infant; ControlError if it has servos, or no hand that takes commands.

        Without *gains*, these are gentle for an infant that sits freely, and strong for all others; other targets are
        drawn after a time. An infant with the senses for it acts from its own estimate of its body, unless it
        *reads_truth*.
        """
        self._env, self._gains, self._reads_truth = env, gains, reads_truth
        self._period = max(1, round(next_targets_s / ms_to_s(env.manifest.step_ms)))
        self._steps = 0
        self._errors_m: list[list[float]] = []  # Errors of each turn just before the next targets, by hand.
        self._least_m: list[list[float]] = []  # Least errors of each turn, by hand.
        self._fell_after_s: float | None = None
        self._bind()

    def __call__(self, generator: np.random.Generator, observation: Observation) -> npt.NDArray[np.float32]:
        """Return the action."""
        if self._env.model is not self._model:
            self._bind()  # The scene has changed.
        turn, step = divmod(self._steps, self._period)
        if self._ball is not None:
            self._control.aim([self._env.data.xpos[self._ball]] * len(self._control.hands))
        elif step == 0:
            if turn:
                self._errors_m.append(self.errors()[0])
            self._least_m.append([np.inf] * len(self._control.hands))
            places_m = self._control.draw(generator)
            if places_m is not None:  # Where there are none to be had, hands keep those that they have.
                self._control.aim(places_m, turn)
        if self._control.sits_freely and self._fell_after_s is None and self._control.lies:
            self._fell_after_s = ms_to_s(self._steps * self._env.manifest.step_ms)
        if self._ball is None:
            self._least_m[-1] = [*map(min, self._least_m[-1], self.errors()[0])]
        self._steps += 1
        if self._felt is None:
            return self._control()
        return self._felt(observation, self._control.targets)

    def errors(self) -> tuple[list[float], list[float]]:
        """Return how far each hand [m] and each eye [rad] is from its target now."""
        return self._control.errors()

    def notes(self) -> tuple[str, ...]:
        """Return in sentences what the infant knows that its senses do not tell."""
        return told_of(self._env.manifest, self._reads_truth, self._felt.estimate.times_lost if self._felt else 0)

    def metrics(self) -> dict[str, float]:
        """Return what a run tells of reaching, as far as there is something to tell.

        `hand_error_m` is the median distance of hands from their targets just before others are drawn, `hand_targets`
        the number of targets that each hand has had for the whole time; of each hand, `left_hand_error_m` is the same,
        and `left_hand_reached_share` the share of its targets to which it came within `REACHED_M`. `fell_after_s` is
        the simulated time after which an infant that sat freely fell over.
        """
        metrics: dict[str, float] = {}
        if self._errors_m:
            errors_m = np.array(self._errors_m)
            least_m = np.array(self._least_m[: len(self._errors_m)])
            metrics = {"hand_error_m": float(np.median(errors_m)), "hand_targets": len(errors_m)}
            for number, hand in enumerate(self._control.hands):
                hand = self._env.manifest.of_infant(hand)
                metrics[f"{hand}_error_m"] = float(np.median(errors_m[:, number]))
                metrics[f"{hand}_reached_share"] = float(np.mean(least_m[:, number] <= REACHED_M))
        if self._fell_after_s is not None:
            metrics["fell_after_s"] = self._fell_after_s
        return metrics

    def _bind(self) -> None:
        env = self._env
        self._model = env.model
        self._control = ReachController(env.model, env.data, env.manifest, self._gains)
        is_told = self._reads_truth or lacking(env.manifest)
        self._felt = None if is_told else FeltReach(env, self._gains)
        task: Any = env.manifest.task
        self._ball = env.model.body(task.ball.body).id if task.kind == "reach" else None


class FeltReach:
    """Reaching from what an infant takes the state of its body to be, when the commands that it sends now act."""

    def __init__(self, env: Infant, gains: ReachGains | None):
        """Bind it to an infant with the senses for it."""
        self._env, self._gains = env, gains
        infant, timing = DrivenInfant.of(env.model, env.manifest), timing_of(env.manifest, env.senses)
        organs = Organs.of(env.model, env.manifest, timing, SenseNoise.of(env))
        self.estimate = Estimate(infant, env.actuation.actuators, timing, organs)
        """What the infant takes the state of its body to be."""
        self._reader = Reader(env)
        self._control: ReachController | None = None

    def __call__(self, observation: Observation, targets: "Targets") -> npt.NDArray[np.float32]:
        """Return the action for what is observed; an episode begins with its first call, or where its steps are 0."""
        env, estimate = self._env, self.estimate
        if not np.isfinite(env.data.qpos).all():  # The simulation became unstable, and the episode is over.
            return np.clip(0.0, env.actuation.low, env.actuation.high).astype(np.float32)
        if self._control is None or env.steps == 0:
            held = env.data.ctrl[env.actuation.actuators].copy()
            estimate.begin(env.data, held, _settled(env, self._gains))
            self._control = ReachController(env.model, estimate.data, env.manifest, self._gains)
        estimate.see(self._reader(observation), env.data, env.schedule.sent)
        self._control.targets = targets
        action = self._control()
        for number in range(estimate.control_steps):
            estimate.advance(number, action.astype(np.float64))
        return estimate.send(action.astype(np.float64)).astype(np.float32)


def _settled(env: Infant, gains: ReachGains | None) -> mujoco.MjData:
    """Return the state after the infant has kept its hands where they are for some time, knowing all."""
    model, data = env.model, copy.copy(env.data)
    control = ReachController(model, data, env.manifest, gains)
    for _ in range(round(RESTING_S / ms_to_s(env.manifest.step_ms))):
        data.ctrl[env.actuation.actuators] = control()
        mujoco.mj_step(model, data, round(ms_to_s(env.manifest.step_ms) / model.opt.timestep))
    mujoco.mj_forward(model, data)
    return data


def bind(env: Infant, text: str = "") -> ReachPolicy:
    """Return the policy for an environment; see `ReachPolicy`. The text `truth` lets it read the simulation."""
    if text not in ("", TRUTH):
        raise PolicyError(f"'reach' does not take '{text}'; write reach or reach:{TRUTH}")
    return ReachPolicy(env, reads_truth=text == TRUTH)


@dataclass(frozen=True, slots=True)
class ReachErrors:
    """Errors of hands and eyes in n trials of t control steps."""

    time_s: FloatArray  # Since the targets were drawn, shape (t + 1,), from 0 on.
    hands_m: FloatArray  # Distance of each hand from its target, shape (n, t + 1, number of hands).
    eyes_rad: FloatArray  # Angle between each eye's line of sight and its target, shape (n, t + 1, number of eyes).


def reach_errors(
    env: InfantEnv,
    gains: ReachGains,
    generator: np.random.Generator,
    trials: int = 10,
    seconds: float = 2.0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> ReachErrors:
    """Let an infant that knows the state of its body reach for random targets, and return the errors over time.

    It is reset for each trial, which has a target for each hand; the eyes look at that of the first. Raises a
    ControlError if it has servos, or no hand that takes commands.
    """
    step_s = ms_to_s(env.manifest.step_ms)
    steps = round(seconds / step_s)
    trials_errors = []
    for trial in range(trials):
        observation, _ = env.reset(seed=trial)
        policy = ReachPolicy(env, gains, seconds + step_s, reads_truth=True)
        action = policy(generator, observation)
        errors = [policy.errors()]
        for _ in range(steps):
            observation, *_ = env.step(action)
            errors.append(policy.errors())
            action = policy(generator, observation)
        trials_errors.append(([hands for hands, _ in errors], [eyes for _, eyes in errors]))
        progress(trial + 1, trials)
    hands_m, eyes_rad = (np.array(errors) for errors in zip(*trials_errors, strict=True))
    return ReachErrors(step_s * np.arange(steps + 1, dtype=np.float64), hands_m, eyes_rad)
