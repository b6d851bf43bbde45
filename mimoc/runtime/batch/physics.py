"""The physics of many infants, shared among threads: each has its own model and its own state."""

import os
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from queue import SimpleQueue
from threading import Lock

import mujoco
import numpy as np

from mimoc.bundle.model import BREAKDOWNS
from mimoc.runtime.sense import FloatArray, Sample


class ThreadedPhysics:
    """The simulations of n infants.

    MuJoCo lets go of Python's lock while it steps, so threads of one process use all cores.
    """

    def __init__(self, models: Sequence[mujoco.MjModel], datas: Sequence[mujoco.MjData], threads: int | None = None):
        self.models, self.datas = list(models), list(datas)
        self.threads = threads or usable_threads()
        self._pool: ThreadPoolExecutor | None = None
        self._process = 0
        self._views: dict[str, list[FloatArray]] = {}
        self._warnings = [data.warning.number for data in datas]

    def step(self, groups: Sequence[Sequence[int]], steps: int) -> Generator[Sequence[int], None, None]:
        """Make physics steps of some infants; yield each group of them as soon as all of it has made them.

        While the caller works on a group, other threads go on with the next ones.
        """
        return self._share(partial(self._step_one, steps=steps), groups)

    def in_threads(self, function: Callable[[int], Sample], infants: Sequence[int]) -> list[Sample]:
        """Return what a function returns for some infants, called in any thread."""
        samples: dict[int, Sample] = {}

        def call(infant: int) -> None:
            samples[infant] = function(infant)

        for _ in self._share(call, [infants]):
            pass
        return [samples[infant] for infant in infants]

    def _share(
        self, function: Callable[[int], None], groups: Sequence[Sequence[int]]
    ) -> Generator[Sequence[int], None, None]:
        """Call a function for some infants in all threads; yield each group of them as soon as all of it is done."""
        waiting = ((infant, group) for group, infants in enumerate(groups) for infant in infants)
        turn, done = Lock(), [SimpleQueue[int]() for _ in groups]

        def call_next() -> bool:
            """Do the next infant that no thread has taken yet; return whether there was one."""
            with turn:
                infant, group = next(waiting, (None, 0))
            if infant is not None:
                try:
                    function(infant)
                finally:  # Whoever waits for an infant that failed would wait forever.
                    done[group].put(infant)
            return infant is not None

        def call_all() -> None:
            while call_next():
                pass

        futures = self._help(call_all, min(self.threads, sum(map(len, groups))) - 1)
        try:
            for finished, infants in zip(done, groups, strict=True):
                while finished.qsize() < len(infants) and call_next():
                    pass
                for _ in infants:
                    finished.get()
                yield infants
        finally:  # Also if the caller fails meanwhile: nobody steps an infant behind its back.
            for future in futures:
                future.result()

    def array(self, field: str, infants: Sequence[int]) -> FloatArray:
        """Return a field of `MjData` whose size never changes, such as `qpos`, of k infants that are alike."""
        if field not in self._views:
            self._views[field] = [getattr(data, field) for data in self.datas]
        views = [self._views[field][infant] for infant in infants]
        return np.concatenate(views).reshape(len(views), *views[0].shape)

    def are_unstable(self) -> list[bool]:
        """Return of each infant whether its simulation has become unstable since its reset; see `is_unstable`."""
        counts = np.concatenate(self._warnings).reshape(len(self.datas), -1)
        return [any(warnings) for warnings in counts[:, BREAKDOWNS].tolist()]

    def replace(self, infant: int, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Put another model and state in place of an infant's, as when it has grown."""
        self.models[infant], self.datas[infant] = model, data
        self._warnings[infant] = data.warning.number
        for field, views in self._views.items():
            views[infant] = getattr(data, field)

    def close(self) -> None:
        """End the threads; closing twice is fine."""
        if self._pool:
            self._pool.shutdown()

    def _help(self, function: Callable[[], None], helpers: int) -> list[Future[None]]:
        """Call a function in other threads, too; a forked process gets threads of its own, as it has none at first."""
        if helpers > 0 and self._process != os.getpid():
            self._pool, self._process = ThreadPoolExecutor(self.threads - 1), os.getpid()
        return [self._pool.submit(function) for _ in range(helpers)] if self._pool else []

    def _step_one(self, infant: int, steps: int) -> None:
        """Make physics steps of one infant; where MuJoCo cannot, it has broken down."""
        data = self.datas[infant]
        try:
            mujoco.mj_step(self.models[infant], data, steps)
        except mujoco.FatalError:
            data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number += 1


def usable_threads() -> int:
    """Return how many threads this process may run at once: in a container, fewer than there are cores."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
