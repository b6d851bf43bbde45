"""All keys of a spec, its `control`, and the checks that involve several sections or what the infant does not have."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationInfo, model_validator

from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import suggestion
from mimoc.base.units import to_steps
from mimoc.schema.actuation import ActuationSpec
from mimoc.schema.base import KeyedError, KeyPath, Model, composed
from mimoc.schema.body import BodySpec, Clothes
from mimoc.schema.caregiver import check_times
from mimoc.schema.impairments import ImpairmentsSpec
from mimoc.schema.kinds import ACTUATIONS, SENSES, TASKS
from mimoc.schema.names import SIDES, Development, single_groups, unsided
from mimoc.schema.quantities import Age, Identifier, Milliseconds, version_one
from mimoc.schema.reading import FileModel
from mimoc.schema.scene import SceneSpec, infants_named
from mimoc.schema.senses import DelaysSpec, NoiseSpec, SensesSpec, check_noise
from mimoc.schema.sizes import check_sizes
from mimoc.schema.task import TaskSpec, task_field


def parts_left(body: BodySpec) -> dict[str, str]:
    """Return the parts that an infant has, by name, and the muscle group of each."""
    gone, group_of = set(body.remove), dict[str, str]()
    for side, part in assemble(
        body.hands, body.chest_joint, "published", body.extra or ()
    ).parts:  # Parents come first.
        name, parent = part.name.format(side=side), (part.parent or "").format(side=side)
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
    anatomy, left = assemble(body.hands, body.chest_joint, "published", body.extra or ()), parts_left(body)
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


class ControlSpec(Model):
    """Duration of physics steps and of control steps."""

    step_ms: Annotated[Milliseconds, Field(ge=0.1, le=1000)] = 10.0
    """Duration of a control step, a whole number of physics steps; by default that of the task, or 10 ms."""
    timestep_ms: Annotated[Milliseconds, Field(ge=0.1, le=20)] = 5.0
    """Duration of a physics step."""


@composed(lambda: {"task": task_field()})
class InfantKeys(FileModel):
    """All keys of the spec language, and the checks that involve several sections."""

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
        is_noisy = ACTUATIONS[self.actuation.model].command_is_effort  # Of servos, no command can have noise.
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
        actuation, touch = self.actuation, getattr(self.senses, "touch", None)
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
        groups, key = parts_left(self.body), ("senses", "touch", "spacing_cm")
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
        control, key, against = self.control, ("control", "timestep_ms"), ("control", "step_ms")
        if "step_ms" in control.model_fields_set:
            key, against = against, key
        elif self.task:
            against, step_ms = ("task", "kind"), TASKS[self.task.kind].step_ms
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
