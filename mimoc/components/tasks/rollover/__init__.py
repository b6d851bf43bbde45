"""Turn over, from the back to the belly or the other way."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from mimoc.schema.entries import Body, Number
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import TaskEntry, TaskSpec

if TYPE_CHECKING:
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.task_setup import TaskSetup

STEPS = 500  # Length of an episode in steps (MIMo).


class RolloverSpec(TaskSpec):
    """Roll over, from the back to the belly or the other way."""

    kind: Literal["rollover"]
    """Name of the task."""
    reward: Literal["dense", "shaped"] | None = None
    """Reward at every step for how far the infant has turned (`dense`, the default), or reward for success with
    potential-based shaping by how far it has turned (`shaped`)."""


class RolloverEntry(TaskEntry):
    """Roll over, from the back to the belly or the other way."""

    kind: Literal["rollover"] = "rollover"
    """Name of the task."""
    settle_steps: Annotated[int, Field(ge=0, le=10_000)] = 100
    """Control steps at rest before an episode begins; 1 s (MIMo)."""
    hip: Body
    """The body whose rotation counts; its x axis points out of the belly."""
    goal: Number = 0.8
    """Progress that counts as success: 0 is flat on the side that it starts on, 1 is flat on the other (MIMo)."""
    reward: Literal["dense", "shaped"]
    """Reward for how far it has turned (`dense`), or for success with potential-based shaping (`shaped`)."""
    effort_weight: Number = 0.01
    """Weight of the sum of squared actions, as a cost in the dense reward (MIMo)."""
    success_reward: Number = 10.0
    """Reward for success in the shaped reward."""
    discount: Number = 0.99
    """Discount factor of the shaping potential; it must equal the learner's, or shaping changes the optimal policy."""


def build(task: RolloverSpec, tree: "BodyTree") -> "TaskSetup":
    """Return the setup of `rollover`, which any infant can play: it lies as its scene says."""
    from mimoc.compiler.task_setup import TaskSetup

    return TaskSetup(RolloverEntry(steps=task.steps or STEPS, hip=tree.bodies[0].name, reward=task.reward or "dense"))


KIND = TaskKind(
    name="rollover",
    spec=RolloverSpec,
    entry=RolloverEntry,
    build=build,
    run="mimoc.components.tasks.rollover.run",
    scenes=("flat", "crib", "room"),
    poses=("supine", "prone"),
)
