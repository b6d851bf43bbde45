"""The manifest: everything that the runtime knows about an infant, and its only interface with the compiler."""

from typing import Literal

from pydantic import Field

from mimoc.actuation.spec import ActuationEntry
from mimoc.delays.spec import DelaysEntry
from mimoc.noise.spec import NoiseEntry
from mimoc.plugins import load_plugins
from mimoc.schema.base import Model
from mimoc.schema.composition import composed
from mimoc.senses.spec import SensesEntry
from mimoc.tasks.base import TaskEntry
from mimoc.tasks.free.spec import FreeEntry
from mimoc.tasks.spec import task_entry_field

MANIFEST_VERSION = 2
"""Incremented when the meaning of a field changes; a new field with a default does not need a new version."""


class ChildEntry(Model):
    """The child's measurements, as built."""

    age_months: float
    """Age of the body."""
    sex: Literal["male", "female"] | None = None
    """Which of WHO's standards it is compared with; None is the mean of boys and girls."""
    length_cm: float
    """Length from crown to sole."""
    weight_kg: float
    """Mass of the whole body."""
    head_circumference_cm: float
    """Head circumference."""
    arm_circumference_cm: float | None
    """Upper-arm circumference, if there is an upper arm."""


class FaceEntry(Model):
    """The face and its expressions."""

    geom: str
    """The geom whose material is the expression."""
    materials: dict[str, str]
    """Material by expression."""
    skin: str | None = None
    """The skin of the head, if it has one, whose material is the expression then."""


class ToyEntry(Model):
    """A toy in the infant's scene."""

    body: str
    """Name of its body in the model."""
    joint: str
    """Its free joint."""
    object: str
    """Name of the object, such as `truck_003`."""
    category: str
    """Category of the object, such as `truck`."""
    source: str
    """Where its shape comes from."""
    size_m: float
    """Length of its longest side."""
    mass_kg: float
    """Its mass."""


class LockEntry(Model):
    """A hinge joint that is locked at its angle at reset."""

    equality: str
    """The equality constraint in the model."""
    joint: str
    """The hinge joint."""


class WeldEntry(Model):
    """A body that is welded to the world at its pose at reset."""

    equality: str
    """The equality constraint in the model."""
    body: str
    """The body."""


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
    """Joints and bodies that are held in place by equality constraints."""

    locks: tuple[LockEntry, ...] = ()
    """Locked joints."""
    welds: tuple[WeldEntry, ...] = ()
    """Welded bodies."""


@composed(lambda: {"task": task_entry_field()})
class Manifest(Model):
    """All that the compiler passes on to the runtime."""

    manifest: Literal[2] = MANIFEST_VERSION
    """Version of this file."""
    name: str
    """Name of the infant, from its spec."""
    child: ChildEntry
    """The child's measurements."""
    scene: str = "scene.xml"
    """Entry point of the model."""
    root_body: str
    """The root body of the infant, which has a free joint."""
    root_joint: str
    """That free joint."""
    timestep_ms: float
    """Duration of a physics step."""
    step_ms: float
    """Duration of a control step, a whole number of physics steps."""
    pose: str
    """Keyframe that an episode starts from by default."""
    poses: tuple[str, ...]
    """All keyframes."""
    actuation: ActuationEntry
    """Actuation model and actuators."""
    anatomy: AnatomyEntry = AnatomyEntry()
    """Which parts of the model are which parts of the body."""
    senses: SensesEntry
    """The senses."""
    delays: DelaysEntry = DelaysEntry()
    """Sensory and motor delays."""
    noise: NoiseEntry = NoiseEntry()
    """Noise of commands, senses and delays."""
    constraints: ConstraintsEntry = ConstraintsEntry()
    """Locked joints and welded bodies."""
    task: TaskEntry = FreeEntry()
    """The task."""
    plugins: dict[str, str] = Field(default_factory=dict)
    """Distribution of each kind that is not mimoc's own, by section and name, such as `senses.sound`."""
    face: FaceEntry | None = None
    """The face and its expressions."""
    seed: int = 0
    """Seed of the scene."""
    toys: tuple[ToyEntry, ...] = ()
    """The toys in the scene."""
    notes: tuple[str, ...] = ()
    """Notes on the build for its user."""
    keypoints: tuple[str, ...] = ()
    """The BODY_25 sites, in BODY_25's order, including those of removed limbs."""

    @property
    def has_skin(self) -> bool:
        """Whether a skin is drawn over the infant's solids."""
        return self.face is not None and self.face.skin is not None

    def __repr__(self) -> str:
        """Return name and age only: the whole manifest is long."""
        return f"Manifest({self.name!r}, {self.child.age_months:g} months)"

    __str__ = __repr__


load_plugins()
