"""Records of the kinds of things an infant can have: all that mimoc must know of each, in one place.

A record names the code of a kind by module, so that each command imports only what it needs: the spec language is known
without the compiler, and a bundle is opened without it.
"""

import os
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoints, distributions, entry_points
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeVar

from mimoc.base.errors import KindError, UnknownNameError

if TYPE_CHECKING:  # The names of kinds are known before pydantic is.
    from mimoc.body.part import ReferencePart
    from mimoc.schema.base import Model

Code = str | Callable[..., Any]
"""A function, or the full name of the module that defines it."""

NAME = re.compile("[a-z][a-z0-9_]*")
PLUGINS_VARIABLE = "MIMOC_PLUGINS"
"""Environment variable that names the distributions whose plug-ins are used, with commas; `none` is none of them."""


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
    """`bind(amount, sense, low_pass_s) -> Noise`: a term that disturbs its samples; see `mimoc/noise/noise.py`."""
    by_age: tuple[tuple[float, float], ...] = ()
    """Amounts by age in months, between which it is interpolated, where a spec can say `age`, or `adult`."""
    adult: float = 0.0
    """Amount of adults, where it can."""
    source: str = ""
    """Where these come from."""
    low_pass_ms: float | None = None
    """Time constant of amounts by age, where it is not that of all noise."""
    is_recent: bool = False
    """Whether the bundles of infants without it leave it out, so that they are as they were before there was it."""


@dataclass(frozen=True, slots=True)
class SenseKind:
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
    is_recent: bool = False
    """Whether the bundles of infants without it leave it out, so that they are as they were before there was it."""
    device: Code | None = None
    """`bind(setup) -> DeviceReader` (`mimoc/runtime/device/signals.py`): what reads it on a device if it is no term."""


@dataclass(frozen=True, slots=True)
class ActuationKind:
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
class TaskKind:
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
class SceneKind:
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
class ToySource:
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
class ObjectKind:
    """A kind of objects in the infant's scene."""

    name: str
    """Value of `kind` of an entry of the spec's `scene.objects`."""
    about: str
    """One sentence for help."""
    spec: "type[Model]"
    """What a user can ask of it: an `ObjectSpec` (`mimoc/objects/spec_base.py`) with `kind: Literal[name]`."""
    build: Code
    """`build(spec, surroundings) -> BuiltObject`: what it is made of, in a frame of its own, before it is placed."""
    start: Code | None = None
    """`start(spec, body, states) -> FurnitureStart`: how an infant starts on, in or at it; None if it never does."""
    poses: tuple[str, ...] = ()
    """Values of `scene.pose` in which it can start there."""
    run: Code | None = None
    """`bind() -> Companion`: what lets all objects of this kind act in a simulation (`mimoc/companions/companion.py`),
    as the companion of its name; None if MuJoCo alone moves them."""


@dataclass(frozen=True, slots=True, eq=False)
class PartKind:
    """Parts of the body that belong together: a tail, a pair of wings, other hands."""

    name: str
    """Name in the spec's `body.extra`, or value of its `body.hands`."""
    about: str
    """One sentence for help."""
    parts: "tuple[ReferencePart, ...]"
    """Their joints, geoms and motors at 18 months, parents first; a name with `{side}` is on both sides."""
    shape: Code
    """`shape(proportions) -> Dimensions`: sizes and places of the geoms, and places of the parts, of the right side."""
    replaces: Literal["hands"] | None = None
    """What it is in place of; None is an addition. Hands begin with `{side}_hand`, which is on `{side}_lower_arm`."""
    excluded: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies without contacts."""
    masses_kg: Mapping[str, float] = field(default_factory=dict)
    """Masses at 18 months that geoms of other parts have with these, where they are not the usual ones."""


@dataclass(frozen=True, slots=True)
class PolicyKind:
    """A policy that needs no training."""

    name: str
    """Value of `mimoc run --policy`."""
    about: str
    """One sentence for help."""
    run: Code
    """`bind(env) -> Policy`: from a random number generator and an observation to an action; with an `argument`,
    `bind(env, text) -> Policy`."""
    argument: str = ""
    """What stands after its name and a colon, as in `motion:DIR`, in a word for help; empty for nothing. In square
    brackets, it may be left out: then `bind(env)` is called."""
    many: Code | None = None
    """`bind_many(batch) -> BatchPolicy`, or `bind_many(batch, text)`: the same for many infants (`policies/batch.py`),
    also on a device. None: on the CPU, one infant after another; on a device, not at all."""
    is_behaviour: bool = False
    """Whether it is a behaviour: `run` is `bind(subject) -> Behaviour` (`mimoc/policies/behaviours/behaviour.py`), and
    one controller does all behaviours of a sum."""


@dataclass(frozen=True, slots=True)
class ExporterKind:
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
class MotionFormat:
    """A format in which points on filmed infants are recorded."""

    name: str
    """Value of `--format` where recordings of points are read."""
    about: str
    """What it is, in a few words for help."""
    recognise: Code
    """`recognise(path) -> bool`: whether a file or folder looks like it, from names and the first bytes only."""
    read: Code
    """`read(path, options) -> PointRecording`, its names the labels of the file, its rate NaN if that says none.
    *options* are `mimoc.motion.options.ReadOptions`; an `UnusableFileError` says what follows the path in an error."""


class Kind(Protocol):
    """What all records have in common."""

    @property
    def name(self) -> str:
        """Name, unique among its kind of thing."""
        ...


K = TypeVar("K", bound=Kind)


@dataclass(frozen=True)
class Kinds(Mapping[str, K]):
    """The records of one kind of thing by name: mimoc's own, in their order, then those that were added."""

    what: str
    """What they are, in the singular, such as `sense`."""
    builtin: Mapping[str, K | str]
    """Mimoc's own; a record that is only imported when it is asked for is the `KIND` of the module that is named, or
    what a module names otherwise, as `module:NAME`."""
    _added: dict[str, tuple[K, str]] = field(default_factory=dict)

    def __getitem__(self, name: str) -> K:
        if name not in self.builtin:
            return self._added[name][0]
        record: Any = self.builtin[name]
        if not isinstance(record, str):
            return record
        module, _, attribute = record.partition(":")
        return getattr(import_module(module), attribute or "KIND")

    def __iter__(self) -> Iterator[str]:
        yield from self.builtin
        yield from sorted(self._added)

    def __len__(self) -> int:
        return len(self.builtin) + len(self._added)

    def find(self, name: str) -> K:
        """Return the record of a name, or raise an UnknownNameError."""
        if name not in self:
            raise UnknownNameError(self.what, name, list(self))
        return self[name]

    def distribution(self, name: str) -> str:
        """Return the distribution that a kind comes from, such as `mimoc`; empty if a script registered it."""
        return "mimoc" if name in self.builtin else self._added[name][1]

    def add(self, record: K, distribution: str = "") -> None:
        """Add somebody else's record; a script may replace what it registered before.

        Raises:
            KindError: If its name is no identifier in lower case, or is taken.
        """
        if not NAME.fullmatch(record.name):
            raise KindError(f"'{record.name}' cannot name a {self.what}; use lower-case letters, digits and '_'")
        if record.name in self and (distribution or self.distribution(record.name)):
            taken = self.distribution(record.name) or "this script"
            raise KindError(f"there is a {self.what} '{record.name}' already, from {taken}; choose another name")
        self._added[record.name] = record, distribution

    def remove(self, name: str) -> None:
        """Take out a record that was added."""
        del self._added[name]


def check_custom_object(what: str, custom: object, method: str, example: str) -> None:
    """Raise a KindError unless what a script passes instead of a record is an object with a method, not its class."""
    if isinstance(custom, type):
        raise KindError(f"{what} is the class {custom.__name__}; pass an object of it: {custom.__name__}()")
    if not callable(getattr(custom, method, None)):
        raise KindError(f"{what} is {custom!r:.60}, which has no method '{method}'; pass {example}")


def announced(group: str) -> list[str]:
    """Return the names of the kinds that installed distributions announce in a group of entry points, not loaded."""
    return sorted(point.name for point in installed_entry_points().select(group=group))


@cache
def installed_entry_points() -> EntryPoints:
    """Return the entry points of all installed distributions, or of those that `MIMOC_PLUGINS` names, looked up once.

    A name there that no distribution with entry points of mimoc has is a warning.
    """
    wanted = os.environ.get(PLUGINS_VARIABLE)
    if wanted is None:
        installed: Any = entry_points()  # Python 3.11's has another type, with the same `select`.
        return installed
    names = {_normalized(name) for name in wanted.split(",") if name.strip()} - {"none"}
    points = [point for package in distributions() for point in package.entry_points] if names else []
    ours = {point: _normalized(point.dist.name) for point in points if point.dist and point.group.startswith("mimoc.")}
    for name in sorted(names - set(ours.values())):
        warnings.warn(f"{PLUGINS_VARIABLE}: no installed package '{name}' has plug-ins for mimoc", stacklevel=2)
    return EntryPoints(point for point, name in ours.items() if name in names)


def function_of(code: Code, name: str) -> Callable[..., Any]:
    """Return the function that a record means: *code* itself, or what has this name in the module.

    Raises:
        KindError: If somebody else's module cannot be imported, or has no such function.
    """
    if not isinstance(code, str):
        return code
    if code.startswith("mimoc."):
        return getattr(import_module(code), name)
    try:
        return getattr(import_module(code), name)
    except (Exception, SystemExit) as error:  # Whatever a plug-in's module does when it is imported.
        raise KindError(f"the plug-in module '{code}' has no usable function '{name}': {error!r}") from error


def _normalized(distribution: str) -> str:
    """Return the name of a distribution in the form in which equal names are equal (PEP 503)."""
    return re.sub(r"[-_.]+", "-", distribution.strip()).lower()
