"""The physics of many infants, shared among threads: each has its own model and its own state."""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np

from mimoc.senses.sense import FloatArray


class Physics:
    """The simulations of n infants.

    MuJoCo lets go of Python's lock while it steps, so threads of one process use all cores.
    """

    def __init__(self, models: Sequence[mujoco.MjModel], datas: Sequence[mujoco.MjData], threads: int | None = None):
        """Simulate infants.

        Args:
            models: The model of each; they may differ, and may change at any time.
            datas: The state of each, likewise.
            threads: How many to use, or all that this process may use.
        """
        self._models, self.datas = list(models), list(datas)
        self.threads = threads or usable_threads()
        self._pool = ThreadPoolExecutor(self.threads - 1) if self.threads > 1 else None
        self._views: dict[str, list[FloatArray]] = {}

    def step(self, infants: Sequence[int], steps: int) -> list[int]:
        """Make physics steps; return the infants for which MuJoCo could not, which are left as they were then."""
        failed: list[int] = []
        waiting = iter(infants)
        helpers = min(self.threads, len(infants)) - 1
        futures = [self._pool.submit(self._work, waiting, steps, failed) for _ in range(helpers)] if self._pool else []
        self._work(waiting, steps, failed)
        for future in futures:
            future.result()
        return sorted(failed)

    def array(self, field: str, infants: Sequence[int]) -> FloatArray:
        """Return a field of `MjData` whose size never changes, such as `qpos`, of some infants: shape (k, size)."""
        if field not in self._views:
            self._views[field] = [getattr(data, field) for data in self.datas]
        views = self._views[field]
        chosen = views if len(infants) == len(views) else [views[infant] for infant in infants]
        return np.concatenate(chosen).reshape(len(chosen), *views[0].shape)

    def replace(self, infant: int, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Put another model and state in place of an infant's, as when it has grown."""
        self._models[infant], self.datas[infant] = model, data
        for field, views in self._views.items():
            views[infant] = getattr(data, field)

    def close(self) -> None:
        """End the threads; closing twice is fine."""
        if self._pool:
            self._pool.shutdown()

    def _work(self, waiting: Iterator[int], steps: int, failed: list[int]) -> None:
        """Step the infants that no other thread has taken yet."""
        models, datas = self._models, self.datas
        for infant in waiting:
            try:
                mujoco.mj_step(models[infant], datas[infant], steps)
            except mujoco.FatalError:
                failed.append(infant)


def usable_threads() -> int:
    """Return how many threads this process may run at once: in a container, fewer than there are cores."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
