"""A spec: reading it from a file, creating it in Python, and changing it, such as to another age of its child."""

import operator
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any, Self

from pydantic import ModelWrapValidatorHandler, PrivateAttr, ValidationError, ValidationInfo, model_validator

from mimoc.base.errors import SpecError
from mimoc.base.rounding import rounded
from mimoc.schema.base import changed, composed, everything, given, plain, shown
from mimoc.schema.body import INDICATORS, BodySpec, IndividualSpec
from mimoc.schema.names import unsided
from mimoc.schema.plugins import load_plugins
from mimoc.schema.reading import read_keys
from mimoc.schema.sizes import pairs
from mimoc.schema.source import Source, in_memory, in_memory_as_text
from mimoc.schema.spec import InfantKeys
from mimoc.schema.task import task_field

OLDEST_MONTHS = 24  # Last age of the growth tables.


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
    from mimoc.fits import fat, load_tables  # Bundles are opened without tables of growth.

    grown: dict[str, float | None] = {}
    if individual.fat_percent is not None:
        z = fat.z_score(individual.fat_percent, before_months)
        grown["fat_percent"] = rounded(max(fat.percent(z, after_months), fat.LEAST_PERCENT))
    for key, percentile in INDICATORS.items():
        value, standard, reference = getattr(individual, key), load_tables().who[key], individual.sex or "mean"
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
    return isinstance(months, int | float) and not isinstance(months, bool) and 0 <= months <= OLDEST_MONTHS


@composed(lambda: {"task": task_field()})
class InfantSpec(InfantKeys):
    """One infant in one scene, as the user specified it: nothing is computed, and omitted keys have their defaults."""

    _as_read: tuple[Any, ...] = PrivateAttr(default=())
    """The values that were read from the source; a changed copy has others."""

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
