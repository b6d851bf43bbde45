"""One run of a fit: its progress, the time it takes without compiling, and its end by Ctrl-C."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from mimoc.movement.retargeting.banded import BoolArray
from mimoc.movement.retargeting.fitting import Problem, State, solve
from mimoc.movement.retargeting.observations import OUTLIER

INTERRUPTED = "stopped before the end, by Ctrl-C: the motion is the best so far"
_T = TypeVar("_T")


@dataclass
class Run:
    """A fit in progress."""

    progress: Callable[[int, int], None] | None
    """Called with the number of steps done, and of all."""
    total: int
    done: int = 0
    begin_s: float = field(default_factory=time.process_time)
    compiling_s: float = 0.0
    notes: list[str] = field(default_factory=list)

    @property
    def interrupted(self) -> bool:
        """Whether it was told to end."""
        return bool(self.notes)

    @property
    def seconds(self) -> float:
        """Processor time so far, without that of compiling."""
        return time.process_time() - self.begin_s - self.compiling_s

    def tick(self) -> None:
        """Count a step."""
        self.done += 1
        if self.progress:
            self.progress(min(self.done, self.total), self.total)

    def compiled(self, make: Callable[[], _T]) -> _T:
        """Return what is made; its time does not count. Ctrl-C lets it finish."""
        begin = time.process_time()
        result = self.finished(make)
        self.compiling_s += time.process_time() - begin
        return result

    def finished(self, make: Callable[[], _T]) -> _T:
        """Return what the end of a fit needs; Ctrl-C makes it begin again, once."""
        try:
            return make()
        except KeyboardInterrupt:
            if self.interrupted:
                raise
            self.notes.append(INTERRUPTED)
            return make()

    def improved(self, before: _T, make: Callable[[], _T]) -> _T:
        """Return what is made, or what was before if the run was or is interrupted."""
        if self.interrupted:
            return before
        try:
            return make()
        except KeyboardInterrupt:
            self.notes.append(INTERRUPTED)
            return before

    def solve(
        self,
        problem: Problem,
        state: State,
        steps: int,
        free: BoolArray,
        outliers: tuple[float, float] = (OUTLIER, OUTLIER),
    ) -> State:
        """Return the best state after at most so many steps; *outliers* are distances, first and last."""
        states, end = [state], self.done + steps
        if not self.interrupted:
            try:
                first, last = outliers
                solved = solve(
                    problem,
                    state,
                    steps,
                    free=free,
                    first_outlier=first,
                    last_outlier=last,
                    tick=self.tick,
                    keep=states.append,
                )
                states.append(solved)
            except KeyboardInterrupt:
                self.notes.append(INTERRUPTED)
        if self.done < end:
            self.done = end - 1
            self.tick()
        return states[-1]
