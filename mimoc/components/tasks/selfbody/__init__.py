"""Touch the part of the own body that the observation names."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.entries import Body, Label, Number
from mimoc.schema.kinds import TaskKind
from mimoc.schema.names import SIDES
from mimoc.schema.task import TaskEntry, TaskSpec

if TYPE_CHECKING:
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.task_setup import Side, TaskSetup


class SelfbodySpec(TaskSpec):
    """Touch the part of its own body that the observation `goal` names."""

    kind: Literal["selfbody"]
    """Name of the task."""
    hand: Literal["left", "right"] | None = None
    """The hand that touches; by default, the right one."""


class TargetEntry(Model):
    """A part of the body that can be the goal of an episode."""

    name: Label
    """Name of the part."""
    bodies: tuple[Body, ...]
    """Bodies that belong to it."""


class SelfbodyEntry(TaskEntry):
    """Touch the part of its own body that the observation `goal` names."""

    kind: Literal["selfbody"] = "selfbody"
    """Name of the task."""
    fingers: Body
    """The body whose distance to the target is rewarded."""
    effectors: tuple[Body, ...]
    """The bodies whose contact with the target counts."""
    targets: Annotated[tuple[TargetEntry, ...], Field(min_length=1)]
    """The targets, one of which is drawn for each episode; the observation `goal` has an entry for each."""
    success_reward: Number = 500.0
    """Reward for touching the target (MIMo)."""
    idle_reward: Number = -1.0
    """Reward of a step in which nothing is touched (MIMo)."""


STEPS = 500  # Length of an episode in steps (MIMo).
OTHER: "dict[Side, Side]" = {"right": "left", "left": "right"}
SITTING: Mapping[str, float] = {
    "{side}_hip1": -115,
    "{side}_hip2": -40,
    "{side}_hip3": 35,
    "{side}_knee": -90,
    "hip_bend1": 25,
    "hip_bend2": 25,
}
"""On the floor with the feet before the hip, bent forward: as far as newborns sit so and do not tip over."""
AWAY: "Mapping[Side, Mapping[str, float]]" = {
    "right": {"hip_rot1": 15, "hip_rot2": 15},
    "left": {"hip_rot1": -15, "hip_rot2": -15},
}
"""The trunk turned away from a hand, which gets to the other leg so, past a trunk as deep as infants' are."""
TOUCHING: Mapping[str, float] = {"shoulder_ad_ab": 40, "elbow": -45, "fingers": -20}
"""The arm that touches, in the air beside the body at first: where it would rest, it would touch a leg."""
TOUCHED: Mapping[str, float] = {"shoulder_horizontal": 45, "shoulder_ad_ab": 70, "elbow": -85, "fingers": -40}
"""The other arm, above the lap."""
TRUNK = {"head": ("head", "left_eye", "right_eye"), "upper_body": ("upper_body", "chest"), "hip": ("hip",)}
"""Parts of head and trunk, by name in the goal; the lower body collides with nothing, so it cannot be touched."""


def build(task: SelfbodySpec, tree: "BodyTree") -> "TaskSetup":
    """Return the setup of `selfbody`.

    Raises:
        UnsupportedTaskError: If the infant has no such hand.
    """
    from mimoc.body.poses import Pose, resting_state
    from mimoc.compiler.task_setup import bodies_of, middle_finger, one_armed, require

    side: Side = task.hand or "right"
    fingers = middle_finger(tree, side)
    require(tree, task.kind, fingers)
    entry = SelfbodyEntry(
        steps=task.steps or STEPS,
        fingers=fingers,
        effectors=bodies_of(tree, f"{side}_hand"),
        targets=tuple(_targets(tree, OTHER[side])),
    )
    # How an infant sits that touches itself with a hand.
    arms = {f"{side}_{name}": angle for name, angle in TOUCHING.items()}
    arms |= {f"{OTHER[side]}_{name}": angle for name, angle in TOUCHED.items()}
    return one_armed(tree, side, entry, resting_state(tree, Pose(0, {**SITTING, **AWAY[side], **arms}, relaxed=False)))


def _targets(tree: "BodyTree", other: "Side") -> Iterator[TargetEntry]:
    """Yield what can be touched: head, trunk, both legs and the other arm, as far as they are there."""
    from mimoc.compiler.task_setup import bodies_of

    legs = {f"{side}_{part}": _leg(tree, side, part) for part in ("upper_leg", "lower_leg", "foot") for side in SIDES}
    arm = {f"{other}_{part}": (f"{other}_{part}",) for part in ("upper_arm", "lower_arm")}
    names = {body.name for body in tree.bodies}
    for name, bodies in {**TRUNK, **legs, **arm, f"{other}_hand": bodies_of(tree, f"{other}_hand")}.items():
        present = tuple(body for body in bodies if body in names)
        if present:
            yield TargetEntry(name=name, bodies=present)


def _leg(tree: "BodyTree", side: str, part: str) -> tuple[str, ...]:
    """Return the bodies of a part of a leg; a foot has its toes."""
    name = f"{side}_{part}"
    toes = (body.name for body in tree.bodies if body.parent == name) if part == "foot" else ()
    return (name, *toes)


KIND = TaskKind("selfbody", SelfbodySpec, SelfbodyEntry, build, "mimoc.components.tasks.selfbody.run", step_ms=5.0)
