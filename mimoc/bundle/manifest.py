"""All that the runtime knows of an infant: the contract between the wing that compiles and the wing that runs."""

from typing import Literal

from pydantic import Field

from mimoc.actuation.spec import ActuationEntry
from mimoc.delays.spec import DelaysEntry
from mimoc.plugins import load_plugins
from mimoc.schema.base import Model
from mimoc.schema.composition import composed
from mimoc.senses.spec import SensesEntry
from mimoc.tasks.base import TaskEntry
from mimoc.tasks.free.spec import FreeEntry
from mimoc.tasks.spec import task_entry_field

MANIFEST_VERSION = 1
"""Raised when the meaning of a field changes; a new field with a default does not raise it."""


class ChildEntry(Model):
    """What the child measures, as its model was built."""

    age_months: float
    """Age of the body."""
    sex: Literal["male", "female"] | None = None
    """Which of WHO's children it stands among; None is the mean of boys and girls."""
    length_cm: float
    """Crown to sole."""
    weight_kg: float
    """Mass of the whole body."""
    head_circumference_cm: float
    """Around the head."""
    arm_circumference_cm: float | None
    """Around the upper arm, if there is one."""


class FaceEntry(Model):
    """What the face can show."""

    geom: str
    """The geom that shows it."""
    materials: dict[str, str]
    """Material by expression."""


class ToyEntry(Model):
    """A toy in the infant's world."""

    body: str
    """Name of its body in the model."""
    joint: str
    """Its free joint."""
    object: str
    """What it is, such as `truck_003`."""
    category: str
    """Of which kind, such as `truck`."""
    source: str
    """Where its shape comes from."""
    size_m: float
    """Its longest side."""
    mass_kg: float
    """What it weighs."""


class LockEntry(Model):
    """A hinge that is kept at the angle that a reset gives it."""

    equality: str
    """The constraint in the model."""
    joint: str
    """The hinge."""


class WeldEntry(Model):
    """A part of the infant that is kept where a reset puts it."""

    equality: str
    """The constraint in the model."""
    body: str
    """The part."""


class LimbEntry(Model):
    """An arm or a leg, as far as the infant has it."""

    side: Literal["left", "right"]
    """Side of the body."""
    root: str
    """Its first body, which hangs on the trunk."""
    end: str | None
    """The hand or the foot; None if it is missing."""


class EyeEntry(Model):
    """An eye."""

    side: Literal["left", "right"]
    """Side of the body."""
    body: str
    """Its body."""
    camera: str
    """Its camera."""


class AnatomyEntry(Model):
    """The parts of the body that the runtime and controllers use, by their names in the model.

    Parts that the infant does not have are left out.
    """

    head: str | None = None
    """Body of the head."""
    trunk: tuple[str, ...] = ()
    """Bodies that limbs hang on, from the first to the last, which the shoulders are on."""
    arms: tuple[LimbEntry, ...] = ()
    """The arms, the right one first."""
    legs: tuple[LimbEntry, ...] = ()
    """The legs, the right one first."""
    eyes: tuple[EyeEntry, ...] = ()
    """The eyes, the left one first."""
    groups: dict[str, tuple[str, ...]] = Field(default_factory=dict)
    """The hinges that each group of muscles moves, such as those of `left_arm`."""


class ConstraintsEntry(Model):
    """What of the infant stays where a reset puts it."""

    locks: tuple[LockEntry, ...] = ()
    """Locked joints."""
    welds: tuple[WeldEntry, ...] = ()
    """Held parts."""


@composed(lambda: {"task": task_entry_field()})
class Manifest(Model):
    """What travels from the compiler to the runtime."""

    manifest: Literal[1] = MANIFEST_VERSION
    """Version of this file."""
    name: str
    """Name of the infant spec."""
    child: ChildEntry
    """What the child measures."""
    scene: str = "scene.xml"
    """Entry point of the model."""
    root_body: str
    """The body that moves freely."""
    root_joint: str
    """Its free joint."""
    timestep_ms: float
    """One physics step."""
    step_ms: float
    """One control step, a whole number of physics steps."""
    pose: str
    """The keyframe a reset starts from."""
    poses: tuple[str, ...]
    """Every keyframe."""
    actuation: ActuationEntry
    """How it is moved."""
    anatomy: AnatomyEntry = AnatomyEntry()
    """Which parts of the model are which parts of the body."""
    senses: SensesEntry
    """What it senses."""
    delays: DelaysEntry = DelaysEntry()
    """How late it senses and moves."""
    constraints: ConstraintsEntry = ConstraintsEntry()
    """What is locked or held where it starts."""
    task: TaskEntry = FreeEntry()
    """What it is to achieve."""
    plugins: dict[str, str] = Field(default_factory=dict)
    """Distribution of each kind that is not mimoc's own, by section and name, such as `senses.sound`."""
    face: FaceEntry | None = None
    """What its face can show."""
    seed: int = 0
    """Of its scene."""
    toys: tuple[ToyEntry, ...] = ()
    """What there is to play with."""
    notes: tuple[str, ...] = ()
    """What its user should know of how it was built."""
    keypoints: tuple[str, ...] = ()
    """The BODY_25 sites, in BODY_25's order; of limbs it does not have too."""

    def __repr__(self) -> str:
        """Return who it tells of: the whole of it is long."""
        return f"Manifest({self.name!r}, {self.child.age_months:g} months)"

    __str__ = __repr__


load_plugins()
