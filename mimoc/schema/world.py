"""A world with several infants: the files of their specs, where they are, and what is around them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, StringConstraints, Tag, model_validator

from mimoc.base.errors import Problem, SpecError, suggestion
from mimoc.schema import source as sources
from mimoc.schema.base import KeyedError, Model, given
from mimoc.schema.caregiver import check_times
from mimoc.schema.infant import InfantSpec, parts_left, read_spec
from mimoc.schema.objects import check_start
from mimoc.schema.quantities import Degrees, Identifier, PathText, Real, by_shape, version_one
from mimoc.schema.reading import FileModel, read_keys
from mimoc.schema.scene import SceneSpec, infants_named
from mimoc.schema.source import FileKind, Source, in_memory_as_text

WORLD = FileKind("world file", "mimoc, name and infants", "infants: [anna.yaml, ben.yaml]")
MAX_INFANTS = 8
MAX_NAME = 16  # Letters of an infant's name: MuJoCo's files of skins have 40 for it and the name of a body.
INFANTS = "infants"
Position = Annotated[Real, Field(ge=-500, le=500, json_schema_extra={"unit": "cm"})]
InfantName = Annotated[Identifier, StringConstraints(max_length=MAX_NAME)]


class PlacedInfantSpec(Model):
    """An infant of a world, and where it is."""

    spec: Annotated[PathText, Field(examples=["anna.yaml"])]
    """Its spec, a YAML file. Of the scene in it, only `pose` and `held` count."""
    name: InfantName | None = None
    """Its name in this world, with which the names of all its parts begin; by default, that in its spec."""
    x_cm: Position | None = None
    """Where its hip is; by default, 0."""
    y_cm: Position | None = None
    """Where its hip is; by default, infants are side by side along y."""
    yaw_deg: Annotated[Degrees, Field(ge=-360, le=360)] = 0.0
    """By how much it is turned to its left about the vertical; at 0 it faces along x."""
    start_at: Identifier | None = None
    """The object of the world's scene that it starts on, in or at. With coordinates, that takes the infant there;
    without a place of its own, it is where the infant is."""


OF_EACH = "each infant of a world has its own; write this in the scene of its spec"
NOT_OF_ALL = {
    "pose": OF_EACH,
    "held": OF_EACH,
    "start_at": "each infant of a world starts in its own place; write {spec: anna.yaml, start_at: ...} in infants",
}
"""Keys of a scene that a world does not have, and why."""

InfantChoice = Annotated[
    Annotated[PathText, Tag("a word")] | Annotated[PlacedInfantSpec, Tag("a section")],
    *by_shape("an infant; write the path of its spec, or {spec: anna.yaml, y_cm: 40}"),
]


class WorldSpec(FileModel):
    """Several infants in one world, as a file describes them."""

    mimoc: Annotated[Literal[1], version_one("the spec language"), Field(examples=[1])]
    """Version of the spec language."""
    name: Annotated[Identifier, Field(examples=["two"])]
    """Name of the world and of its MuJoCo model."""
    infants: Annotated[
        tuple[InfantChoice, ...], Field(min_length=1, max_length=MAX_INFANTS, examples=[["anna.yaml", "ben.yaml"]])
    ]
    """The infants: the files of their specs, relative to this one; or `{name: anna, spec: a.yaml, x_cm: 0, y_cm: 40,
    yaw_deg: 90}`."""
    scene: SceneSpec = Field(default_factory=SceneSpec)
    """The scene around all of them; what is an infant's own, `pose` and `held`, is in the scene of its spec."""

    @model_validator(mode="before")
    @classmethod
    def _scene_is_for_all(cls, data: Any) -> Any:
        scene = data.get("scene") if isinstance(data, Mapping) else None
        for key, message in NOT_OF_ALL.items():
            if isinstance(scene, Mapping) and key in scene:
                raise KeyedError(("scene", key), message)
        return data

    @model_validator(mode="after")
    def _furniture_has_one_infant_and_one_place(self) -> Self:
        at = dict[str, Any]()
        places = {item.name: item.at for item in self.scene.objects}
        for index, item in enumerate(self.placed):
            if item.start_at is None:
                continue
            if item.start_at in at:
                message = f"another infant starts at '{item.start_at}'; give each an object of its own"
                raise KeyedError((INFANTS, index, "start_at"), message)
            at[item.start_at] = item
            key = next((key for key in ("x_cm", "y_cm", "yaw_deg") if key in item.model_fields_set), None)
            if key and places.get(item.start_at) is not None:
                message = f"'{item.start_at}' has a place of its own and takes the infant there; leave this out"
                raise KeyedError((INFANTS, index, key), message, against=("scene", "objects"))
        return self

    @property
    def placed(self) -> tuple[PlacedInfantSpec, ...]:
        """The infants, those given as paths too."""
        return tuple(PlacedInfantSpec(spec=item) if isinstance(item, str) else item for item in self.infants)


@dataclass(frozen=True)
class WorldPlan:
    """A world with the specs of its infants."""

    spec: WorldSpec
    infants: Mapping[str, InfantSpec]  # By their names in the world, in the order of the file.

    @property
    def written(self) -> Source:
        """The file of the world."""
        assert self.spec.source
        return self.spec.source

    def problem(self, index: int, message: str) -> Problem:
        """Return a problem with one of the infants."""
        return self.written.problem((INFANTS, index), message)


def is_world(data: Any) -> bool:
    """Return whether what a file says is of a world with several infants."""
    return isinstance(data, Mapping) and INFANTS in data


def read_world(source: Source) -> WorldPlan:
    """Return the world that a file describes, with its infants.

    Raises:
        SpecError: If it or the spec of an infant is invalid; the error lists the problems of all files.
    """
    spec = read_keys(WorldSpec, source)
    specs, problems = list[InfantSpec](), list[Problem]()
    for index, item in enumerate(spec.placed):
        try:
            specs.append(_read_infant(source.folder / Path(item.spec).expanduser()))
        except SpecError as error:
            of_file = [
                problem for problem in error.problems if not problem.key
            ]  # No key: there is no file, or none that can be read.
            problems += [source.problem((INFANTS, index), f"{item.spec}: {problem.message}") for problem in of_file]
            problems += [problem for problem in error.problems if problem.key]
    if problems:
        raise SpecError(problems)
    return checked_plan(spec, specs)


def plan_of(infants: Mapping[str, InfantSpec], name: str = "world", **keys: Any) -> WorldPlan:
    """Return a world of infants by their names in it, as if from a file; *keys* are other keys of that, such as scene.

    Raises:
        SpecError: If there is no such world.
    """
    entries = [{"spec": f"{INFANTS}/{infant}/spec.yaml", "name": infant} for infant in infants]
    data = {"mimoc": 1, "name": name, INFANTS: entries, **keys}
    spec = read_keys(WorldSpec, in_memory_as_text(data, f"<{name}>", Path()))
    return checked_plan(spec, list(infants.values()))


def checked_plan(spec: WorldSpec, specs: list[InfantSpec]) -> WorldPlan:
    """Return a world whose infants can be told apart and live by the same clock, each with its spec in order.

    Raises:
        SpecError: If they do not.
    """
    names = [item.name or infant.name for item, infant in zip(spec.placed, specs, strict=True)]
    assert spec.source
    if problems := [*_clashes(names, spec.source), *_clocks(names, specs, spec.source)]:
        raise SpecError(problems)
    plan = WorldPlan(spec, dict(zip(names, specs, strict=True)))
    if problems := [*_unknown(plan), *_starts(plan), *_caregiver(plan)]:
        raise SpecError(problems)
    return plan


def with_keys(plan: WorldPlan, **keys: Any) -> WorldPlan:
    """Return a world with other keys than its file, written anew; its infants are the same."""
    data = {**plan.written.data, **keys}
    written = in_memory_as_text(data, f"<{plan.spec.name}>", plan.written.folder)
    return WorldPlan(read_keys(WorldSpec, written), plan.infants)


def in_scene(plan: WorldPlan, seed: int) -> WorldPlan:
    """Return a world in the scene of a seed."""
    scene = plan.written.data.get("scene", {})
    return plan if seed == plan.spec.scene.seed else with_keys(plan, scene={**scene, "seed": seed})


def in_world(plan: WorldPlan, name: str) -> InfantSpec:
    """Return the spec of an infant with the world's scene around it, without what lies there: that is the world's.

    Raises:
        SpecError: If it cannot be there.
    """
    infant = plan.infants[name]
    around = given(plan.spec.scene)
    index = list(plan.infants).index(name)
    kept = {key: value for key, value in around.items() if key not in ("toys", "textures", "objects", "caregiver")}
    if start_at := plan.spec.placed[index].start_at:
        (item,) = (item for item in around["objects"] if item["name"] == start_at)
        kept |= {"start_at": start_at, "objects": [{key: value for key, value in item.items() if key != "infant"}]}
    scene = SceneSpec.model_validate({**kept, "pose": infant.scene.pose, "held": infant.scene.held})
    try:
        return infant.with_(name=name, scene=scene)
    except SpecError as error:
        reasons = (f"in the scene of this world, {problem.key}: {problem.message}" for problem in error.problems)
        raise SpecError(plan.problem(index, reason) for reason in reasons) from None


def _read_infant(path: Path) -> InfantSpec:
    source = sources.read(path)
    if is_world(source.data):
        message = "this file describes a world; name the specs of single infants"
        raise SpecError([source.problem((INFANTS,), message, at="key")])
    return read_spec(source)


def _clashes(names: list[str], source: Source) -> Iterator[Problem]:
    """Yield where names are not told apart: the parts of an infant are named `anna_head`."""
    for index, name in enumerate(names):
        if len(name) > MAX_NAME:
            message = f"the name '{name}' has more than {MAX_NAME} letters; give another with 'name'"
            yield source.problem((INFANTS, index), message)
        for other in names[:index]:
            if f"{name}_".startswith(f"{other}_") or f"{other}_".startswith(f"{name}_"):
                same = "is the name of another infant as well" if name == other else f"and '{other}' are too alike"
                message = f"'{name}' {same}; give this one another with {{name: ..., spec: ...}}"
                yield source.problem((INFANTS, index), message)


def _unknown(plan: WorldPlan) -> Iterator[Problem]:
    """Yield where the scene names an infant that is not there."""
    for key, name in infants_named(plan.spec.scene):
        if name not in plan.infants:
            message = f"there is no infant '{name}'; {suggestion(name, plan.infants)}"
            yield plan.written.problem(("scene", *key), message)


def _starts(plan: WorldPlan) -> Iterator[Problem]:
    """Yield where infants cannot start at the furniture that is named."""
    for index, (item, infant) in enumerate(zip(plan.spec.placed, plan.infants.values(), strict=True)):
        try:
            if item.start_at is not None:
                check_start(plan.spec.scene.objects, item.start_at, infant.scene.pose)
        except KeyedError as error:
            yield plan.written.problem((INFANTS, index, "start_at"), str(error))


def _caregiver(plan: WorldPlan) -> Iterator[Problem]:
    """Yield where a caregiver would act between physics steps, or hold a part that an infant lacks."""
    adult, infants = plan.spec.scene.caregiver, plan.infants
    if adult is None:
        return
    try:
        check_times(adult, next(iter(infants.values())).control.timestep_ms)
    except KeyedError as error:
        yield plan.written.problem(error.key, str(error))
    for number, act in enumerate(adult.script):
        for name in infants if (about := act.infant or adult.infant) is None else [about]:
            if act.part is not None and name in infants and act.part not in (left := parts_left(infants[name].body)):
                message = f"'{name}' has no '{act.part}'; {suggestion(act.part, sorted(left))}"
                yield plan.written.problem(("scene", "caregiver", "script", number, "part"), message)


def _clocks(names: list[str], specs: list[InfantSpec], source: Source) -> Iterator[Problem]:
    for key, what in (("timestep_ms", "physics step"), ("step_ms", "control step")):
        first_ms = getattr(specs[0].control, key)
        for index, spec in enumerate(specs):
            if (step_ms := getattr(spec.control, key)) != first_ms:
                message = (
                    f"'{names[index]}' has a {what} of {step_ms:g} ms and '{names[0]}' one of {first_ms:g} ms; "
                    f"write the same control.{key} in both specs"
                )
                yield source.problem((INFANTS, index), message)
