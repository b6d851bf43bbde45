"""One attempt to learn a skill, and what came of it."""

from mimoc.base.errors import SpecError
from mimoc.policies.postures import Postures
from mimoc.schema.base import Model


class Attempt(Model):
    """One search at one age."""

    age_months: float
    """The infant's age."""
    seed: int
    """Seed of the search."""
    success: float
    """Share of starts in which it has the skill."""
    starts: int
    """Number of these starts."""
    tried: int = 0
    """Number of movements tried, or of control steps of a training."""
    curve: tuple[float, ...] = ()
    """Mean score of the best tries in each round, or the share of episodes with success in each row of a training."""
    movement: Postures | None = None
    """The movement that a search found; None if a policy was trained, or the infant cannot even begin."""
    policy: str = ""
    """Path of the policy that was trained on a device, from the folder of the results."""
    success_on_device: float | None = None
    """Share of the infants that had success there with the same policy, one episode each."""
    problem: str = ""
    """Why it cannot begin."""


def problem_of(error: SpecError) -> str:
    """Return why a task cannot begin, without the place in a spec."""
    return str(error).partition("task.kind: ")[2] or str(error)
