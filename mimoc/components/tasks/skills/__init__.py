"""Motor skills of infants, from rolling over to walking, as tasks with physical criteria.

All are judged by one term, from one description of each skill: the posture that counts, how long it is kept or how far
the infant gets in it, what is rewarded on the way, and when an episode ends early. Unless a spec says otherwise, an
infant that learns a skill has the nervous system of its age: delays, noise of its commands, and commands that change no
faster than limbs of infants do.
"""

from typing import Annotated, Any, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.entries import Amount, Body, Count, Label, Number
from mimoc.schema.kinds import TaskKind
from mimoc.schema.quantities import Real
from mimoc.schema.task import TaskEntry, TaskSpec

Measure = Literal[
    "upright", "prone", "supine", "turned", "head_height", "hip_height", "facing", "speed", "near", "in_posture", "kept"
]
"""What a skill is judged by. `upright`, `prone` and `supine` are the least of hip and chest, from -1 to 1, of their
long axes upwards and of their fronts downwards or upwards; `turned`, from 0 on the back to 1 on the belly, is in ratio
to the angle, a mean of both; heights are shares of those of the same child standing straight; `facing` is the cosine
of the angle between where it faces and faced at first; `speed` is along the way, in [m/s]; `near` is minus the distance
of an object to the fingers, in [m]; `in_posture` is 1 if the posture is the wanted one, and else 0; `kept` is the share
of the time for which it is to be kept."""


class BoundEntry(Model):
    """The least that a measure may be."""

    measure: Measure
    """The measure."""
    least: Number
    """The bound."""


class ShareEntry(Model):
    """A measure as a share, from 0 to 1, that rises or falls with it."""

    measure: Measure
    """The measure."""
    zero: Number
    """Value from which on the share is 0."""
    full: Number
    """Value from which on the share is 1."""


class RewardEntry(Model):
    """A term of the reward: a weight times the product of some shares."""

    name: Label
    """Its name."""
    weight: Number
    """Its weight."""
    shares: tuple[ShareEntry, ...]
    """Its shares."""


class SkillEntry(TaskEntry):
    """A motor skill: what counts as success, what is rewarded, and what ends an episode."""

    kind: Literal["roll", "sit_up", "sit", "crawl", "pull_to_stand", "stand", "cruise", "walk", "grasp"]
    """Name of the task."""
    hip: Body
    """The lowest part of the trunk; its place is that of the infant."""
    chest: Body
    """The uppermost part of the trunk."""
    head: Body
    """The head."""
    hand: Body | None = None
    """The hand that holds an object."""
    object: Body | None = None
    """The object to be held."""
    standing_head_m: Amount
    """Height of the head when the child stands straight."""
    standing_hip_m: Amount
    """Height of the hip when the child stands straight."""
    forward_axis: Literal[0, 2]
    """Axis of the hip that points ahead at first: x, out of the belly, or z, towards the head."""
    way: Literal["forward", "left"] = "forward"
    """Direction of the way, seen from where the infant faces at first."""
    posture: tuple[BoundEntry, ...]
    """What a posture must satisfy to count."""
    clear: tuple[Body, ...] = ()
    """Bodies that may not press on anything besides the infant in a posture that counts."""
    kept_s: Amount
    """How long such a posture must be kept at a stretch, in [s]."""
    way_m: Amount
    """How far the infant must get in such a posture, in [m]."""
    reward: tuple[RewardEntry, ...]
    """The terms of the reward."""
    fall: tuple[BoundEntry, ...] = ()
    """What ends the episode when it is no longer satisfied."""
    success_weight: Number = 1.0
    """Reward of each control step in the wanted posture, once it has been kept for long and far enough."""
    effort_weight: Number = 0.1
    """Cost of all actuators at full strength."""
    change_weight: Number = 0.05
    """Cost of commands that all go from one end of their range to the other in one control step."""
    start_rad_s: Amount = 0.3
    """Standard deviation of the speeds of joints at the start."""
    pushes: Count = 0
    """Number of pushes in an episode."""
    push_n: Amount = 0.0
    """Force of a push, in [N]."""
    push_s: Amount = 0.2
    """Duration of a push, in [s]."""
    helped: Body | None = None
    """What is pushed, or carried by a helper's hands; None if nothing is."""
    support_n: tuple[Amount, Amount] = (0.0, 0.0)
    """The least and most weight that a helper's hands carry, in [N]; it is drawn for each episode."""
    support_s: Amount = 1e6
    """For how long they do, in [s]."""


class SkillSpec(TaskSpec):
    """A motor skill."""

    support: Annotated[Real, Field(ge=0, le=1)] = 0.0
    """Largest share of the infant's weight that a helper's hands carry at its chest; the share is drawn for each
    episode, from 0 on. A curriculum: begin with 0.6, and go on with less."""


class RollSpec(SkillSpec):
    """Roll over, from the back to the belly or from the belly to the back."""

    kind: Literal["roll"]
    """Name of the task."""
    start: Literal["supine", "prone"] = "supine"
    """On the back, or on the belly."""


class SitUpSpec(SkillSpec):
    """Sit up from lying on the back or on the belly."""

    kind: Literal["sit_up"]
    """Name of the task."""
    start: Literal["supine", "prone"] = "supine"
    """On the back, or on the belly."""


class SitSpec(SkillSpec):
    """Keep sitting for 10 s while being pushed."""

    kind: Literal["sit"]
    """Name of the task."""
    pushes: Annotated[int, Field(ge=0, le=20)] = 3
    """Pushes in an episode: a twentieth of the infant's weight for 0.2 s at the chest, from any side."""


class CrawlSpec(SkillSpec):
    """Crawl half a metre."""

    kind: Literal["crawl"]
    """Name of the task."""
    style: Literal["belly", "hands_and_knees"] = "belly"
    """On the belly, or on hands and knees, where trunk, head and arms above the hands are clear of the floor."""


class PullToStandSpec(SkillSpec):
    """Pull oneself up to standing at a rail, which the hands hold."""

    kind: Literal["pull_to_stand"]
    """Name of the task."""


class StandSpec(SkillSpec):
    """Stand alone for 5 s."""

    kind: Literal["stand"]
    """Name of the task."""


class CruiseSpec(SkillSpec):
    """Walk sideways along a table, 30 cm, with the hands on it."""

    kind: Literal["cruise"]
    """Name of the task."""


class WalkSpec(SkillSpec):
    """Walk half a metre alone."""

    kind: Literal["walk"]
    """Name of the task."""


class GraspSpec(SkillSpec):
    """Hold an object for 3 s."""

    kind: Literal["grasp"]
    """Name of the task."""
    hand: Literal["left", "right"] | None = None
    """The hand that holds; by default, the right one."""
    object: Literal["rod", "cube"] = "rod"
    """What it holds."""


BANDWIDTH_HZ = 5.0
"""Cut-off of each of the two low-pass filters of commands. An assumption: half of the power of the speeds of infants'
hands and feet lies below 1.5 Hz, and films of them are commonly filtered at 6 Hz; so it leaves their movements as they
are, and takes a command that changes sign in each control step to 4 %."""
NERVOUS_SYSTEM = {
    ("actuation", "bandwidth_hz"): BANDWIDTH_HZ,
    ("delays", "preset"): "physiological",
    ("noise", "motor"): "maturing",
}
"""What an infant that learns a skill has unless its spec says otherwise."""
STEP_MS = 20.0


def _kind(spec: Any, scenes: tuple[str, ...] | None = None) -> TaskKind:
    """Return the record of a skill; *scenes* are those in which there is room for what stands in its world."""
    name = spec.model_fields["kind"].annotation.__args__[0]
    code = "mimoc.components.tasks.skills.build", "mimoc.components.tasks.skills.run"
    return TaskKind(name, spec, SkillEntry, *code, scenes, step_ms=STEP_MS, defaults=NERVOUS_SYSTEM)


ROLL, SIT_UP, SIT = map(_kind, (RollSpec, SitUpSpec, SitSpec))
CRAWL, STAND, WALK = map(_kind, (CrawlSpec, StandSpec, WalkSpec))
PULL_TO_STAND, CRUISE, GRASP = (_kind(spec, ("flat",)) for spec in (PullToStandSpec, CruiseSpec, GraspSpec))
