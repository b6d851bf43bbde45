"""The manifest: all that the runtime knows about an infant, its only interface with the compiler; and reading it."""

import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, StringConstraints, ValidationError, model_validator

from mimoc.base.errors import BundleError
from mimoc.base.kinds import Registry
from mimoc.base.units import to_steps
from mimoc.bundle.regular_files import problems_in
from mimoc.schema.actuation import ActuationEntry
from mimoc.schema.base import Model, composed, omitting
from mimoc.schema.body import Clothes
from mimoc.schema.caregiver import CaregiverEntry
from mimoc.schema.entries import (
    Amount,
    Body,
    Camera,
    ControlStep,
    Duration,
    FreeJoint,
    Geom,
    Hinge,
    Keyframe,
    Label,
    LockName,
    Material,
    Skin,
    WeldName,
)
from mimoc.schema.kinds import ACTUATIONS, SENSES, TASKS
from mimoc.schema.objects import ObjectEntry
from mimoc.schema.plugins import load_plugins
from mimoc.schema.senses import DelayEntry, DelaysEntry, NoiseEntry, SensesEntry
from mimoc.schema.task import TaskEntry, no_task, task_entry_field

MANIFEST_VERSION = 2
"""Incremented when the meaning of a field changes; a new field with a default does not need a new version."""


class ChildEntry(Model):
    """The child's measurements, as built."""

    age_months: Annotated[Amount, Field(le=24)]
    """Age since birth."""
    months_early: Annotated[Amount, Field(le=12)] = 0.0
    """How long before term the child was born; 0 from term on."""
    sex: Literal["male", "female"] | None = None
    """Which of WHO's standards it is compared with; None is the mean of boys and girls."""
    clothes: Clothes = "shirt_and_trousers"
    """What its skin wears."""
    length_cm: Amount
    """Length from crown to sole."""
    weight_kg: Amount
    """Mass of the whole body."""
    head_circumference_cm: Amount
    """Head circumference."""
    arm_circumference_cm: Amount | None
    """Upper-arm circumference, if there is an upper arm."""
    size_is_known: bool = True
    """Whether the child's overall size is known; otherwise it is of the average child's size."""

    @property
    def corrected_age_months(self) -> float:
        """Age of what matures with it: that since term of a child that was born before."""
        return max(0.0, self.age_months - self.months_early)

    _serialized = omitting("months_early", "clothes", "size_is_known")


class FaceEntry(Model):
    """The face and its expressions."""

    geom: Geom
    """The geom whose material is the expression."""
    materials: dict[Label, Material]
    """Material by expression."""
    skin: Skin | None = None
    """The skin of the head, if it has one, whose material is the expression then."""
    begins: Label = "neutral"
    """The expression that the skin of the head is built with."""
    shapes: tuple[Label, ...] = ()
    """Expressions that move vertices of that skin; the arrays `face/moving` and `face/<expression>` say how."""

    _serialized = omitting("begins", "shapes")


class ToyEntry(Model):
    """A toy in the infant's scene."""

    body: Body
    """Name of its body in the model."""
    joint: FreeJoint
    """Its free joint."""
    object: Label
    """Name of the object, such as `truck_003`."""
    category: Label
    """Category of the object, such as `truck`."""
    source: Label
    """Where its shape comes from."""
    size_m: Amount
    """Length of its longest side."""
    mass_kg: Amount
    """Its mass."""


class LockEntry(Model):
    """A hinge joint that is locked at its angle at reset."""

    equality: LockName
    """The equality constraint in the model."""
    joint: Hinge
    """The hinge joint."""


class WeldEntry(Model):
    """A body that is welded to the world at its pose at reset."""

    equality: WeldName
    """The equality constraint in the model."""
    body: Body
    """The body."""


class LimbEntry(Model):
    """An arm or a leg, as far as the infant has it."""

    side: Literal["left", "right"]
    """Side of the body."""
    root: Body
    """Its first body, which hangs on the trunk."""
    end: Body | None
    """The hand or the foot; None if it is missing."""


class EyeEntry(Model):
    """An eye."""

    side: Literal["left", "right"]
    """Side of the body."""
    body: Body
    """Its body."""
    camera: Camera
    """Its camera."""


class AnatomyEntry(Model):
    """The parts of the body that the runtime and controllers use, by their names in the model.

    Parts that the infant does not have are left out.
    """

    head: Body | None = None
    """Body of the head."""
    trunk: tuple[Body, ...] = ()
    """Bodies that limbs hang on, from the first to the last, which the shoulders are on."""
    arms: tuple[LimbEntry, ...] = ()
    """The arms, the right one first."""
    legs: tuple[LimbEntry, ...] = ()
    """The legs, the right one first."""
    eyes: tuple[EyeEntry, ...] = ()
    """The eyes, the left one first."""
    groups: dict[Label, tuple[Hinge, ...]] = Field(default_factory=dict)
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
    name: Label
    """Name of the infant, from its spec."""
    child: ChildEntry
    """The child's measurements."""
    scene: Literal["scene.xml"] = "scene.xml"
    """Entry point of the model."""
    root_body: Body
    """The root body of the infant, which has a free joint."""
    root_joint: FreeJoint
    """That free joint."""
    timestep_ms: Annotated[Duration, Field(ge=0.1, le=20)]
    """Duration of a physics step."""
    step_ms: ControlStep
    """Duration of a control step, a whole number of physics steps."""
    pose: Keyframe
    """Keyframe that an episode starts from by default."""
    poses: tuple[Keyframe, ...]
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
    task: TaskEntry = no_task()
    """The task."""
    plugins: dict[Label, Label] = Field(default_factory=dict)
    """Distribution of each kind that is not mimoc's own, by section and name, such as `senses.sound`."""
    face: FaceEntry | None = None
    """The face and its expressions."""
    seed: Annotated[int, Field(ge=0, le=10**30)] = 0
    """Seed of the scene."""
    toys: tuple[ToyEntry, ...] = ()
    """The toys in the scene."""
    objects: tuple[ObjectEntry, ...] = ()
    """The objects of the spec's `scene.objects`, in their order."""
    caregiver: CaregiverEntry | None = None
    """An adult by the infant."""
    notes: tuple[str, ...] = ()
    """Notes on the build for its user."""
    keypoints: tuple[Label, ...] = ()
    """The BODY_25 sites, in BODY_25's order, including those of removed limbs."""
    prefix: Annotated[Label, StringConstraints(pattern="^([a-z][a-z0-9_]{0,20}_)?$")] = ""
    """What the names of all parts of the infant begin with in the model, if others share its world."""

    _serialized = omitting("objects", "prefix", "caregiver")

    def of_infant(self, name: str) -> str:
        """Return a name in the model as it is of an infant that is alone, such as `head` for `anna_head`."""
        return name.removeprefix(self.prefix)

    @property
    def commands(self) -> tuple[str, ...]:
        """The name of each number of the action, as it is of an infant that is alone."""
        return tuple(map(self.of_infant, self.actuation.commands))

    @model_validator(mode="after")
    def _all_times_are_whole_steps(self) -> Self:
        delays = {f"delays.{name}": delay for name, delay in self.delays if isinstance(delay, DelayEntry)}
        times_ms = {
            "step_ms": self.step_ms,
            "noise.delay_jitter_ms": self.noise.delay_jitter_ms,
            **{f"{name}.ms": delay.ms for name, delay in delays.items()},
            **{f"{name}.legs_ms": delay.legs_ms or 0.0 for name, delay in delays.items()},
            **{f"{name}.parts.{part.body}": part.ms for name, delay in delays.items() for part in delay.parts},
        }
        for name, time_ms in times_ms.items():
            try:
                if to_steps(time_ms, self.timestep_ms) < (name == "step_ms"):
                    raise ValueError(f"{time_ms:g} ms is less than a physics step of {self.timestep_ms:g} ms")
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        return self

    @model_validator(mode="after")
    def _each_command_has_its_noise(self) -> Self:
        commands = sum(actuator.commanded for actuator in self.actuation.actuators)
        if len(self.noise.of_commands) not in (0, commands):
            raise ValueError(f"noise.of_commands: {len(self.noise.of_commands)} numbers for {commands} commands")
        return self

    @model_validator(mode="after")
    def _default_pose_is_a_pose(self) -> Self:
        if self.pose not in self.poses:
            raise ValueError(f"pose: '{self.pose}' is none of the poses")
        return self

    @property
    def has_skin(self) -> bool:
        """Whether a skin is drawn over the infant's solids."""
        return self.face is not None and self.face.skin is not None

    def __repr__(self) -> str:
        """Return name and age only: the whole manifest is long."""
        return f"Manifest({self.name!r}, {self.child.age_months:g} months)"

    __str__ = __repr__


MANIFEST = "manifest.json"
MAX_MANIFEST_BYTES = 2**22  # 4 MB; a room with fifty toys and an infant with ten fingers have 56 kB.


def to_data(manifest: Manifest) -> dict[str, Any]:
    """Return what is written of a manifest: without senses of plug-ins, and recent ones, that the infant lacks."""
    data = manifest.model_dump()
    left_out = {name for name in SENSES if SENSES.distribution(name) != "mimoc" or SENSES[name].omit_if_absent}
    unused = {name for name in left_out if data["senses"][name] is None}
    for section in ("senses", "delays"):
        data[section] = {name: entry for name, entry in data[section].items() if name not in unused}
    return data


def read_manifest(content: bytes) -> Manifest:
    """Return the manifest in a file; BundleError if a plug-in is missing, or mimoc does not write such a one."""
    if len(content) > MAX_MANIFEST_BYTES:
        raise BundleError(f"{MANIFEST}: it has more than {MAX_MANIFEST_BYTES >> 20} MB, which no infant needs")
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        raise BundleError(f"{MANIFEST}: it is damaged; build it again") from None
    if isinstance(data, dict) and "world" in data:
        raise BundleError("this is a world with several infants, and one is wanted here; see docs/two_infants.md")
    check_plugins(data)
    if not isinstance(data, dict) or data.get("manifest", MANIFEST_VERSION) != MANIFEST_VERSION:
        advice = f"this version of mimoc reads manifests of version {MANIFEST_VERSION} only; build it again"
        raise BundleError(advice)
    try:
        return Manifest.model_validate_json(content)
    except ValidationError as error:
        raise BundleError(f"{MANIFEST}: {problems_in(error)}; build it again") from None


RUNNING: Mapping[str, Registry[Any]] = {"senses": SENSES, "tasks": TASKS, "actuation": ACTUATIONS}
"""The kinds of things that a bundle runs, by the section that a manifest names them in."""
BUILDING = ("scenes", "toys", "objects", "parts")  # Those that it is only built from.


def check_plugins(manifest: Any) -> None:
    """Raise a BundleError if a plug-in that a manifest names is missing, or another has a kind of that name."""
    plugins = manifest.get("plugins", {}) if isinstance(manifest, dict) else {}
    if not isinstance(plugins, dict):
        raise BundleError("its plug-ins are listed in a way that mimoc never writes; build it again")
    problems = [_problem(str(key), str(distribution)) for key, distribution in plugins.items()]
    if missing := [problem for problem in problems if problem]:
        raise BundleError("; ".join(missing))


def _problem(key: str, distribution: str) -> str | None:
    section, _, name = key.partition(".")
    if section in BUILDING:
        return None
    if section not in RUNNING or not name.isidentifier() or not distribution.isprintable():
        return f"its plug-in {key!r} is named in a way that mimoc never writes; build it again"
    table = RUNNING[section]
    source = f"the plug-in '{distribution}'" if distribution else "a script"
    if name not in table:
        advice = f"install '{distribution}'" if distribution else "register it with mimoc.register first"
        return f"this bundle needs the {table.what} '{name}' from {source}, which is not here; {advice}"
    current = table.distribution(name)
    if current != distribution:
        other = f"'{current}'" if current else "a script"
        return f"this bundle needs the {table.what} '{name}' from {source}, but here it comes from {other}"
    return None


load_plugins()
