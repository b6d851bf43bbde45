"""All that the runtime knows of an infant: the contract between the wing that compiles and the wing that runs."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.senses.spec import FoveationRadius, TouchQuantity, TouchResponse
from mimoc.tasks.entries import FreeEntry, GoalEntry

MANIFEST_VERSION = 1
"""Raised when the meaning of a field changes; a new field with a default does not raise it."""


class ActuatorEntry(Model):
    """One actuator of the model, as the action sees it."""

    name: str
    """Name in the model."""
    mimo_actuator: str
    """The actuator of MIMo that it stands for, alone or with others."""
    joint: str
    """The hinge it moves."""
    action_low: float
    """Least command."""
    action_high: float
    """Largest command."""
    commanded: bool = True
    """Whether the action has a command for it; else it rests."""


class ActuationEntry(Model):
    """How the infant is moved."""

    model: Literal["torque", "muscle", "position"] = "torque"
    """Actuation model."""
    actuators: tuple[ActuatorEntry, ...]
    """In the order of the model; of those that are commanded, of the action."""


class ProprioceptionEntry(Model):
    """The sense of where one's limbs are and what they do."""

    kind: Literal["proprioception"] = "proprioception"
    """Which sense this is."""
    include: tuple[Literal["velocity", "torque", "limits", "actuation"], ...]
    """What is felt besides joint angles, in this order."""
    joints: tuple[str, ...]
    """Hinges, in the order of the observation."""
    torque_sensors: tuple[str, ...]
    """Three-axis torque sensors, in the order of the observation."""


class VestibularEntry(Model):
    """The sense of balance."""

    kind: Literal["vestibular"] = "vestibular"
    """Which sense this is."""
    accelerometer: str | None = None
    """Sensor of the head's specific force, m/s², if that is felt."""
    gyro: str | None = None
    """Sensor of the head's angular velocity, rad/s, if that is felt."""


class TouchEntry(Model):
    """The sense of touch."""

    kind: Literal["touch"] = "touch"
    """Which sense this is."""
    quantity: TouchQuantity
    """What each skin point feels: a force in its body's frame, in the world's, or only how hard it is pressed."""
    response: TouchResponse
    """Whether the skin points around a contact feel it, or only the nearest."""
    points_m: Annotated[dict[str, tuple[tuple[float, float, float], ...]], Field(repr=False)]
    """The skin points by body, in its frame; the observation has them in this order, bodies in that of the model."""
    spacing_m: dict[str, float]
    """Distance of neighbouring skin points by body; a contact is felt within twice that."""


class VisionEntry(Model):
    """The sense of sight."""

    kind: Literal["vision"] = "vision"
    """Which sense this is."""
    cameras: tuple[str, ...]
    """One for each eye; the pictures are observed under these names."""
    width_px: int
    """Width of a picture."""
    height_px: int
    """Height of a picture."""
    supersample: int
    """How many times larger it is drawn before it is averaged down."""
    acuity_cpd: float | None
    """Cycles per degree of the finest grating seen; None where nothing is blurred."""
    foveation: float
    """Strength s of the foveation; 0 is none."""
    foveation_radius: FoveationRadius
    """What its R reaches to."""
    unseen: tuple[str, ...]
    """Bodies that the eyes do not see: the infant's own head."""


class DelayEntry(Model):
    """How late one kind of signal is; a whole number of physics steps."""

    ms: float = 0.0
    """Delay."""
    legs_ms: float | None = None
    """Delay to or from legs and feet, where it is another."""


class DelaysEntry(Model):
    """How late signals are."""

    proprioception: DelayEntry = DelayEntry()
    """From joints and muscles."""
    vestibular: DelayEntry = DelayEntry()
    """From the inner ear."""
    touch: DelayEntry = DelayEntry()
    """From the skin."""
    vision: DelayEntry = DelayEntry()
    """From the eyes."""
    motor: DelayEntry = DelayEntry()
    """From command to muscle."""
    legs: tuple[str, ...] = ()
    """Bodies that the legs begin with."""


class SensesEntry(Model):
    """The senses of the infant; one that is None is off."""

    proprioception: ProprioceptionEntry | None = None
    """Joint angles and what else is felt of them."""
    vestibular: VestibularEntry | None = None
    """Balance."""
    touch: TouchEntry | None = None
    """Touch."""
    vision: VisionEntry | None = None
    """Sight."""


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


class FasteningsEntry(Model):
    """What of the infant is kept as it starts."""

    locks: tuple[LockEntry, ...] = ()
    """Joints."""
    welds: tuple[WeldEntry, ...] = ()
    """Parts."""


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
    senses: SensesEntry
    """What it senses."""
    delays: DelaysEntry = DelaysEntry()
    """How late it senses and moves."""
    fastenings: FasteningsEntry = FasteningsEntry()
    """What is kept as it starts."""
    task: GoalEntry = FreeEntry()
    """What it is to achieve."""
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
