"""Reaching: hands go to places drawn by chance, and the eyes go along."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.model import in_subtrees
from mimoc.control.gains import Gains
from mimoc.control.inverse_dynamics import InverseDynamics
from mimoc.control.limbs import TRUNK, chest_of
from mimoc.control.objectives import LOOKING, REACHING, Align, LookAt, Reach
from mimoc.control.posture import Posture
from mimoc.control.targets import Reachable
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import FloatArray, Observation
from mimoc.units import ms_to_s

NEXT_TARGETS_S = 1.5
"""How long hands have to get to their targets in a run."""
LEGS = ("right_upper_leg", "left_upper_leg")
"""Bodies; MIMo's names."""
BALANCING = Gains(100.0, viscosity_per_s=20.0)
"""For the chest, which stays as it is while the arms swing."""
LYING = 0.5
"""Cosine of the tilt of the chest beyond which an infant lies, 60°."""
FEET = ("right_foot", "left_foot")
"""Bodies, on the lower legs; MIMo's names."""
GENTLE = "low"
"""Key of `GAIN_SETS` for an infant that sits freely: arms (10 % of its weight) that start at the 80 m/s² of the strong
gains push back with its whole weight and throw it over; at 5 m/s² they do not."""


@dataclass(frozen=True, slots=True)
class ReachGains:
    """How strongly hands and eyes go after their targets."""

    hands: Gains = REACHING
    """For the distance of each hand."""
    eyes: Gains = LOOKING
    """For the misalignment of each eye."""


GAIN_SETS: Mapping[str, ReachGains] = {
    "low": ReachGains(Gains(50.0, cap=0.1, viscosity_per_s=10.0), Gains(56.25, viscosity_per_s=15.0)),
    "medium": ReachGains(Gains(200.0, cap=0.1, viscosity_per_s=20.0), Gains(225.0, viscosity_per_s=30.0)),
    "high": ReachGains(),
}
"""Three sets in which the same errors are answered four times as hard as in the one before, and damped alike: that
each reaches faster is what the paper's figure 5 shows."""


@dataclass(frozen=True, slots=True)
class ReachErrors:
    """How hands and eyes come to their targets, in n trials of t control steps."""

    time_s: FloatArray
    """Since the targets were drawn, shape (t + 1,), from 0 on."""
    hands_m: FloatArray
    """Distance of each hand from its target, shape (n, t + 1, number of hands)."""
    eyes_rad: FloatArray
    """Angle between each eye's line of sight and its target, shape (n, t + 1, 2)."""


class Reaching:
    """A policy: hands reach for places drawn from its generator, and the eyes watch the place of each hand in turn.

    Where the task is to reach, they reach for its ball instead. Hands and eyes that take no commands are left out.
    """

    def __init__(self, env: InfantEnv, gains: ReachGains | None = None, next_targets_s: float = NEXT_TARGETS_S):
        """Bind it to an infant.

        Args:
            env: The infant, with motors or muscles.
            gains: For hands and eyes; None is gentle for an infant that sits freely, and strong for all others.
            next_targets_s: When others are drawn.

        Raises:
            ControlError: If the infant has servos, or no hand.
        """
        gains = gains or (GAIN_SETS[GENTLE] if _sits_freely(env) else ReachGains())
        task: Any = env.manifest.task
        self._env, self._ball = env, task.ball.body if task.kind == "reach" else None
        self._places = Reachable(env)
        self._reaches = [Reach(hand, env.data.body(hand).xipos, gains.hands) for hand in self._places.hands]
        self._looks = [LookAt(eye, self._reaches[0].target, gains=gains.eyes) for eye in self._places.eyes]
        steady = _steady(env)
        self._control = InverseDynamics(env, [*steady, self._reaches, self._looks], loose=_loose_feet(env))
        self._first = sum(isinstance(task, Align) for task in steady)
        self._period = max(1, round(next_targets_s / ms_to_s(env.manifest.step_ms)))
        self._sits = _sits_freely(env)
        self._fell_after_s: float | None = None
        self._taken = 0
        self._came_m: list[float] = []

    def __call__(self, generator: np.random.Generator, observation: Observation) -> npt.NDArray[np.float32]:
        """Return the action; what is observed plays no part in it."""
        return self.act(generator)

    def act(self, generator: np.random.Generator) -> npt.NDArray[np.float32]:
        """Return the action, towards other targets whenever their time has come."""
        turn, step = divmod(self._taken, self._period)
        if self._ball is not None:
            self._go_to([self._env.data.body(self._ball).xpos] * len(self._reaches))
        elif step == 0:
            if turn:
                self._came_m += self.errors()[0]
            self.aim(generator, turn)
        if self._sits and self._fell_after_s is None and _lies(self._env):
            self._fell_after_s = ms_to_s(self._taken * self._env.manifest.step_ms)
        self._taken += 1
        return self._control()

    @property
    def hand_error_m(self) -> float | None:
        """How near hands came to their targets before the next ones were drawn, at the median; None before that."""
        return float(np.median(self._came_m)) if self._came_m else None

    @property
    def fell_after_s(self) -> float | None:
        """When an infant that sat freely fell over, in simulated time; None if it did not."""
        return self._fell_after_s

    def aim(self, generator: np.random.Generator, watched: int = 0) -> None:
        """Draw a target for each hand; the eyes look at that of hand number *watched*, counted round and round.

        Where there are none to be had, hands and eyes stay with those that they have.
        """
        places_m = self._places.draw(generator)
        if places_m is None:
            return
        self._go_to(places_m, watched)

    def _go_to(self, places_m: Sequence[FloatArray], watched: int = 0) -> None:
        for reach, place_m in zip(self._reaches, places_m, strict=True):
            reach.target = place_m
        for look in self._looks:
            look.target = places_m[watched % len(places_m)]

    def errors(self) -> tuple[list[float], list[float]]:
        """Return how far each hand [m] and each eye [rad] is from its target now."""
        errors = list(self._control.errors()[self._first :])
        return errors[: len(self._reaches)], errors[len(self._reaches) :]


def reach_errors(
    env: InfantEnv,
    gains: ReachGains,
    generator: np.random.Generator,
    trials: int = 10,
    seconds: float = 2.0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> ReachErrors:
    """Let an infant reach from its starting pose for targets drawn by chance, and return how that goes.

    Args:
        env: The infant, with motors or muscles; it is reset for each trial.
        gains: For hands and eyes, such as one of `GAIN_SETS`.
        generator: What targets are drawn from.
        trials: Each of which has a target for each hand; the eyes look at that of the first.
        seconds: Simulated time of a trial.
        progress: Is told how many trials are done, and of how many.

    Raises:
        ControlError: If the infant has servos, or no hand.
    """
    step_s = ms_to_s(env.manifest.step_ms)
    steps = round(seconds / step_s)
    found = []
    for trial in range(trials):
        env.reset(seed=trial)
        found.append(_trial(env, Reaching(env, gains, seconds + step_s), generator, steps))
        progress(trial + 1, trials)
    hands_m, eyes_rad = (np.array(errors) for errors in zip(*found, strict=True))
    return ReachErrors(step_s * np.arange(steps + 1, dtype=np.float64), hands_m, eyes_rad)


def _trial(
    env: InfantEnv, reaching: Reaching, generator: np.random.Generator, steps: int
) -> tuple[list[list[float]], list[list[float]]]:
    """Return the errors of hands and of eyes, before the first and after each of some control steps."""
    action = reaching.act(generator)
    errors = [reaching.errors()]
    for _ in range(steps):
        env.step(action)
        errors.append(reaching.errors())
        action = reaching.act(generator)
    return [hands for hands, _ in errors], [eyes for _, eyes in errors]


def _steady(env: InfantEnv) -> list[Posture | Align]:
    """Return what keeps an infant steady while its arms swing: legs first, then an upright chest.

    One that lies only keeps its spine as it is: the ground holds its chest.
    """
    legs, spine = _joints_of(env, LEGS), _joints_of(env, TRUNK, with_limbs=False)
    if _lies(env):
        return [Posture(joints=[*legs, *spine])]
    chest = env.data.body(chest_of(env.model))
    return [Posture(joints=legs), Align(chest.name, chest.xmat.reshape(3, 3), gains=BALANCING)]


def _lies(env: InfantEnv) -> bool:
    return bool(env.data.body(chest_of(env.model)).xmat.reshape(3, 3)[2, 2] < LYING)


def _sits_freely(env: InfantEnv) -> bool:
    """Return whether nothing but the ground holds an upright infant."""
    return not env.manifest.fastenings.welds and not _lies(env)


def _loose_feet(env: InfantEnv) -> list[str]:
    """Return the feet of an infant that sits: counted as held by the ground, they would creep until legs cross.

    Those of one that stands, higher above them than half the way to them, bear it.
    """
    model, data = env.model, env.data
    here = [name for name in FEET if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) > 0]
    root = data.body(env.manifest.root_body).xpos
    away_m = [root - data.body(name).xpos for name in here]
    return [name for name, way in zip(here, away_m, strict=True) if way[2] < 0.5 * np.linalg.norm(way)]


def _joints_of(env: InfantEnv, names: Sequence[str], with_limbs: bool = True) -> list[str]:
    """Return the joints that actuators move of some bodies, and of what hangs on them; bodies may be missing."""
    model = env.model
    found = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in names]
    here = [body for body in found if body > 0]
    chosen = in_subtrees(model, here) if with_limbs else np.isin(np.arange(model.nbody), here)
    moved = dict.fromkeys(model.actuator_trnid[env.actuation.actuators, 0].tolist())
    return [model.joint(joint).name for joint in moved if chosen[model.jnt_bodyid[joint]]]
