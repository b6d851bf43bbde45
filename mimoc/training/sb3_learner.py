"""Stable-Baselines3's agents, which learn from infants on the CPU."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from stable_baselines3.common.logger import Logger
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.base.units import ms_to_s
from mimoc.recording.recorder import Recording
from mimoc.runtime.env import InfantEnv
from mimoc.training.agents import make_agent, pack_policy, start_interval
from mimoc.training.checkpoint import Progress, pack, restore
from mimoc.training.curve import CurvePoint, DeviceUse
from mimoc.training.settings import TrainingSettings
from mimoc.training.tracking import Recorder, RewardWatch
from mimoc.training.vector_env import seek


class SB3Learner:
    """PPO or SAC of Stable-Baselines3 with its environments; see `Learner`."""

    def __init__(self, settings: TrainingSettings, infant: InfantEnv, env: VecNormalize, recording: Recording | None):
        self._settings, self._infant, self._env, self._recording = settings, infant, env, recording
        self._agent, self._watch = make_agent(env, settings), RewardWatch()
        self._recorder: Recorder
        self._interval_steps = 0

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""
        self._agent.set_logger(logger)

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        return restore(checkpoint, self._agent, self._env)

    def begin(self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]) -> None:
        """Begin an interval."""
        settings, step_s = self._settings, ms_to_s(self._infant.manifest.step_ms)
        self._recorder = Recorder(before, step_s, report, on_row, self._watch)
        seek(self._env, settings, before.steps)
        if self._recording is not None:  # What a killed process has recorded of this interval comes again.
            self._recording.mark(settings.digest(), before.steps)
        start_interval(self._agent, settings.seed)
        self._interval_steps = settings.end_of_interval(before.steps) - before.steps

    def learn(self, others: Sequence[Any] = ()) -> None:
        """Learn until the end of the interval; on the CPU, there are no others."""
        self._agent.learn(self._interval_steps, self._recorder, reset_num_timesteps=False)

    def progress(self) -> Progress:
        """Return the progress at the end of what was learnt last, or where that was interrupted."""
        return self._recorder.progress()

    @property
    def has_learnt(self) -> bool:
        """Whether it was updated since it was made or restored."""
        return self._agent._n_updates > 0  # pyright: ignore[reportAttributeAccessIssue] - Of on- and off-policy algorithms.

    def policy(self) -> bytes:
        """Return the content of the file of its policy."""
        return pack_policy(self._agent, self._env, self._settings, self._infant)

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint file."""
        return pack(self._agent, self._env, reached)

    def use(self, others: Sequence[Any] = ()) -> list[DeviceUse | None]:
        """Return that nothing was taken of a device."""
        return [None]


@contextmanager
def sb3_learner(
    settings: TrainingSettings, infant: InfantEnv, open_envs: Callable[[], VecNormalize], record: str | Path | None
) -> Iterator[list[SB3Learner]]:
    """Open the parallel environments, recorded in a folder if there is one, and what learns from them."""

    def close() -> None:
        with suppress(EOFError, OSError):  # After Ctrl-C, which also ends their processes.
            env.close()

    env = open_envs()
    with ExitStack() as opened:
        opened.callback(close)
        together: Any = env.unwrapped
        recording = opened.enter_context(Recording(together.infants.infants, record)) if record is not None else None
        yield [SB3Learner(settings, infant, env, recording)]
