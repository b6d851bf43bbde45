"""Validation of the data of a YAML file: returns the spec, or reports all problems at once, each with what to do."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import takewhile
from typing import Any, Literal, TypeVar

from pydantic import PrivateAttr, ValidationError
from pydantic_core import ErrorDetails

from mimoc.base.errors import SpecError, suggestion
from mimoc.schema.base import KeyedError, KeyPath, Model, dotted, shown
from mimoc.schema.outline import Language, Outline, language_of
from mimoc.schema.source import Source

Spec = TypeVar("Spec", bound=Model)


class FileModel(Model):
    """What a file says; it knows the file that it was read from."""

    _source: Source | None = PrivateAttr(default=None)

    @property
    def source(self) -> Source | None:
        """The file this was read from, or None if it was created in Python."""
        return self._source

    def model_post_init(self, context: Any) -> None:
        """Store the source, which is passed as the context of validation."""
        if isinstance(context, Source):
            self._source = context


def read_keys(keys: type[Spec], source: Source) -> Spec:
    """Return the spec, or another kind of file, that the class *keys* describes.

    Invalid values are reported and removed, and the rest is validated again, because pydantic runs the validators of
    a section only once each of its keys is valid.

    Raises:
        SpecError: If the spec is invalid; the error lists all problems.
    """
    language = language_of(keys)
    empty = (path for path in _empty(source.data, language) if path not in source.invalid)
    faults = {path: missing_value(path, language) for path in empty}
    data = _repaired(source.data, {*source.invalid, *faults}, language)
    spec = None
    while spec is None:
        try:
            spec = keys.model_validate(data, context=source)
        except ValidationError as error:
            latest = [fault(details, data, language) for details in error.errors(include_url=False)]
            known = {path[:depth] for path in {*source.invalid, *faults} for depth in range(len(path) + 1)}
            faults |= {new.path: new for new in reversed(latest) if not {new.path, new.against or new.path} & known}
            before = data
            data = _repaired(data, {new.path for new in latest}, language)
            if data == before:
                break
    if spec is None or source.problems or faults:
        reported = (source.problem(wrong.path, wrong.message, at=wrong.at) for wrong in faults.values())
        raise SpecError([*source.problems, *reported])
    return spec


def _empty(value: Any, language: Language, path: KeyPath = ()) -> Iterator[KeyPath]:
    """Yield the paths of all known keys and items without a value."""
    if value is None and language.is_known(path):
        yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for step, item in items:
        yield from _empty(item, language, (*path, step))


def _repaired(data: dict[str, Any], paths: set[KeyPath], language: Language) -> dict[str, Any]:
    """Return data without the values at some paths, or with examples in their place where a key is required."""
    for keys in sorted({_keys(path) for path in paths} - {()}):
        section = keys[:-1]
        if keys[-1] in language.outline(section).schema.get("required", ()):
            data = _replaced(data, keys, language.outline(keys).example)
        elif keys[-1] in _section(data, section):
            data = _replaced(data, keys, None)
        elif section:
            data = _replaced(data, section, None)
    return data


def _keys(path: KeyPath) -> tuple[str, ...]:
    """Return a path up to the first list."""
    return tuple(map(str, takewhile(lambda step: isinstance(step, str), path)))


def _section(data: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else None
    return data if isinstance(data, dict) else {}


def _replaced(data: Any, keys: tuple[str, ...], value: Any) -> Any:
    """Return data with one value replaced, or removed if the new value is None."""
    if not isinstance(data, dict):
        return data
    first, *deeper = keys
    if deeper:
        value = _replaced(data.get(first, {}), tuple(deeper), value)
    rest = {key: item for key, item in data.items() if key != first}
    return rest if value is None else {**rest, first: value}


_UNIT_WORDS = {
    "deg": "degrees",
    "px": "pixels",
    "cpd": "cycles per degree",
    "percentile": "",
    "n": "newtons",
    "hz": "Hz",
    "db": "dB",
}
_UNIT_SUFFIX = re.compile(
    "_(cm|mm|m|in|inch|inches|ft|kg|g|lb|lbs|oz|deg|degrees|rad|ms|s|sec|seconds|hz|days|weeks|months|years|px|pixels|n)$"
)
_WRITTEN_NUMBER = re.compile(r"\s*([-+]?[0-9]+(?:[.,][0-9]+)?)\s*(\D*)")
_MISSPELT = 0.85  # Similarity (`difflib`) from which an unknown key counts as a misspelling of a key of its section.
ONE_OF_SEVERAL = "infant"  # A key of sections in a scene that only worlds with several infants have.
_SYNONYMS = {"girl": "female", "f": "female", "woman": "female", "boy": "male", "m": "male", "man": "male"}
"""Words that users write for a choice that is spelt quite differently."""
_PERCENTILE = re.compile(r"\s*p?\s*([0-9]+(?:\.[0-9]+)?)\s*(?:%|st|nd|rd|th)?(?:\s*percentile)?\s*", re.IGNORECASE)
"""P10, 10th or 10 %."""
_TYPES = {
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
    "string": "text",
    "object": "a section",
    "array": "a list",
}


@dataclass(frozen=True)
class Fault:
    """One error in the data of a spec."""

    path: KeyPath
    at: Literal["key", "value"]
    message: str  # What is wrong; what to do.
    against: KeyPath = ()  # Another key that it contradicts.


def fault(details: ErrorDetails, data: dict[str, Any], language: Language) -> Fault:
    """Return the fault that corresponds to one of pydantic's errors."""
    path, kinds = _path(details, data, language)
    if details["type"] == "value_error":
        error = details.get("ctx", {})["error"]
        if isinstance(error, KeyedError):
            return Fault(path + error.key, "value", str(error), path + error.against if error.against else ())
        return Fault(path, "key" if details["loc"][-1] == "[key]" else "value", str(error))
    if details["type"] == "extra_forbidden":
        kind = str(details["loc"][-2]) if len(details["loc"]) > 1 else ""
        return Fault(path, "key", unknown_key(path, language, kind))
    if details["type"] == "missing" and isinstance(path[-1], str):
        return Fault(path, "key", _missing(path, language))
    if details["type"].startswith("union_tag_") and language.kinds_of(path):
        return _wrong_kind(details, path, language)
    if details["type"] in ("missing", "too_long"):
        path = path[:-1] if details["type"] == "missing" else path
        return Fault(path, "value", _wrong_count(language.outline(path, kinds), details["input"]))
    return Fault(path, "value", _wrong_value(details, language.outline(path, kinds)))


def missing_value(path: KeyPath, language: Language) -> Fault:
    """Return the fault of a key that was written without a value."""
    known = language.outline(path)
    if path[-1] in language.outline(path[:-1]).schema.get("required", ()):
        advice = f"write one, such as {known.example}"
    elif known.type == "object" and known.schema.get("required"):
        advice = "write its keys below it, or leave it out"
    elif known.type == "object":
        advice = "write its keys below it, or {} for all its defaults, or leave it out"
    else:
        advice = "write one, or leave it out"
    return Fault(path, "value", f"has no value; {advice}")


def _path(details: ErrorDetails, data: Any, language: Language) -> tuple[KeyPath, dict[KeyPath, str]]:
    """Return pydantic's location without the steps that are not keys: the tags of unions, and `[key]`; and the tags.

    A tag may be a key of its section as well: `kind: shape` has a key `shape`.
    """
    path, kinds = list[str | int](), dict[KeyPath, str]()
    for step in details["loc"]:
        if tuple(path) not in kinds and step in language.kinds_of(tuple(path)):
            kinds[tuple(path)] = str(step)
            continue
        children: Any = dict(enumerate(data)) if isinstance(data, list) else data if isinstance(data, dict) else {}
        if step in children:
            data = children[step]
            path.append(step)
        elif details["type"] == "missing" and step == details["loc"][-1]:
            path.append(step)
    return tuple(path), kinds


def _missing(path: KeyPath, language: Language) -> str:
    return f"is missing; add it, such as '{path[-1]}: {language.outline(path).example}'"


def _wrong_kind(details: ErrorDetails, section: KeyPath, language: Language) -> Fault:
    """Return the fault of a section whose discriminator, such as `kind`, is missing or wrong."""
    path = (*section, details.get("ctx", {})["discriminator"].strip("'"))
    if details["type"] == "union_tag_not_found":
        return Fault(path, "key", _missing(path, language))
    value = details["input"][path[-1]]
    choices = language.outline(path).choices
    return Fault(path, "value", f"{got(value)} is not a choice; {_nearest(str(value)[:80], choices)}")


def unknown_key(path: KeyPath, language: Language, kind: str = "") -> str:
    """Return the message for an unknown key, in a section that may be one of several kinds."""
    section = path[:-1]
    key = re.sub(r"[\s-]+", "_", str(path[-1])[:80].strip().lower())
    kinds = language.kinds_of(section)
    is_world = "infants" in language.outline(()).keys
    known = [name for name in kinds.get(kind, language.outline(section)).keys if is_world or name != ONE_OF_SEVERAL]
    if not known:
        return "unknown key; this section has no keys, write it as {}"
    if kind in kinds and (others := [name for name, other in kinds.items() if key in other.keys]):
        return f"unknown key of '{kind}'; remove it (it belongs to {', '.join(others)})"
    same = [name for name in known if _UNIT_SUFFIX.sub("", name) == _UNIT_SUFFIX.sub("", key)]
    if same and key not in known:
        return f"unknown key; write '{same[0]}'{_in_unit(language.outline((*section, same[0])))}"
    elsewhere = [] if get_close_matches(key, known, cutoff=_MISSPELT) else language.sections_with(key)
    if elsewhere:
        places = " or ".join(f"under '{dotted(place)}'" if place else "at the top level" for place in elsewhere)
        return f"unknown key here; it belongs {places}"
    return f"unknown key; {suggestion(key, known)}"


def _wrong_count(known: Outline, value: Any) -> str:
    if "prefixItems" not in known.schema:
        most = known.schema.get("maxItems", known.schema.get("maxProperties"))
        return f"expected at most {most} values, got {len(value)}"
    return f"expected {len(known.schema['prefixItems'])} values, got {len(value)}; write {_list_of(known)}"


def _list_of(known: Outline) -> str:
    """Return how a list is written that has so many items."""
    items = known.schema["prefixItems"]
    if items[0].get("type") == "array":
        return f"{len(items)} times [lowest, highest]"
    return "[lowest, highest]" if len(items) == 2 else f"[{', '.join('abcdefgh'[: len(items)])}]"


def _wrong_value(details: ErrorDetails, known: Outline) -> str:
    kind, value = details["type"], got(details["input"])
    match kind:
        case "literal_error":
            return f"{value} is not a choice; {_nearest(str(details['input'])[:80], known.choices)}"
        case "greater_than" | "greater_than_equal":
            return f"{value} is too small; give {_range(known)}"
        case "less_than" | "less_than_equal":
            return f"{value} is too large; give {_range(known)}"
        case "finite_number":
            return f"{value} is not finite; give {_range(known)}"
        case "string_pattern_mismatch":
            return f"{value} is not a name; {_better_name(details['input'])}"
        case "string_too_short":
            return "this is empty; write a text, or remove the key"
        case "too_short" if (least := known.schema.get("minItems", 1)) > 1:
            return f"expected at least {least} values, got {len(details['input'])}"
        case "too_short":
            return "this list is empty; name one or more, or remove the key"
        case "string_too_long":
            return f"{value} is too long; use {known.schema['maxLength']} characters at most"
        case "union_tag_not_found" | "union_tag_invalid":
            return f"{value} is not {known.schema['wanted']}"
    return _wrong_type(details["input"], known)


def _wrong_type(value: Any, known: Outline) -> str:
    wanted = _TYPES[known.type]
    if known.type in ("number", "integer"):
        if known.unit == "percentile" and isinstance(value, str) and (meant := _PERCENTILE.fullmatch(value)):
            return f"{got(value)} is text, not a number; write {meant[1]}"
        written = _WRITTEN_NUMBER.fullmatch(value) if isinstance(value, str) else None
        if written and not written[2]:
            return f"{got(value)} is text, not a number; write {written[1].replace(',', '.')}, without quotes"
        if written:
            return f"{got(value)} is text, not a number; write the bare number{_in_unit(known)}"
        return f"{got(value)} is not {wanted}; give {_range(known)}"
    advice = {
        "boolean": "write true or false",
        "string": "write a word, or put it in quotes",
        "object": f"write its keys below it: {', '.join(known.keys)}" if known.keys else "write its keys below it",
        "array": f"write {_list_of(known)}" if "prefixItems" in known.schema else "write [a, b], or [] for none",
    }
    return f"{got(value)} is not {wanted}; {advice[known.type]}"


def _nearest(word: str, choices: Sequence[str]) -> str:
    meant = _SYNONYMS.get(word.strip().lower())
    return f"did you mean '{meant}'?" if meant in choices else suggestion(word, choices)


def _better_name(name: str) -> str:
    better = re.sub("[^a-z0-9]+", "_", name.lower()).strip("_")[:40]
    return f"write '{better}'" if better[:1].isalpha() else "use a-z, 0-9 and _, and a letter first"


def _range(known: Outline) -> str:
    schema = known.schema
    unit = _UNIT_WORDS.get(known.unit or "", known.unit or "")
    if "minimum" in schema and schema["minimum"] > schema.get("exclusiveMinimum", -math.inf):
        return f"{schema['minimum']:.16g} to {schema['maximum']:.16g} {unit}".strip()
    highest = f"at most {schema['maximum']:g}" if "maximum" in schema else f"less than {schema['exclusiveMaximum']:g}"
    return f"more than {schema['exclusiveMinimum']:g} and {highest} {unit}".strip()


def _in_unit(known: Outline) -> str:
    words = _UNIT_WORDS.get(known.unit or "", known.unit or "")
    return f", in {words}" if words else ""


def got(value: Any) -> str:
    """Return a value as text for a message."""
    if isinstance(value, str):
        return f"'{shown(value)}'"
    if isinstance(value, dict | list):
        return "this section" if isinstance(value, dict) else "this list"
    return shown(str(value).lower())
