"""An environment whose infant grows with the number of its steps."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

import gymnasium
import numpy as np

from mimoc.base.classes import described
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import OLDEST_MONTHS
from mimoc.runtime.infant import AGE

Course = Literal["grown", "adult", "reversed", "shuffled"]
COURSES: Mapping[str, str] = MappingProxyType(
    {
        "grown": "from the youngest age to the oldest",
        "adult": "the oldest age throughout",
        "reversed": "from the oldest age to the youngest",
        "shuffled": "the same ages in random order",
    }
)  # Courses that growth can take.

STAGE_MONTHS = 0.25  # How much an infant grows at once; a quarter of a month moves nothing by more than a millimetre.


@dataclass(frozen=True, slots=True)
class GrowthSchedule:
    """Ages one after another, each for equally many control steps; the last one stays."""

    ages_months: tuple[float, ...]
    steps: int

    def __call__(self, steps_done: int) -> float:
        """Return the age, in months, after a number of control steps."""
        stage = steps_done * len(self.ages_months) // self.steps
        return self.ages_months[min(stage, len(self.ages_months) - 1)]


def growth_schedule(
    course: Course | str,
    ages_months: Sequence[float],
    steps: int,
    *,
    seed: int | np.random.Generator = 0,
    stage_months: float = STAGE_MONTHS,
) -> GrowthSchedule:
    """Return a schedule of growth: every course but `adult` has the same ages, each for equally long.

    Args:
        course: `grown`, `adult`, `reversed` or `shuffled`.
        ages_months: The youngest and the oldest age.
        steps: Control steps from the beginning of the first stage to the end of the last one.
        seed: Seed of the order of `shuffled`, or the generator that draws it.
        stage_months: How much the infant grows at once; the first stage is the youngest age, the last one the oldest.

    Raises:
        UnknownNameError: If there is no such course.
        MimocError: If the ages are not a range within 0 to 24 months, or a number is not positive.

    Example:
        >>> import mimoc
        >>> schedule = mimoc.growth_schedule("grown", ages_months=(6, 7), steps=100)
        >>> [schedule(step) for step in (0, 25, 99)]
        [6.0, 6.25, 7.0]
    """
    if course not in COURSES:
        raise UnknownNameError("schedule of growth", str(course), COURSES)
    stages = _stages(ages_months, stage_months)
    if steps < 1:
        raise MimocError(f"growth takes at least one control step, got {steps}")
    if course == "adult":
        stages = stages[-1:]
    elif course == "reversed":
        stages = stages[::-1]
    elif course == "shuffled":
        stages = np.random.default_rng(seed).permutation(stages).tolist()
    return GrowthSchedule(tuple(stages), steps)


def read_ages(text: str) -> tuple[float, float]:
    """Return the youngest and the oldest age, in months, that a text such as `6:12` gives."""
    try:
        youngest, oldest = (float(age) for age in text.split(":"))
        _stages((youngest, oldest), STAGE_MONTHS)
    except ValueError:
        raise MimocError(f"'{text}' is not a range of ages; write two ages in months, such as 6:12") from None
    return youngest, oldest


def _stages(ages_months: Sequence[float], stage_months: float) -> list[float]:
    if len(ages_months) != 2 or not 0 <= ages_months[0] < ages_months[1] <= OLDEST_MONTHS:
        given = ":".join(f"{age:g}" for age in ages_months)
        raise MimocError(
            f"'{given}' is not a range of ages from 0 to {OLDEST_MONTHS:g} months, the younger first, such as 6:12"
        )
    if not stage_months > 0:
        raise MimocError(f"an infant grows by a positive number of months at once, got {stage_months:g}")
    youngest, oldest = map(float, ages_months)
    count = max(1, round((oldest - youngest) / stage_months))
    return [float(f"{age:.9g}") for age in np.linspace(youngest, oldest, count + 1).tolist()]


class GrowthWrapper(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Lets an infant grow over its control steps, in the midst of episodes and across them.

    Spaces stay as they are, and `info["age_months"]` is the present age.

    Example:
        >>> import mimoc
        >>> env = mimoc.GrowthWrapper(mimoc.make("reach.yaml"), "grown", ages_months=(6, 12), steps=1000)
        >>> observation, info = env.reset(seed=0)
        >>> info["age_months"]
        6.0
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        schedule: str | Callable[[int], float] = "grown",
        *,
        ages_months: Sequence[float] = (0, OLDEST_MONTHS),
        steps: int = 100_000,
        seed: int | np.random.Generator = 0,
    ):
        """Wrap an environment.

        Args:
            env: The environment of an infant, as `mimoc.make` returns it.
            schedule: `grown`, `adult`, `reversed` or `shuffled`; or a function from the number of control steps taken
                so far to the age in months, such as `growth_schedule` returns.
            ages_months: The youngest and the oldest age, if the schedule is given by name.
            steps: The control steps that growth takes, if the schedule is given by name.
            seed: Seed of the order of `shuffled`, or the generator that draws it.

        Raises:
            UnknownNameError: If there is no such schedule.
            MimocError: If it is not the environment of an infant, or these are no ages or no number of steps.
        """
        if not isinstance(getattr(env, "unwrapped", None), InfantEnv):
            given = described(env)
            raise MimocError(
                f"GrowthWrapper: expected the environment of one infant, got {given}; make it with mimoc.make, or call"
                " grow_by of a world or of many infants on the CPU"
            )
        super().__init__(env)
        if not callable(schedule):
            schedule = growth_schedule(schedule, ages_months, steps, seed=seed)
        self._infant: Any = env.unwrapped
        self._schedule = schedule
        self.steps_done = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode at the age that is due, unless the option `age_months` gives another.

        Raises:
            MimocError: If there is no such infant.
        """
        due_months = self._schedule(self.steps_done)
        options = dict(options or {})
        if due_months != self._infant.age_months:
            options = {AGE: due_months, **options}
        return self.env.reset(seed=seed, options=options or None)

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Grow, if that is due, and take a control step.

        Raises:
            MimocError: If there is no such infant.
        """
        due_months = self._schedule(self.steps_done)
        if due_months != self._infant.age_months:
            self._infant.grow(to=due_months)
        stepped = self.env.step(action)
        self.steps_done += 1
        return stepped

    def seek(self, steps_done: int) -> None:
        """Set the number of control steps by which the infant grows, for a resumed training; a reset must follow."""
        self.steps_done = steps_done
