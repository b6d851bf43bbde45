"""A trial of movement: what is done with an infant, and what is measured of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from mimoc.base.quantities import Quantity
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions, TrialInfant, compile_at, slackened
from mimoc.studies.movement.drive import slack

Values = Mapping[str, float | None]
"""What was measured, by the name of the measure; None if it did not happen, as a kick that never gets far enough."""


@dataclass(frozen=True)
class Subject:
    """An infant of some age, and the spec that it was compiled from."""

    infant: TrialInfant
    spec: InfantSpec  # At its age, for trials that add something to its world.

    @property
    def slack(self) -> TrialInfant:
        """The infant without any activity, muscle tone included: its joints have their passive properties alone."""
        return slack(compile_at(slackened(self.spec), self.spec.age_months, Conditions()))


@dataclass(frozen=True)
class MovementTrial:
    """Something that is done with an infant, as an experiment in physics."""

    name: str
    title: str
    measure: Callable[[Subject], Values] = field(repr=False)
    ages_months: Sequence[float]  # The ages at which it is done unless others are asked for.
    measures: tuple[Quantity, ...]  # What it gives, in the order in which tables show it.
    needs: tuple[str, ...] = ()  # The bodies without which it cannot be tried.
    needs_one_of: tuple[str, ...] = ()
    """Bodies of which one is needed, as hands of different kinds have different fingers; none if there are none."""
    held_out: bool = False
    """Whether nothing of the law `maturing` was chosen with it in view, so that what it gives are predictions."""
    on_request: bool = False  # Whether it takes minutes, so that it is done only if it is asked for by its name.
    side: str = ""  # The side whose limb is measured, `left` or `right`; none if it is about both.


def missing(trial: MovementTrial, infant: TrialInfant) -> str:
    """Return in words what an infant lacks for a trial; nothing if it lacks nothing."""
    lacking = [body for body in trial.needs if not infant.has(body)]
    if trial.needs_one_of and not any(map(infant.has, trial.needs_one_of)):
        lacking.append(" nor ".join(trial.needs_one_of))
    return f"this infant has no {' and no '.join(lacking)}" if lacking else ""
