"""The control step of an infant: commands applied and senses sampled with their delays, in whole physics steps.

Signals on their way keep their content and their order while the delays of a growing infant change.
"""

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Generic, TypeVar

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.state_form import check_form, checked_list, require
from mimoc.base.units import ms_to_s
from mimoc.bundle.model import out_of_memory
from mimoc.runtime.actuation import Actuation, numbers_of
from mimoc.runtime.companion import Companions
from mimoc.runtime.delays import DelayedCommands, DelayedSamples, Timing, carry_on, within
from mimoc.runtime.noise import NoiseStreams, NoisyMotors, bind_motor_noise, is_disturbed, noise_of
from mimoc.runtime.sense import FloatArray, Observation, Sample, Sense, check_sense
from mimoc.runtime.sound import VOICE_LOW, Voice


@dataclass(frozen=True)
class Segment:
    """A part of a control step: commands are applied, physics steps are made, senses are sampled."""

    commands: tuple[DelayedCommands, ...]
    physics_steps: int
    samples: tuple[tuple[str, tuple[DelayedSamples, ...]], ...]
    """The senses to be sampled at the end, each once, by name, with the delays that the sample goes into."""


class Schedule:
    """The time table of a control step: it is cut into segments wherever a command arrives or a sense is sampled."""

    def __init__(
        self,
        senses: Mapping[str, Sense],
        actuation: Actuation,
        model: mujoco.MjModel,
        timing: Timing,
        streams: NoiseStreams | None = None,
        companions: Companions | None = None,
        voice: Voice | None = None,
    ):
        streams = streams or NoiseStreams(0)
        self._senses, self._actuation, self._period = senses, actuation, timing.period
        self.companions = companions or Companions({}, streams)
        self.samples = {
            name: timing.samples(name, None if sense.bodies is None else within(model, sense.bodies), streams)
            for name, sense in senses.items()
        }
        moved = model.jnt_bodyid[model.actuator_trnid[actuation.actuators, 0]]
        self._commands = timing.commands(within(model, moved), actuation.actuators, streams)
        self._voice, self._width = voice, len(actuation.low)
        self._spoken = timing.further_commands(self._width, len(VOICE_LOW), streams) if voice else []
        self._commands += self._spoken
        self._noisy = {
            name: noise for name, sense in senses.items() if (noise := noise_of(name, sense, timing.noise, streams))
        }
        self._motor_noise: NoisyMotors | None = None
        if is_disturbed(timing.noise, actuation):
            noise = bind_motor_noise(timing.noise, actuation)
            timestep_s = ms_to_s(timing.timestep_ms)
            self._motor_noise = NoisyMotors(noise, timing.period, timestep_s, actuation, streams)
        self._is_checked = False
        self.sent: FloatArray | None = None
        """Controls of the last action without noise, in its order: the efference copy; None before the first."""
        self._jittered = [line for delayed in self.samples.values() for line in delayed if line.delay.jitter]
        is_jittered = self._jittered or any(commands.delay.jitter for commands in self._commands)
        self._segments = None if is_jittered else self._cut()

    def reset(self, data: mujoco.MjData) -> None:
        """Forget all signals: the present samples are observed until later ones arrive, and nothing is commanded."""
        self.sent = None
        if self._motor_noise:
            self._motor_noise.reset(data)
        for noise in self._noisy.values():
            noise.reset()
        for name, delayed in self.samples.items():
            sample = self.disturb(name, self._senses[name](data), data)
            if not self._is_checked:
                check_sense(name, self._senses[name], sample)
            for line in delayed:
                line.reset(sample)
        self._is_checked = True
        for commands in self._commands:
            commands.reset()
        if self._voice:
            self._voice.reset()

    def controls(self, action: npt.ArrayLike, data: mujoco.MjData) -> FloatArray:
        """Return the controls of an action, followed by the commands of a voice, if there is one."""
        if self._voice is None:
            return self._actuation.controls(action, data)
        numbers = numbers_of(action)
        if numbers.shape != (self._width + len(VOICE_LOW),) or not np.isfinite(numbers).all():
            shape = (self._width + len(VOICE_LOW),)
            raise ValueError(f"expected a finite action of shape {shape}, got {numbers!r:.60} of shape {numbers.shape}")
        return np.concatenate([self._actuation.controls(numbers[: self._width], data), numbers[self._width :]])

    def begin(self, controls: FloatArray) -> tuple[Segment, ...]:
        """Take the controls of an action, and return the segments of the control step."""
        self.sent = controls
        for commands in self._commands:
            commands.begin(controls)
        for samples in self._jittered:
            samples.begin()
        if self._motor_noise:
            self._motor_noise.begin()
        return self._segments or self._cut()

    def command(self, segment: Segment, data: mujoco.MjData) -> None:
        """Apply the commands that arrive at the start of a segment, and let companions act, before physics steps."""
        noise = self._motor_noise
        for commands in segment.commands:
            if self._voice and commands in self._spoken:
                commands.apply(self._voice.commanded)
            else:
                commands.apply(noise.commanded if noise else data.ctrl)
        if noise:
            noise(data)
        if self.companions:
            self.companions.before_step(data)

    def sample(self, segment: Segment, data: mujoco.MjData) -> None:
        """Let companions see the state after a segment's physics steps, and sample the senses that are due then."""
        if self.companions:
            self.companions.after_step(data)
        for name, delayed in segment.samples:
            sample = self.disturb(name, self._senses[name](data), data)
            for line in delayed:
                line.send(sample)

    def is_noisy(self, name: str) -> bool:
        """Return whether the samples of a sense have noise."""
        return name in self._noisy

    def disturb(self, name: str, sample: Sample, data: mujoco.MjData) -> Sample:
        """Add the noise of a sense to its sample."""
        return self._noisy[name].at(data.time, sample) if name in self._noisy else sample

    def observe(self) -> Observation:
        """Return the samples that have arrived as an observation of new arrays."""
        observation: Observation = {}
        for name, sense in self._senses.items():
            observation.update(sense.observe(arrived(self.samples[name])))
        return observation

    @property
    def state(self) -> dict[str, Any]:
        """The samples that have arrived, all signals on their way, and the noise."""
        return {
            "senses": {name: [line.state for line in delayed] for name, delayed in self.samples.items()},
            "commands": [commands.state for commands in self._commands],
            "noise": {name: noise.state for name, noise in self._noisy.items()},
            "motor_noise": self._motor_noise and self._motor_noise.state,
            **({"voice": self._voice.commanded} if self._voice else {}),
        }

    @state.setter
    def state(self, state: Mapping[str, Any]) -> None:
        self.sent = None
        for name, delayed in self.samples.items():
            for line, kept in zip(delayed, state["senses"][name], strict=True):
                line.state = kept
        for commands, kept in zip(self._commands, state["commands"], strict=True):
            commands.state = kept
        for name, noise in self._noisy.items():
            noise.state = state["noise"][name]
        if self._motor_noise:
            self._motor_noise.state = state["motor_noise"]
        if self._voice:
            self._voice.commanded = state["voice"]

    def check(self, state: Mapping[str, Any], time_s: float) -> None:
        """Check the signals in a state, and that no noise was drawn after a time of the simulation [s]."""
        for name, delayed in self.samples.items():
            where = f"signals.senses.{name}"
            for line, kept in zip(delayed, checked_list(state["senses"][name], where, len(delayed)), strict=True):
                line.check(kept, where)
        if self._voice:
            check_form(state["voice"], self._voice.commanded, "signals.voice")
        where = "signals.commands"
        on_their_way = checked_list(state["commands"], where, len(self._commands))
        for commands, kept in zip(self._commands, on_their_way, strict=True):
            commands.check(kept, where)
        for name in self._noisy:
            drawn_s = state["noise"][name][0]
            require(drawn_s <= time_s, f"signals.noise.{name}", drawn_s)

    def carry_on(self, former: "Schedule", data: mujoco.MjData) -> None:
        """Continue with the signals of the same infant at another age, whose schedule is left as it is."""
        for name, delayed in self.samples.items():
            carry_on(delayed, former.samples[name])
        carry_on(self._commands, former._commands)
        if self._voice and former._voice:
            self._voice.commanded = former._voice.commanded.copy()
        for name, noise in self._noisy.items():
            if name in former._noisy:
                noise.state = former._noisy[name].state
        if self._motor_noise and former._motor_noise:
            self._motor_noise.state = former._motor_noise.state
        elif self._motor_noise:
            self._motor_noise.reset(data)

    def _cut(self) -> tuple[Segment, ...]:
        """Return the segments of a control step; with noise of commands or companions, each is one physics step."""
        sampled = {after for delayed in self.samples.values() for line in delayed for after in line.sampled_after}
        applied = {after for commands in self._commands for after in commands.applied_after}
        single = range(self._period) if self._motor_noise or self.companions else ()
        cuts = sorted({0, self._period, *sampled, *applied, *single})
        return tuple(
            Segment(
                commands=tuple(commands for commands in self._commands if start in commands.applied_after),
                physics_steps=end - start,
                samples=tuple(
                    (name, due)
                    for name, delayed in self.samples.items()
                    if (due := tuple(line for line in delayed if end in line.sampled_after))
                ),
            )
            for start, end in pairwise(cuts)
        )


def arrived(delayed: Sequence[DelayedSamples]) -> Sample:
    """Return what has arrived of all parts of a sense as one sample, which is not to be changed."""
    sample = delayed[0].arrived
    if len(delayed) > 1:
        sample = sample.copy()
        for line in delayed[1:]:
            sample[line.part] = line.arrived[line.part]
    return sample


Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True, slots=True)
class MergedSegment(Generic[Key]):
    """A part of a control step in which no infant's command arrives and no sense is sampled.

    anna    |--- 2 ---|--- 2 ---|
    ben     |-- 1 -|----- 3 ----|
    merged  |  1   |1 |    2    |
    """

    begun: Sequence[tuple[Key, Segment]]  # The segments that begin at its start, with their infants.
    physics_steps: int
    ended: Sequence[tuple[Key, Segment]]  # The segments that end at its end, likewise.


def merge_segments(segments: Mapping[Key, Sequence[Segment]]) -> list[MergedSegment[Key]]:
    """Merge the segments of infants whose control steps are equally long."""
    begun: defaultdict[int, list[tuple[Key, Segment]]] = defaultdict(list)
    ended: defaultdict[int, list[tuple[Key, Segment]]] = defaultdict(list)
    for infant, parts in segments.items():
        time = 0
        for segment in parts:
            begun[time].append((infant, segment))
            time += segment.physics_steps
            ended[time].append((infant, segment))
    cuts = sorted({*begun, *ended})
    return [MergedSegment(begun[start], end - start, ended[end]) for start, end in pairwise(cuts)]


class ControlStep(Generic[Key]):
    """The control step of all infants of one simulation, cut wherever one of them has a command or a sample due."""

    def __init__(self, schedules: Mapping[Key, Schedule], datas: Mapping[Key, mujoco.MjData]):
        self._schedules, self._datas = schedules, datas
        self._data = next(iter(datas.values()))
        self._model = self._data.model
        self._segments: dict[Key, tuple[Segment, ...]] = {}
        self._parts: Sequence[MergedSegment[Key]] = ()

    def __call__(self, controls: Mapping[Key, FloatArray]) -> None:
        """Make a control step of some infants with these controls; see `Schedule.controls`."""
        schedules, datas = self._schedules, self._datas
        segments = {key: schedules[key].begin(given) for key, given in controls.items()}
        if segments != self._segments:  # Without jitter, they are the same objects in each control step.
            self._segments, self._parts = segments, merge_segments(segments)
            self._plan(self._parts)
        for number, part in enumerate(self._parts):
            for key, segment in part.begun:
                schedules[key].command(segment, datas[key])
            self._simulate(number, part)

    def _plan(self, parts: Sequence[MergedSegment[Key]]) -> None:
        """Prepare for the parts of the control steps to come."""

    def _simulate(self, number: int, part: MergedSegment[Key]) -> None:
        """Make the physics steps of a part, and sample what is due at its end."""
        try:
            mujoco.mj_step(self._model, self._data, part.physics_steps)
        except mujoco.FatalError as error:
            raise out_of_memory(error) from None
        for key, segment in part.ended:
            self._schedules[key].sample(segment, self._data)
