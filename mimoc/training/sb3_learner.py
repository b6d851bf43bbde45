"""Learning on the CPU, by Stable-Baselines3."""

from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stable_baselines3.common.vec_env import VecNormalize

from mimoc.base.units import ms_to_s
from mimoc.runtime.env import InfantEnv
from mimoc.training.agents import has_learnt, make_agent, start_interval
from mimoc.training.checkpoint import Progress, pack, restore
from mimoc.training.learner import OnRow, Report
from mimoc.training.policies import pack_policy
from mimoc.training.settings import TrainingSettings
from mimoc.training.tracking import Recorder, RewardWatch, tracked
from mimoc.training.vector_env import seek


@dataclass(frozen=True)
class Sb3Interval:
    """Learning from one checkpoint to the next."""

    agent: Any
    recorder: Recorder

    def learn(self, until: int) -> None:
        """Learn until so many control steps were taken."""
        self.agent.learn(until - self.agent.num_timesteps, self.recorder, reset_num_timesteps=False)

    def progress(self) -> Progress:
        """Return the progress so far."""
        return self.recorder.progress()


class Sb3Learner:
    """An agent of Stable-Baselines3's with its environments."""

    def __init__(self, settings: TrainingSettings, infant: InfantEnv, open_envs: Callable[[], VecNormalize]):
        """Open the environments; *infant* is one like those in them."""
        self._settings, self._infant, self._env = settings, infant, open_envs()
        self._agent, self._watch = make_agent(self._env, settings), RewardWatch()

    @property
    def infants(self) -> Any:
        """All environments together, for a recording."""
        together: Any = self._env.unwrapped
        return together.infants.infants

    def restore(self, checkpoint: bytes) -> Progress:
        """Go on from a checkpoint."""
        return restore(checkpoint, self._agent, self._env)

    def interval(self, before: Progress, report: Report, on_row: OnRow) -> Sb3Interval:
        """Begin an interval."""
        seek(self._env, self._settings, before.steps)
        step_s = ms_to_s(self._infant.manifest.step_ms)
        start_interval(self._agent, self._settings.seed)
        return Sb3Interval(self._agent, Recorder(before, step_s, report, on_row, self._watch))

    def has_learnt(self) -> bool:
        """Return whether anything was learnt since it was made or restored."""
        return has_learnt(self._agent)

    def policy(self) -> bytes:
        """Return the content of the policy's file."""
        return pack_policy(self._agent, self._env, self._settings, self._infant)

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint."""
        return pack(self._agent, self._env, reached)

    def tracked(self, folder: Path) -> AbstractContextManager[None]:
        """Tell trackers of what is learnt within the context."""
        return tracked(self._agent, folder, self._settings.data())

    def speed(self) -> str:
        """Return nothing."""
        return ""

    def close(self) -> None:
        """Close the environments."""
        with suppress(EOFError, OSError):  # After Ctrl-C, which also ends their processes.
            self._env.close()
