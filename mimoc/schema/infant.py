"""A spec: its keys and the checks that involve several sections, reading it, and changing it, such as in age."""

import math
import operator
import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ModelWrapValidatorHandler, PrivateAttr, ValidationError, ValidationInfo, model_validator

from mimoc.anatomy.anatomy import assemble
from mimoc.base.classes import PATH, takes
from mimoc.base.errors import Problem, SpecError, suggestion
from mimoc.base.rounding import rounded
from mimoc.base.units import to_steps
from mimoc.schema import source
from mimoc.schema.actuation import ActuationSpec
from mimoc.schema.base import KeyedError, KeyPath, Model, changed, composed, everything, given, plain, shown
from mimoc.schema.body import INDICATORS, BodySpec, Clothes, IndividualSpec
from mimoc.schema.caregiver import check_times
from mimoc.schema.impairments import ImpairmentsSpec
from mimoc.schema.kinds import ACTUATIONS, SENSES, TASKS
from mimoc.schema.names import SIDES, Development, single_groups, unsided
from mimoc.schema.plugins import load_plugins
from mimoc.schema.quantities import LAST_MONTH, Age, Identifier, Milliseconds, version_one
from mimoc.schema.reading import FileModel, read_keys
from mimoc.schema.scene import SceneSpec, infants_named
from mimoc.schema.senses import DelaysSpec, NoiseSpec, SensesSpec, check_noise
from mimoc.schema.sizes import check_sizes, pairs
from mimoc.schema.source import Source, in_memory, in_memory_as_text
from mimoc.schema.task import TaskSpec, task_field


class ControlSpec(Model):
    """Duration of physics steps and of control steps."""

    step_ms: Annotated[Milliseconds, Field(ge=0.1, le=1000)] = 10.0
    """Duration of a control step, a whole number of physics steps; by default that of the task, or 10 ms."""
    timestep_ms: Annotated[Milliseconds, Field(ge=0.1, le=20)] = 5.0
    """Duration of a physics step."""


@composed(lambda: {"task": task_field()})
class InfantSpec(FileModel):
    """One infant in one scene, as the user specified it: nothing is computed, and omitted keys have their defaults."""

    mimoc: Annotated[Literal[1], version_one("the spec language"), Field(examples=[1])]
    """Version of the spec language."""
    name: Annotated[Identifier, Field(examples=["my_infant"])]
    """Name of the infant and of its MuJoCo model."""
    age_months: Annotated[Age, Field(examples=[9])]
    """Age of the infant."""
    development: Development = "maturing"
    """What changes with age besides size: strength, tone, ranges of joints and proportions as real infants'
    (`maturing`), or as published with MIMo v2 (`published`), where strength follows volume and all else stays as at 18
    months."""
    impairments: ImpairmentsSpec | None = None
    """What differs from a healthy child: weakness, muscle tone, contractures, birth before term."""
    body: BodySpec = Field(default_factory=BodySpec)
    """The body."""
    actuation: ActuationSpec = Field(default_factory=ActuationSpec)
    """Actuation model and muscle strength."""
    senses: SensesSpec = Field(default_factory=SensesSpec)
    """The senses; a sense that is not listed is off."""
    delays: DelaysSpec = Field(default_factory=DelaysSpec)
    """Sensory and motor delays."""
    noise: NoiseSpec = Field(default_factory=NoiseSpec)
    """Noise of the commands and the senses, and jitter of the delays; by default, none."""
    scene: SceneSpec = Field(default_factory=SceneSpec)
    """The scene around the infant."""
    control: ControlSpec = Field(default_factory=ControlSpec)
    """Duration of control and physics steps."""
    task: TaskSpec | None = None
    """The task; by default, none."""

    _as_read: tuple[Any, ...] = PrivateAttr(default=())
    """The values that were read from the source; a changed copy has others."""

    @property
    def months_early(self) -> float:
        """How many months before term the child was born; 0 from term on."""
        return self.impairments.months_early if self.impairments else 0.0

    @property
    def birth_keys(self) -> tuple[str, ...]:
        """The key that says how early the child was born, if one does."""
        return (f"spec.impairments.{self.impairments.birth_key}",) if self.impairments and self.months_early else ()

    @property
    def corrected_age_months(self) -> float:
        """Age of what matures with it: that since term of a child that was born before, else since birth."""
        return self.age_months - self.months_early

    @property
    def earliest_months(self) -> float:
        """The least age that the child can have: at which it is at term, in hundredths of a month, rounded up."""
        return math.ceil(100 * self.months_early) / 100

    @property
    def clothes(self) -> Clothes:
        """What the infant wears."""
        return self.body.looks.clothes_at(self.corrected_age_months)

    @model_validator(mode="after")
    def _is_at_term(self) -> Self:
        if self.corrected_age_months < 0:
            message = (
                f"a child that was born {self.months_early:.2f} months early is not at term yet, and there are no "
                f"tables of growth before; give {self.earliest_months:g} or more"
            )
            raise KeyedError(("age_months",), message, against=("impairments",))
        return self

    @model_validator(mode="after")
    def _takes_what_its_task_begins_with(self) -> Self:
        is_noisy = ACTUATIONS[self.actuation.model].command_is_effort  # Commands of servos have no noise.
        for (section, key), value in (TASKS[self.task.kind].defaults if self.task else {}).items():
            given = getattr(self, section)
            if key not in given.model_fields_set and (is_noisy or (section, key) != ("noise", "motor")):
                completed = type(given).model_construct(given.model_fields_set, **{**dict(given), key: value})
                object.__setattr__(self, section, completed)
        return self

    @model_validator(mode="after")
    def _senses_have_their_organs(self) -> Self:
        for name, _ in self.senses:
            needed = SENSES[name].organs
            if needed and getattr(self.senses, name) is not None and set(needed) <= set(self.body.remove):
                message = f"'{name}' requires {' or '.join(needed)}, and all are removed; leave it out, or keep one"
                raise KeyedError(("senses", name), message, against=("body", "remove"))
        return self

    @model_validator(mode="after")
    def _says_nothing_of_what_is_missing(self) -> Self:
        actuation = self.actuation
        touch = getattr(self.senses, "touch", None)
        groups = {
            ("actuation", "strength"): tuple(actuation.strength),
            ("actuation", "regions"): actuation.regions or (),
            ("actuation", "locked"): actuation.locked,
            ("senses", "touch", "regions"): (touch and touch.regions) or (),
        }
        check_parts(self.body, groups)
        if self.senses.vision and self.senses.vision.body == "skin" and self.body.skin is False:
            message = "there is no skin to see; write 'solids', or remove 'skin: false' from the body"
            raise KeyedError(("senses", "vision", "body"), message, against=("body", "skin"))
        return self

    @model_validator(mode="after")
    def _has_the_parts_with_skin(self) -> Self:
        touch = getattr(self.senses, "touch", None)
        if not touch or not touch.spacing_cm:
            return self
        groups = parts_left(self.body)
        key = ("senses", "touch", "spacing_cm")
        for name in touch.spacing_cm:
            if name not in groups:
                message = f"this infant has no '{name}'; {suggestion(name, sorted(groups))}"
                raise KeyedError((*key, name), message, against=("body",))
            if touch.regions is not None and groups[name] not in single_groups(touch.regions):
                message = f"'{name}' is moved by '{groups[name]}', which is none of the regions; add it, or remove this"
                raise KeyedError((*key, name), message, against=("senses", "touch", "regions"))
        return self

    @model_validator(mode="after")
    def _names_no_other_infants(self) -> Self:
        for key, name in infants_named(self.scene):
            raise KeyedError(
                ("scene", *key), f"'{name}' is another infant, and only a world has several; leave this out"
            )
        return self

    @model_validator(mode="after")
    def _caregiver_holds_parts_that_are_there(self) -> Self:
        for number, act in enumerate(self.scene.caregiver.script if self.scene.caregiver else ()):
            if act.part is not None and act.part not in (left := parts_left(self.body)):
                message = f"this infant has no '{act.part}'; {suggestion(act.part, sorted(left))}"
                raise KeyedError(("scene", "caregiver", "script", number, "part"), message, against=("body",))
        return self

    @model_validator(mode="after")
    def _delayed_senses_are_on(self) -> Self:
        for name, section in self.senses:
            if section is None and getattr(self.delays, f"{name}_ms"):
                message = f"'{name}' is off, so it has no delay; add '{name}: {{}}' to the senses, or remove this"
                raise KeyedError(("delays", f"{name}_ms"), message, against=("senses", name))
        return self

    @model_validator(mode="after")
    def _says_each_size_once(self, info: ValidationInfo) -> Self:
        check_sizes(self.body, max(0.0, self.corrected_age_months), info.context)
        return self

    @model_validator(mode="after")
    def _task_has_its_place(self) -> Self:
        if self.task is None:
            return self
        kind = TASKS[self.task.kind]
        for key, allowed in (("kind", kind.scenes), ("pose", kind.poses)):
            if allowed and getattr(self.scene, key) not in allowed:
                message = f"task '{kind.name}' requires scene.{key}: {' or '.join(allowed)}; change one of them"
                raise KeyedError(("scene", key), message, against=("task", "kind"))
        return self

    @model_validator(mode="after")
    def _starts_in_one_way(self) -> Self:
        if self.task and self.scene.start_at is not None and TASKS[self.task.kind].poses == ():
            message = f"task '{self.task.kind}' has a start of its own; leave this out, or the task"
            raise KeyedError(("scene", "start_at"), message, against=("task", "kind"))
        return self

    @model_validator(mode="after")
    def _control_step_is_whole(self) -> Self:
        control = self.control
        key = ("control", "timestep_ms")
        against = ("control", "step_ms")
        if "step_ms" in control.model_fields_set:
            key, against = against, key
        elif self.task:
            against = ("task", "kind")
            step_ms = TASKS[self.task.kind].step_ms
            control = ControlSpec.model_construct(control.model_fields_set, **{**dict(control), "step_ms": step_ms})
            object.__setattr__(self, "control", control)
        try:
            if control.step_ms < control.timestep_ms:
                shorter = f"{control.step_ms:g} ms is less than a physics step of {control.timestep_ms:g} ms"
                raise ValueError(f"{shorter}; give 'step_ms' {control.timestep_ms:g} or more")
            to_steps(control.step_ms, control.timestep_ms)
        except ValueError as error:
            raise KeyedError(key, f"a control step of {error}", against=against) from None
        return self

    @model_validator(mode="after")
    def _hears_a_whole_number_of_samples(self) -> Self:
        hearing = getattr(self.senses, "hearing", None)
        samples = hearing.sample_rate_hz * self.control.step_ms / 1000 if hearing else 0.0
        if abs(samples - round(samples)) > 1e-6:
            message = f"a control step of {self.control.step_ms:g} ms has {samples:.2f} samples; choose another rate"
            key = ("senses", "hearing", "sample_rate_hz")
            raise KeyedError(key, f"{message}, such as 24000 or 16000", against=("control", "step_ms"))
        return self

    @model_validator(mode="after")
    def _delays_are_whole_steps(self) -> Self:
        for key, delay_ms in self.delays:
            if not isinstance(delay_ms, float):
                continue
            try:
                to_steps(delay_ms, self.control.timestep_ms)
            except ValueError as error:
                raise KeyedError(("delays", key), f"a delay of {error}", against=("control", "timestep_ms")) from None
        return self

    @model_validator(mode="after")
    def _caregiver_acts_at_whole_steps(self) -> Self:
        if self.scene.caregiver:
            check_times(self.scene.caregiver, self.control.timestep_ms)
        return self

    @model_validator(mode="after")
    def _noise_has_something_to_act_on(self) -> Self:
        check_noise(self.noise, dict(self.senses), self.delays, self.actuation.model, self.control.timestep_ms)
        if self.impairments and self.impairments.noise and not ACTUATIONS[self.actuation.model].command_is_effort:
            message = f"commands of '{self.actuation.model}' actuators are no efforts, which have noise; leave it out"
            raise KeyedError(("impairments", "noise"), message, against=("actuation", "model"))
        return self

    @model_validator(mode="wrap")
    @classmethod
    def _refused_as_a_file(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        """Refuse data from Python with the messages of a file that says the same."""
        try:
            return handler(data)
        except ValidationError as error:
            refusal = error
        if isinstance(data, Mapping) and not isinstance(info.context, Source):
            read_keys(cls, in_memory(plain(data), f"<{shown(str(data.get('name', 'spec')))}>", Path()))
        raise refusal

    def with_(self, **changes: Any) -> Self:
        """Return a copy with some keys changed, validated like a spec that is read from a file.

        All other keys are kept, and paths stay relative to the folder of the file it was read from. A dictionary
        changes the keys that it names and keeps the others of its section; a section given as an object replaces the
        whole section; None resets a key or a section to its default. With another age, it is the same child then:
        what the spec says in cm and kg grows along its percentiles (`docs/individuals.md`), unless *changes* say it.

        Args:
            changes: New values, by key of the spec.

        Raises:
            SpecError: If the new spec is invalid; the error lists all problems by key.

        Example:
            >>> import mimoc
            >>> spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=6, senses={"touch": {}, "vestibular": {}})
            >>> older = spec.with_(age_months=9.5, body={"hands": "five_finger"}, senses={"touch": None})
            >>> older.body.hands, older.senses.touch is None, older.senses.vestibular is None
            ('five_finger', True, False)
        """
        data = self._source.data if self._source and _says(self._source, self) else given(self)
        if "age_months" in changes and (
            grown := at_another_age(self.body, self.age_months, plain(changes["age_months"]), self.months_early)
        ):
            data = changed(data, {"body": grown})
        return _checked(type(self), changed(data, changes), self)

    def _repr_html_(self) -> str:
        return f"<pre>{escape(as_written(self).text)}</pre>"

    def __eq__(self, other: object) -> bool:
        """Return whether two specs have equal values, regardless of the files they were read from."""
        return isinstance(other, InfantSpec) and self.__dict__ == other.__dict__

    def model_post_init(self, context: Any) -> None:
        """Store the source, which is passed as the context of validation, and what was read from it."""
        super().model_post_init(context)
        self._as_read = tuple(self.__dict__.values()) if self._source else ()

    @property
    def is_as_read(self) -> bool:
        """Whether each value is the very one that was read, and so validated, from the source."""
        values = tuple(self.__dict__.values())
        return len(values) == len(self._as_read) and all(map(operator.is_, values, self._as_read))


def parts_left(body: BodySpec) -> dict[str, str]:
    """Return the parts that an infant has, by name, and the muscle group of each."""
    anatomy = assemble(body.hands, body.chest_joint, "published", body.extra or ())
    gone, group_of = set(body.remove), dict[str, str]()
    for side, part in anatomy.parts:  # Parents come first.
        name = part.name.format(side=side)
        parent = (part.parent or "").format(side=side)
        if name in gone or parent in gone:
            gone.add(name)
        else:
            group_of[name] = part.group.format(side=side) or group_of.get(parent, "")
    return group_of


def check_parts(body: BodySpec, groups: Mapping[KeyPath, Iterable[str]]) -> None:
    """Check that an infant has the parts that keys are about, and the muscle groups that sections name, by their path.

    Raises:
        KeyedError: If the infant has none of the parts that a key is about.
    """
    if not body.remove:
        return
    anatomy = assemble(body.hands, body.chest_joint, "published", body.extra or ())
    left = parts_left(body)
    for name in body.parts:
        if name not in left:
            _refuse(("body", "parts", name), f"'{name}' is removed, so it has no size")
    for key in body.measurements:
        sides = [side for side in SIDES if key.startswith(f"{side}_")] or ["", *SIDES]
        measured = (
            (side, part) for side, part in anatomy.parts if part.name.format(side=side) in left and side in sides
        )
        if unsided(key) in anatomy.follows - replace(anatomy, parts=tuple(measured)).follows:
            _refuse(("body", "measurements", key), "all that follows this is removed")
    for path, names in groups.items():
        for index, name in enumerate(names):
            if single_groups([name]) and not single_groups([name]) & set(left.values()):
                key = name if path[-1] == "strength" else index
                _refuse((*path, key), f"all of '{name}' is removed")


def _refuse(key: KeyPath, what: str) -> None:
    raise KeyedError(key, f"{what}; leave this out, or keep the part", against=("body", "remove"))


def at_another_age(
    body: BodySpec, before_months: float, after_months: Any, months_early: float = 0.0
) -> dict[str, Any]:
    """Return what changes in a body when its child has another age: sections with new values by key, None to remove.

    An individual keeps its percentiles: a measured length, weight or head becomes what a child with the same z-score by
    WHO's standards has then, z(after) = z(before). A single measurement keeps its ratio to the average child's.
    Ages are corrected of children born *months_early* before term. Percentiles and factors stay as they are. What is
    said twice is said once from then on: the individual's measure
    counts, not its percentile, nor the measurement of the same size. Where the other age is none, nothing changes:
    validation says why.
    """
    if not _is_age(before_months) or not _is_age(after_months):
        return {}
    if rounded(float(after_months)) == rounded(before_months):  # Ages in manifests are rounded.
        return {}
    before_months, after_months = (max(0.0, float(months) - months_early) for months in (before_months, after_months))
    changes: dict[str, Any] = {}
    if body.individual and (grown := grown_individual(body.individual, before_months, after_months)):
        changes["individual"] = grown
    if body.measurements:
        changes["measurements"] = _grown_measurements(body, before_months, after_months)
    return changes


def grown_individual(individual: IndividualSpec, before_months: float, after_months: float) -> dict[str, float | None]:
    """Return what changes of an individual at another age: its measures, and None for percentiles that repeat them."""
    from mimoc.fits import load_tables, standards  # Bundles are opened without tables of growth.

    grown: dict[str, float | None] = {}
    if individual.fat_percent is not None:
        z = standards.fat_z_score(individual.fat_percent, before_months)
        grown["fat_percent"] = rounded(max(standards.fat_percent(z, after_months), standards.MIN_FAT_PERCENT))
    for key, percentile in INDICATORS.items():
        value = getattr(individual, key)
        standard = load_tables().who[key]
        reference = individual.sex or "mean"
        if value is not None:
            z = standard.z_score(value, before_months, reference)
            grown[key] = rounded(standard.value(z, after_months, reference))
            grown |= {percentile: None} if getattr(individual, percentile) is not None else {}
    return grown


def _grown_measurements(body: BodySpec, before_months: float, after_months: float) -> dict[str, float | None]:
    """Return measurements at another age; None for those that repeat what the individual says."""
    from mimoc.fits import measure

    before, after = measure(before_months), measure(after_months)
    grown: dict[str, float | None] = {}
    for key, value_cm in body.measurements.items():
        name = unsided(key)
        grown[key] = rounded(value_cm * after[name] / before[name])
    for earlier, later, _ in pairs(body, before_months):
        if earlier.path[1] == "individual" and later.path[1] == "measurements":
            grown[str(later.path[-1])] = None
    return grown


def _is_age(months: Any) -> bool:
    return isinstance(months, int | float) and not isinstance(months, bool) and 0 <= months <= LAST_MONTH


def healthy(spec: InfantSpec) -> InfantSpec:
    """Return the same child without impairments, of the same age, and at the same percentiles if it was born early.

    Raises:
        SpecError: If there is no such child.

    Example:
        >>> import mimoc
        >>> from mimoc.schema.infant import healthy
        >>> spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=6, impairments={"gestation_weeks": 32})
        >>> healthy(spec).impairments is None, healthy(spec).age_months
        (True, 6.0)
    """
    if spec.impairments is None:
        return spec
    grown = at_another_age(spec.body, spec.corrected_age_months, spec.age_months)
    return spec.with_(impairments=None, **({"body": grown} if grown else {}))


def read_spec(source: Source) -> InfantSpec:
    """Return the spec in a file; a SpecError lists all problems."""
    if "infants" in source.data:
        message = "this file describes a world with several infants, and one is wanted here; see docs/two_infants.md"
        raise SpecError([source.problem(("infants",), message, at="key")])
    return read_keys(InfantSpec, source)


def to_data(spec: InfantSpec) -> dict[str, Any]:
    """Return a spec as plain data with all defaults filled in, from which an equal spec can be read.

    Keys without a value, such as a sense that is off, are omitted.
    """
    return spec.model_dump(mode="json", exclude_none=True)


def validated(spec: InfantSpec) -> InfantSpec:
    """Return a spec after validation, which `model_copy` and `model_construct` omit; a SpecError lists all problems."""
    if spec.is_as_read:
        return spec
    reading = read_spec(in_memory(everything(spec), _name(spec), _folder(spec)))
    return spec if reading == spec else _checked(InfantSpec, given(spec), spec)


def as_written(spec: InfantSpec) -> Source:
    """Return the file a spec was read from, or an equivalent text if it was created or changed in Python."""
    if spec.source and _says(spec.source, spec):
        return spec.source
    return in_memory_as_text(given(spec), _name(spec), _folder(spec))


def _checked(kind: type[Any], data: dict[str, Any], before: InfantSpec) -> Any:
    """Return the spec with the given data, which is validated before it is written: YAML cannot express all of it."""
    place = _name(before), _folder(before)
    read_keys(kind, in_memory(data, *place))
    return read_keys(kind, in_memory_as_text(data, *place))


def _says(source: Source, spec: InfantSpec) -> bool:
    """Return whether a file still describes the spec that was read from it."""
    return spec.is_as_read or read_spec(source) == spec


def _name(spec: InfantSpec) -> str:
    return f"<{spec.__dict__.get('name', 'spec')}>"


def _folder(spec: InfantSpec) -> Path:
    return spec.source.folder if spec.source else Path()


load_plugins()


SPEC_SUFFIXES = (".yaml", ".yml")


@takes("the path of a spec", *PATH)
def load_spec(path: str | Path) -> InfantSpec:
    """Return the spec in a YAML file.

    Raises:
        SpecError: If the spec is invalid; the error lists all problems. If there is no such file, and one of the
            examples that come with mimoc has its name, the error says how to write it.

    Example:
        >>> import mimoc
        >>> spec = mimoc.load_spec("nine_months.yaml")
        >>> spec.name, spec.age_months, spec.scene.pose
        ('nine_months', 9.0, 'sitting')
    """
    path = Path(path)
    if not os.path.exists(path) and path.stem in example_specs():  # A path's own method fails where it is too long.
        message = f"the file does not exist; write this example with: mimoc new {path.name} --like {path.stem}"
        raise SpecError([Problem(str(path), 1, 1, "", message)])
    return read_spec(source.read(path))


def example_specs() -> dict[str, Path]:
    """Return the specs that come with mimoc, by name: those in `configs/`."""
    package = Path(__file__).resolve().parents[1]
    folders = (package / "configs", package.parent / "configs")
    return {path.stem: path for folder in folders for path in sorted(folder.glob("*.yaml"))}
