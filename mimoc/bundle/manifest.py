"""The manifest: everything that the runtime knows about an infant, and its only interface with the compiler."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.senses.spec import FoveationRadius, TouchQuantity, TouchResponse
from mimoc.tasks.entries import FreeEntry, GoalEntry

MANIFEST_VERSION = 1
"""Incremented when the meaning of a field changes; a new field with a default does not need a new version."""


class ActuatorEntry(Model):
    """One actuator of the model, and its component of the action."""

    name: str
    """Name in the model."""
    mimo_actuator: str
    """MIMo's actuator that it corresponds to, alone or together with others."""
    joint: str
    """The hinge joint that it drives."""
    action_low: float
    """Lower bound of its command."""
    action_high: float
    """Upper bound of its command."""
    commanded: bool = True
    """Whether the action has a component for it; otherwise it stays at rest."""


class ActuationEntry(Model):
    """The infant's actuation."""

    model: Literal["torque", "muscle", "position"] = "torque"
    """Actuation model."""
    actuators: tuple[ActuatorEntry, ...]
    """All actuators in the model's order; the commanded ones make up the action, in the same order."""


class ProprioceptionEntry(Model):
    """Proprioception: joint positions and, if included, velocities, torques, limits and actuation."""

    kind: Literal["proprioception"] = "proprioception"
    """Which sense this is."""
    include: tuple[Literal["velocity", "torque", "limits", "actuation"], ...]
    """What is observed besides joint angles, in this order."""
    joints: tuple[str, ...]
    """Hinge joints, in the order of the observation."""
    torque_sensors: tuple[str, ...]
    """Three-axis torque sensors, in the order of the observation."""


class VestibularEntry(Model):
    """The sense of balance."""

    kind: Literal["vestibular"] = "vestibular"
    """Which sense this is."""
    accelerometer: str | None = None
    """Sensor of the head's specific force, m/s², if observed."""
    gyro: str | None = None
    """Sensor of the head's angular velocity, rad/s, if observed."""


class TouchEntry(Model):
    """The sense of touch."""

    kind: Literal["touch"] = "touch"
    """Which sense this is."""
    quantity: TouchQuantity
    """What each skin point observes: force in the frame of its body or of the world, or normal force only."""
    response: TouchResponse
    """Whether a contact is spread over the skin points around it or assigned to the nearest one."""
    points_m: Annotated[dict[str, tuple[tuple[float, float, float], ...]], Field(repr=False)]
    """Skin points by body, in the body's frame; observed in this order, bodies in the model's order."""
    spacing_m: dict[str, float]
    """Distance between neighbouring skin points by body; a contact reaches points within twice this distance."""


class VisionEntry(Model):
    """The sense of sight."""

    kind: Literal["vision"] = "vision"
    """Which sense this is."""
    cameras: tuple[str, ...]
    """One camera for each eye; images are observed under these names."""
    width_px: int
    """Width of an image."""
    height_px: int
    """Height of an image."""
    supersample: int
    """Factor by which images are rendered larger before they are averaged down."""
    acuity_cpd: float | None
    """Spatial frequency of the finest grating seen, in cycles per degree; None without blur."""
    foveation: float
    """Strength s of the foveation; 0 is none."""
    foveation_radius: FoveationRadius
    """How far the radius R of the foveation reaches in the image."""
    unseen: tuple[str, ...]
    """Bodies that the eyes do not see: the infant's own head."""


class DelayEntry(Model):
    """Delay of one channel; a whole number of physics steps."""

    ms: float = 0.0
    """Delay."""
    legs_ms: float | None = None
    """Delay to or from legs and feet, if it differs."""


class DelaysEntry(Model):
    """Sensory and motor delays."""

    proprioception: DelayEntry = DelayEntry()
    """From joints and muscles."""
    vestibular: DelayEntry = DelayEntry()
    """From the inner ear."""
    touch: DelayEntry = DelayEntry()
    """From the skin."""
    vision: DelayEntry = DelayEntry()
    """From the eyes."""
    motor: DelayEntry = DelayEntry()
    """From command to actuator."""
    legs: tuple[str, ...] = ()
    """Root bodies of the legs."""


class SensesEntry(Model):
    """The infant's senses; a sense that is None is off."""

    proprioception: ProprioceptionEntry | None = None
    """Proprioception."""
    vestibular: VestibularEntry | None = None
    """Balance."""
    touch: TouchEntry | None = None
    """Touch."""
    vision: VisionEntry | None = None
    """Sight."""


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


class FasteningsEntry(Model):
    """Joints and bodies that are held in place by equality constraints."""

    locks: tuple[LockEntry, ...] = ()
    """Locked joints."""
    welds: tuple[WeldEntry, ...] = ()
    """Welded bodies."""


class Manifest(Model):
    """All that the compiler passes on to the runtime."""

    manifest: Literal[1] = MANIFEST_VERSION
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
    senses: SensesEntry
    """The senses."""
    delays: DelaysEntry = DelaysEntry()
    """Sensory and motor delays."""
    fastenings: FasteningsEntry = FasteningsEntry()
    """Locked joints and welded bodies."""
    task: GoalEntry = FreeEntry()
    """The task."""
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

    def __repr__(self) -> str:
        """Return name and age only: the whole manifest is long."""
        return f"Manifest({self.name!r}, {self.child.age_months:g} months)"

    __str__ = __repr__
