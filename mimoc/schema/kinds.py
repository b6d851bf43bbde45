"""Components of each kind by name: what mimoc must know of each, those that come with it, and those of plug-ins.

A component's record names its code by module, so that each command imports only what it needs: the spec language is
known without the compiler, and a bundle is opened without it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from mimoc.base.errors import KindError
from mimoc.base.kinds import Code, Component, Registry

if TYPE_CHECKING:  # The names of kinds are known before pydantic is.
    from mimoc.schema.base import Model


AGES_MONTHS = (0.0, 1.0, 3.0, 6.0, 12.0, 24.0)  # The ages at which conduction times are given.


@dataclass(frozen=True, slots=True)
class AgeTable:
    """Delays by age, interpolated linearly."""

    ages_months: tuple[float, ...]
    ms: tuple[float, ...]
    """To or from all of the body but the legs."""
    legs_ms: tuple[float, ...] | None = None
    """To or from legs and feet, where that differs."""


@dataclass(frozen=True, slots=True)
class NoiseOption:
    """The noise that a sense can have."""

    unit: str
    """Its unit, with which its key in the spec's `noise` ends: `deg` of `proprioception_deg`."""
    about: str
    """What the number is, for help."""
    most: float
    """Largest number that makes sense."""
    run: Code
    """`bind(amount, sense, low_pass_s) -> Noise`: a term that disturbs its samples (`mimoc/runtime/noise.py`)."""
    by_age: tuple[tuple[float, float], ...] = ()
    """Amounts by age in months, between which it is interpolated, where a spec can say `age`, or `adult`."""
    adult: float = 0.0
    """Amount of adults, where it can."""
    source: str = ""
    """Where these come from."""
    low_pass_ms: float | None = None
    """Time constant of amounts by age, where it is not that of all noise."""
    omit_if_absent: bool = False
    """Whether the bundles of infants without it leave it out, so that they are as they were before there was it."""


@dataclass(frozen=True, slots=True)
class SenseKind(Component):
    """A sense."""

    name: str
    """Key in the spec's `senses`, and with `_ms` in its `delays`."""
    spec: "type[Model]"
    """What a user can ask of it; its docstring is the help on it."""
    entry: "type[Model]"
    """What a bundle's manifest tells the runtime of it."""
    build: Code
    """`build(spec, body) -> Placed`: what it adds to the MJCF, and its entry."""
    run: Code
    """`bind(entry, model, bundle) -> Sense`: what reads it; imported when an environment is opened."""
    organs: tuple[str, ...] = ()
    """Parts of the body of which it requires at least one."""
    paper_delay_ms: float = 50.0
    """Delay with `preset: paper`; 50 ms is the middle one of the delays of the paper's reaching experiment."""
    physiological_delay: AgeTable | None = None
    """Delay with `preset: physiological`; None is no delay."""
    noise: NoiseOption | None = None
    """Noise of its samples; None if it can have none. Its delay can jitter all the same."""
    many: Code | None = None
    """`join(senses) -> Read | None`: from the worlds of many infants on the CPU to a sample of each, or None if
    it cannot read these at once. Senses that are terms need none; others without it are read one after another."""
    omit_if_absent: bool = False
    """Whether the bundles of infants without it leave it out, so that they are as they were before there was it."""
    device: Code | None = None
    """`bind(setup) -> DeviceReader` (`mimoc/runtime/device/signals.py`): what reads it on a device if it is no term."""


@dataclass(frozen=True, slots=True)
class ActuationKind(Component):
    """An actuation model."""

    name: str
    """Value of the spec's `actuation.model`."""
    about: str
    """One sentence for help."""
    build: Code
    """`build(spec, body, timestep_s) -> ActuationSetup`: the actuators, and what they leave of springs and dampers."""
    run: Code
    """`bind(entry, model) -> Actuation`: from an action to controls."""
    spec: "type[Model] | None" = None
    """What else a user can ask of it, as a section of `actuation` under its name."""
    command_is_effort: bool = True
    """Whether a command of 0 is no effort and a larger one is more, so that noise can be a share of it."""


@dataclass(frozen=True, slots=True)
class TaskKind(Component):
    """A task."""

    name: str
    """Value of the spec's `task.kind`."""
    spec: "type[Model]"
    """What a user can ask of it: a section with `kind: Literal[name]`; its docstring is the help on it."""
    entry: "type[Model]"
    """What a bundle's manifest tells the runtime of it, whose `kind` is a `Literal` with its name."""
    build: Code
    """`build(spec, body) -> TaskSetup`: how the infant starts and what the task adds to the world, and its entry."""
    run: Code
    """`bind(entry, model, bundle) -> Task`: what starts episodes and judges each control step."""
    scenes: tuple[str, ...] | None = None
    """Kinds of scenes it can be in; None is all."""
    poses: tuple[str, ...] | None = ()
    """Values of `scene.pose` it can start from: none where it has a start of its own; None is all."""
    step_ms: float = 10.0
    """Control step, unless the spec gives one. `steps` and `*_steps` of the entry that `build` returns are of this
    length; in a bundle with another control step, they are as many as last as long."""
    defaults: Mapping[tuple[str, str], Any] = field(default_factory=dict)
    """Values of other sections by section and key, such as `("scene", "pose")`, unless the spec gives them."""


@dataclass(frozen=True, slots=True)
class SceneKind(Component):
    """A kind of scene."""

    name: str
    """Value of the spec's `scene.kind`."""
    about: str
    """One sentence for help."""
    build: Code
    """`build(spec, occupant, wallpapers) -> BuiltScene`: the world before toys are put there."""
    spec: "type[Model] | None" = None
    """What else a user can ask of it, as a section of `scene` under its name."""
    has_floor: bool = True
    """Whether toys can lie there."""
    needs_footprint: bool = True
    """Whether building it takes the floor that the infant covers in its poses."""
    varies: bool = True
    """Whether the seed changes more of it than its toys."""


@dataclass(frozen=True, slots=True)
class ToySource(Component):
    """A source of toys."""

    name: str
    """Value of the spec's `scene.toys.source`."""
    about: str
    """One sentence for help."""
    build: Code
    """`build(spec, folder) -> Toybox`: the toys there are; paths are relative to *folder*."""
    spec: "type[Model] | None" = None
    """What else a user can ask of it, as a section of `scene.toys` under its name."""
    needs_root: bool = False
    """Whether it requires `scene.toys.root`, a folder."""


@dataclass(frozen=True, slots=True)
class ObjectKind(Component):
    """A kind of objects in the infant's scene."""

    name: str
    """Value of `kind` of an entry of the spec's `scene.objects`."""
    about: str
    """One sentence for help."""
    spec: "type[Model]"
    """What a user can ask of it: an `ObjectSpec` (`mimoc/schema/objects.py`) with `kind: Literal[name]`."""
    build: Code
    """`build(spec, surroundings) -> BuiltObject`: what it is made of, in a frame of its own, before it is placed."""
    start: Code | None = None
    """`start(spec, body, states) -> FurnitureStart`: how an infant starts on, in or at it; None if it never does."""
    poses: tuple[str, ...] = ()
    """Values of `scene.pose` in which it can start there."""
    run: Code | None = None
    """`bind() -> Companion`: what lets all objects of this kind act in a simulation (`mimoc/runtime/companion.py`),
    as the companion of its name; None if MuJoCo alone moves them."""


@dataclass(frozen=True, slots=True)
class PolicyKind(Component):
    """A policy that needs no training."""

    name: str
    """Value of `mimoc run --policy`."""
    about: str
    """One sentence for help."""
    run: Code | None = None
    """`bind(env) -> Policy`: from a random number generator and an observation to an action; with an `argument`,
    `bind(env, text) -> Policy`. None: `many` acts for a single infant, too."""
    argument: str = ""
    """What stands after its name and a colon, as in `motion:DIR`, in a word for help; empty for nothing. In square
    brackets, it may be left out: then `bind(env)` is called."""
    many: Code | None = None
    """`bind_many(batch) -> BatchPolicy`, or `bind_many(batch, text)`: the same for many infants (`policies/policy.py`),
    also on a device. None: on the CPU, one infant after another; on a device, not at all."""
    is_behaviour: bool = False
    """Whether it is a behaviour: `run` is `bind(subject) -> Behaviour` (`mimoc/policies/behaviours/behaviour.py`), and
    one controller does all behaviours of a sum."""

    def __post_init__(self) -> None:
        if self.run is None and self.many is None:
            raise KindError(f"the policy '{self.name}' has nothing that acts; give `run` or `many`")


@dataclass(frozen=True, slots=True)
class ExporterKind(Component):
    """A format that recordings are exported to."""

    name: str
    """Value of `mimoc export --to`."""
    about: str
    """What it is, in a few words for help."""
    run: Code
    """`export(recording, folder, progress)`: writes a recording, of which all episodes have control steps, into an
    empty folder, and returns what the format cannot hold, one line each; `progress(done, total)` shows how far it is.
    """
    is_uniform: bool = False
    """Whether all episodes must have the same observations and number of actuators, at least one, and control step."""


@dataclass(frozen=True, slots=True)
class MotionFormat(Component):
    """A format in which points on filmed infants are recorded."""

    name: str
    """Value of `--format` where recordings of points are read."""
    about: str
    """What it is, in a few words for help."""
    recognise: Code
    """`recognise(path) -> bool`: whether a file or folder looks like it, from names and the first bytes only."""
    read: Code
    """`read(path, options) -> PointRecording`, its names the labels of the file, its rate NaN if that says none.
    *options* are `mimoc.motion.point_recording.ReadOptions`; an `UnusableFileError` says what follows the path in an
    error."""


@dataclass(frozen=True, slots=True)
class EngineKind(Component):
    """Where the jobs of a cohort are done."""

    name: str
    """Value of `mimoc cohort run --on`."""
    options: tuple[str, ...]
    """Names of its options."""
    check: Code
    """`check(options)`: raises a MimocError if it cannot run with them."""
    run: Code
    """`run(jobs, store, options, done)`: has every job done by `mimoc.studies.cohorts.run_jobs.run_jobs(jobs, store)`,
    which writes a result for each, in some process that sees the cohort's folder. It calls `done` with the number of
    jobs that have a result, whenever there are more, and returns when all have one, or raises. When an exception such
    as KeyboardInterrupt leaves it, it ends what it has started. Jobs and store can be pickled; jobs may be handed out
    twice. A job that has no result after `run` has returned counts as failed."""


_IN = "mimoc.components"

SENSES = Registry(
    SenseKind,
    "sense",
    {name: f"{_IN}.senses.{name}" for name in ("proprioception", "vestibular", "touch", "vision", "hearing", "pain")},
)
"""In the order of the observation."""

_ACTUATIONS = {
    "torque": "Torque on a spring and damper at each joint.",
    "muscle": "Two antagonistic muscles for each joint.",
    "position": "Servos that hold a commanded angle with the strength of muscles.",
}
ACTUATIONS = Registry(
    ActuationKind,
    "actuation model",
    {
        name: ActuationKind(
            name,
            about,
            f"{_IN}.actuation.{name}",
            f"{_IN}.actuation.run:bind_{name}",
            command_is_effort=name != "position",
        )
        for name, about in _ACTUATIONS.items()
    },
)

SKILLS = ("roll", "sit_up", "sit", "crawl", "pull_to_stand", "stand", "cruise", "walk", "grasp")
"""Tasks that are motor skills of infants, in the order in which they come; see `mimoc.components.tasks.skills`."""
TASKS = Registry(
    TaskKind,
    "task",
    {
        **{name: f"{_IN}.tasks.{name}" for name in ("reach", "standup", "selfbody", "catch", "rollover")},
        **{name: f"{_IN}.tasks.skills:{name.upper()}" for name in SKILLS},
        "free": f"{_IN}.tasks.free",
    },
)

SCENES = Registry(
    SceneKind,
    "kind of scene",
    {
        "empty": SceneKind(
            "empty",
            "Nothing at all: no floor and no gravity.",
            f"{_IN}.scenes:build_empty",
            has_floor=False,
            needs_footprint=False,
            varies=False,
        ),
        "flat": SceneKind("flat", "An endless floor.", f"{_IN}.scenes:build_flat", needs_footprint=False, varies=False),
        "crib": SceneKind("crib", "A crib that fits the infant.", f"{_IN}.scenes.crib", varies=False),
        "room": f"{_IN}.scenes:ROOM",
    },
)

TOY_SOURCES = Registry(
    ToySource,
    "source of toys",
    {
        "builtin": ToySource("builtin", "The toys that come with mimoc.", f"{_IN}.toys.builtin"),
        "toys4k": ToySource(
            "toys4k",
            "The toys of the Toys4K data set, or other meshes in a folder.",
            f"{_IN}.toys.toys4k.build",
            needs_root=True,
        ),
    },
)

_OBJECTS = ("shape", "mobile", "mat", "seat", "rail", "table", "stairs", "slope", "wall", "screen", "water")
OBJECTS = Registry(ObjectKind, "kind of object", {name: f"{_IN}.objects:{name.upper()}" for name in _OBJECTS})

COMPANIONS: Mapping[str, Code] = {"caregiver": f"{_IN}.companions.caregiver"}
"""`bind() -> Companion`, or the module that has it. An infant has one if its manifest has an entry of that name."""

RECORDING: Code = "mimoc.recording.folder"
"""`read_infant(path) -> Bundle`: what a recording, a folder that is no bundle, is of; or the module that has it."""

_behaviour = partial(PolicyKind, is_behaviour=True)
_POLICIES = "mimoc.policies"
_BEHAVIOURS = f"{_POLICIES}.behaviours"
POLICIES = Registry(
    PolicyKind,
    "policy",
    (
        PolicyKind("random", "draws every command uniformly from its range", many=f"{_POLICIES}.policy:bind_random"),
        PolicyKind("zero", "commands zero", many=f"{_POLICIES}.policy:bind_zero"),
        PolicyKind("reach", "reaches by inverse dynamics; not for servos", f"{_POLICIES}.reach", "[truth]"),
        PolicyKind(
            "general_movements",
            "moves by itself as infants of its age do",
            many=f"{_POLICIES}.general_movements:Moving",
        ),
        PolicyKind(
            "reflexes",
            "has the reflexes of its age, or, by months, of a child that is later",
            argument="[MONTHS]",
            many=f"{_POLICIES}.reflexes.binding",
        ),
        PolicyKind(
            "skill",
            "does what was found for a skill, such as roll, or what is in a file of `mimoc skill`",
            f"{_POLICIES}.skill",
            "NAME",
        ),
        PolicyKind("motion", "follows a recorded motion; not for servos", f"{_POLICIES}.motion", "DIR"),
        _behaviour("hold", "keeps the pose of the start", f"{_BEHAVIOURS}.postures:bind_hold"),
        _behaviour("sit", "sits without support", f"{_BEHAVIOURS}.postures:bind_sit", "[OPTIONS]"),
        _behaviour("prone", "lies on its forearms, head up", f"{_BEHAVIOURS}.postures:bind_prone", "[OPTIONS]"),
        _behaviour(
            "hands_and_knees", "keeps on hands and knees", f"{_BEHAVIOURS}.postures:bind_hands_and_knees", "[OPTIONS]"
        ),
        _behaviour("stand", "stands alone", f"{_BEHAVIOURS}.postures:bind_stand", "[OPTIONS]"),
        _behaviour("kick", "kicks on its back", f"{_BEHAVIOURS}.kick", "[LEG]"),
        _behaviour(
            "look_at",
            "looks at a toy, a part of a body, another infant or a place, or at what it sees move",
            f"{_BEHAVIOURS}.looking_around:bind_look",
            "TARGET",
        ),
        _behaviour(
            "look_around",
            "looks at one thing after another that its eyes see",
            f"{_BEHAVIOURS}.looking_around:bind_look_around",
        ),
        _behaviour("reach_for", "reaches for one with a hand", f"{_BEHAVIOURS}.reaching:bind_reach", "TARGET[,HAND]"),
    ),
)

_EXPORTERS = "mimoc.recording.exporters"
EXPORTERS = Registry(
    ExporterKind,
    "format of recordings",
    (
        ExporterKind("minari", "needs `mimoc[minari]`", f"{_EXPORTERS}.minari", is_uniform=True),
        ExporterKind("lerobot", "version 3", f"{_EXPORTERS}.lerobot", is_uniform=True),
        ExporterKind("mjlab", "motions for its tracking tasks", f"{_EXPORTERS}.mjlab"),
        ExporterKind("csv", "tidy tables of text", f"{_EXPORTERS}.tables:export_csv"),
        ExporterKind("parquet", "the same tables", f"{_EXPORTERS}.tables:export_parquet"),
    ),
)

_FORMATS = {
    "openpose": "folder of OpenPose's JSON, a file for each frame: BODY_25 or COCO-18",
    "mediapipe": "landmarks of MediaPipe, as shares of the picture or in metres: CSV or JSON",
    "coco": "JSON of COCO-17 keypoints: a folder of frames, or one file with all (MMPose, ViTPose, AlphaPose, YOLO)",
    "mini_rgbd": "folder of MINI-RGBD: 2D joints with depth, or 3D joints",
    "csv": "table of named points: wide, long, DeepLabCut's, or public keypoints of MINI-RGBD",
    "npz": "arrays, as mimoc writes them",
    "c3d": "markers of motion capture",
}
FORMATS = Registry(
    MotionFormat,
    "format of recorded points",
    {
        name: MotionFormat(name, about, f"mimoc.motion.read_{name}", f"mimoc.motion.read_{name}")
        for name, about in _FORMATS.items()
    },
)
"""Formats that recordings of points are read from, in the order in which they are tried."""

MOVEMENT_GROUPS = {
    "keypoints": "the 25 keypoints of BODY_25",
    "parts": "place, velocity and speed of hands, feet, head, trunk and the whole body",
    "objects": "place, velocity and speed of the objects of the spec",
    "gaze": "where the eyes look, and at what",
    "contacts": "what each part of the body touches, contact forces and ground reaction",
    "joints": "angles of joints, and torques of motors or muscles about them",
    "actuators": "activation of each muscle or motor",
}
"""Movement columns that are recorded together or not at all, in the order in which tables show them: what they are."""

_ENGINES = {
    "local": ("processes",),
    "slurm": ("partition", "time_min", "memory_gb", "array_limit", "jobs_per_task"),
    "ray": ("address", "jobs_per_task"),
}
_COHORTS = "mimoc.studies.cohorts"
ENGINES = Registry(
    EngineKind,
    "place to run a cohort on",
    [EngineKind(name, options, f"{_COHORTS}.{name}", f"{_COHORTS}.{name}") for name, options in _ENGINES.items()],
)
