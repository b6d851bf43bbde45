"""The nervous system of an infant in a trial: delays and noise of its senses and commands, and control across them.

A trial has no environment. The infant of the runtime is bound to its model all the same, so that commands and samples
are delayed and disturbed by the runtime's own schedule, and the controller acts in the estimate that behaviours act
from (`mimoc.policies.control.estimate`).
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.compiler.building import builder
from mimoc.policies.control.balance import Balance
from mimoc.policies.control.estimate import NEEDED, Estimate, Organs, Reader, SenseNoise
from mimoc.policies.control.holding import EstimatedHolding, Servo
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.control_step import Segment
from mimoc.runtime.delays import timing_of
from mimoc.runtime.infant import Custom, Infant
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import ACTUATIONS
from mimoc.schema.scene import SceneSpec
from mimoc.schema.senses import noise_keys

CONTROL_MS = 10.0  # How often commands are sent.
OWN_DELAYS = "physiological"  # The delays of an infant that asks for none: those of its age.
OWN_NOISE: Mapping[str, Any] = {
    "motor": "maturing",
    "vestibular_thresholds": "age",
    "proprioception_deg": 0.5,
}
"""The noise of an infant that asks for none: of commands and balance as at its age; half a degree in its joints, which
is a choice, as nobody has measured how well an infant feels a posture that it keeps."""


def with_own_nerves(spec: InfantSpec, *, delays: bool, noise: bool) -> InfantSpec:
    """Return a spec, alone on a flat floor, with the senses of balance and joints, and its own delays and noise.

    One that asks for no delays or no noise has those of its age, if they are wanted at all.
    """
    control = spec.control
    step_ms = max(round(CONTROL_MS / control.timestep_ms), 1) * control.timestep_ms
    senses = type(spec.senses)(**{name: getattr(spec.senses, name) or {} for name in NEEDED})
    return spec.model_copy(
        update={
            "scene": SceneSpec(pose=spec.scene.pose),
            "task": None,
            "body": spec.body.model_copy(update={"skin": False}),
            "senses": senses,
            "delays": _own_delays(spec) if delays else type(spec.delays)(),
            "noise": _own_noise(spec, delays) if noise else type(spec.noise)(),
            "control": control.model_copy(update={"step_ms": step_ms}),
        }
    )


def _own_delays(spec: InfantSpec) -> Any:
    asked = spec.delays
    return asked.model_copy(update={"preset": OWN_DELAYS}) if asked.preset == "none" else asked


def _own_noise(spec: InfantSpec, delays: bool) -> Any:
    """Return the noise of commands and of the senses that a trial has."""
    asked = spec.noise
    own = type(asked)(**OWN_NOISE) if asked == type(asked)() else asked
    changes: dict[str, object] = {key: 0.0 for name, key in noise_keys().items() if name not in NEEDED}
    if not ACTUATIONS[spec.actuation.model].command_is_effort:
        changes["motor"] = 0.0  # What a servo is told is no effort.
    if not delays:
        changes["delay_jitter_ms"] = 0.0
    return own.model_copy(update=changes)


def nerves_of(spec: InfantSpec, *, delays: bool, noise: bool) -> Bundle:
    """Return the bundle that tells the runtime of an infant with its own delays and noise."""
    own = with_own_nerves(spec, delays=delays, noise=noise)
    return builder(own)(own.scene.seed, check=False)


class NervousControl:
    """Lets an infant go to angles from what its senses tell, for some times from one posture."""

    def __init__(
        self,
        infant: DrivenInfant,
        bundle: Bundle,
        start: mujoco.MjData,
        gains: Servo,
        target: Callable[[mujoco.MjData, float], FloatArray],
        balance: Balance | None,
        held: Sequence[int] = (),
        apparatus: Callable[[mujoco.MjData, float], None] | None = None,
    ):
        """Bind it to the model of an infant.

        Args:
            infant: The infant, with what an apparatus holds of it fixed.
            bundle: What the runtime is told of it; see `nerves_of`.
            start: The posture, with all that is derived from it.
            gains: Those of the controller.
            target: Returns the angles that the driven hinges go to, shape (n,), in a state and after a time in [s].
            balance: Turns it back to how it stands in the posture.
            held: Degrees of freedom that an apparatus holds, as the infant knows.
            apparatus: Moves what an apparatus moves, after a time in [s], as the infant knows as well.
        """
        model = infant.model
        self._infant, self._target = infant, target
        self._apparatus = apparatus
        self._own = own = Infant(Custom())
        own.bind(bundle, model, start)
        timing = timing_of(own.manifest, own.senses)
        self._actuators: IntArray = own.actuation.actuators
        self._rest = np.clip(0.0, own.actuation.low, own.actuation.high)
        organs = Organs.of(model, own.manifest, timing, SenseNoise.of(own))
        self._estimate = Estimate(infant, self._actuators, timing, organs, held=held)
        rows = np.arange(len(self._actuators))
        self._holding = EstimatedHolding(infant, gains, self._actuators, rows, self._estimate)
        self._read = Reader(own)
        self._balance = balance
        self._low_rad, self._high_rad = model.jnt_range[infant.joints].T
        self._period = timing.period
        self._settled: mujoco.MjData | None = None  # The state into which the posture settles.
        self._segments: Mapping[int, Segment] = {}
        self._ends: Mapping[int, Segment] = {}

    def begin(self, data: mujoco.MjData, seed: int) -> None:
        """Begin in the posture, which its muscles have held for some time; random numbers follow from the seed."""
        own = self._own
        settled = self._settled = self._settled or self._settle(data)
        if self._balance:  # Nobody lets go of an infant before it sits or stands.
            data.qpos[:] = settled.qpos
        self._holding.begin(data, settled)
        mujoco.mj_forward(own.binding.model, data)
        own.draw_from(seed)
        own.schedule.reset(data)

    def _settle(self, data: mujoco.MjData) -> mujoco.MjData:
        pose_rad = data.qpos[self._infant.angles].copy()
        settled = self._holding.settled(data, pose_rad, self._rest, np.empty(0, np.intp))
        if self._balance:
            self._balance.keep(settled)
        return settled

    def before(self, step: int, data: mujoco.MjData) -> None:
        """Set the controls of a physics step, and choose the next commands when a control step begins."""
        own, at = self._own, step % self._period
        if at == 0:
            self._estimate.see(self._read(own.observe()), data, own.schedule.sent)
            time_s = step * own.binding.model.opt.timestep
            if self._apparatus:
                self._lead(self._apparatus, step)
            commands = self._holding(lambda ahead, _: self._angles_rad(ahead, time_s), self._rest)
            self._cut(own.schedule.begin(own.schedule.controls(commands, data)))
        if at in self._segments:
            own.schedule.command(self._segments[at], data)

    def after(self, step: int, data: mujoco.MjData) -> None:
        """Sample the senses that are due after a physics step."""
        end = step % self._period + 1
        if end in self._ends:
            self._own.schedule.sample(self._ends[end], data)

    def _lead(self, apparatus: Callable[[mujoco.MjData, float], None], step: int) -> None:
        """Move what an apparatus moves in the estimate, at the time of the estimate."""
        step_s = self._own.binding.model.opt.timestep
        apparatus(self._estimate.data, (step + self._estimate.lead_steps) * step_s)

    def _angles_rad(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        angles_rad = self._target(ahead, time_s)
        if self._balance is None:
            return angles_rad
        low_rad, high_rad = np.minimum(self._low_rad, angles_rad), np.maximum(self._high_rad, angles_rad)
        return np.minimum(np.maximum(angles_rad + self._balance(ahead), low_rad), high_rad)

    def _cut(self, segments: tuple[Segment, ...]) -> None:
        """Find the physics steps of the control step before which segments begin, and after which they end."""
        ends = np.cumsum([segment.physics_steps for segment in segments]).tolist()
        self._segments = dict(zip([0, *ends], segments, strict=False))
        self._ends = dict(zip(ends, segments, strict=True))
