"""Trainings that go on side by side, step by step.

A training is a coroutine. Where its infants live on a device, it waits for each of their control steps, which all
infants there make at once, those of other trainings too. Each training has its own random numbers of torch, so that
side by side it learns what it would alone.
"""

from collections.abc import Coroutine, Generator, Sequence
from contextlib import suppress
from typing import Any, Protocol, TypeVar

import torch

Result = TypeVar("Result")


class Wanted(Protocol):
    """A control step of some infants that a training waits for."""

    def __await__(self) -> Generator["Wanted", Any, Any]: ...

    def step_with(self, others: Sequence[Any]) -> Any:
        """Make it together with those that other trainings wait for."""


class _Course:
    """A training that goes on whenever its infants have made a step, with random numbers of torch of its own."""

    def __init__(self, coroutine: Coroutine[Wanted, Any, Any]):
        self._coroutine: Any = coroutine
        self._random = _random_states()
        self.wants: Wanted
        self.result: Any = None

    def go_on(self, outcome: Any) -> bool:
        """Go on with the outcome of a step, None at first; return whether it waits for another one."""
        on_cpu, on_gpus = self._random
        torch.set_rng_state(on_cpu)
        if on_gpus:
            torch.cuda.set_rng_state_all(on_gpus)
        try:
            self.wants = self._coroutine.send(outcome)
        except StopIteration as ended:
            self.result = ended.value
            return False
        finally:
            self._random = _random_states()
        return True

    def stop(self, error: BaseException) -> None:
        """End it with an error that came up elsewhere, so that it keeps what it has learnt."""
        if self._coroutine.cr_frame is not None:  # It has not ended yet.
            with suppress(type(error)):
                self._coroutine.throw(error)


def run_together(courses: Sequence[Coroutine[Wanted, Any, Result]]) -> list[Result]:
    """Let trainings, whose infants share a device, go on until all have ended; return what came of each.

    An error or Ctrl-C in one of them ends all, after each has kept what it has learnt.
    """
    learning = [_Course(coroutine) for coroutine in courses]
    going_on, outcome = learning, None
    try:
        while going_on := [course for course in going_on if course.go_on(outcome)]:
            first, *others = (course.wants for course in going_on)
            outcome = first.step_with(others)
    except BaseException as error:
        for course in learning:
            course.stop(error)
        raise
    return [course.result for course in learning]


def _random_states() -> tuple[torch.Tensor, Sequence[torch.Tensor]]:
    return torch.get_rng_state(), torch.cuda.get_rng_state_all() if torch.cuda.is_initialized() else ()
