"""A spec to begin with: what was chosen, what else may be said, and what it means."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mimoc.schema.base import KeyPath
from mimoc.schema.body import LooksSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.outline import Language, language_of
from mimoc.schema.source import dump

COLUMN = 40  # Where comments begin.


@dataclass(frozen=True)
class Choices:
    """What a new spec says."""

    name: str = "infant"
    age_months: float = 9
    hands: str = "mitten"
    actuation: str = "torque"
    senses: Sequence[str] = ("proprioception", "vestibular")
    scene: str = "flat"
    pose: str = "supine"
    held: str | None = None  # A body that somebody holds where it is.
    task: str | None = None
    impairment: str | None = None  # A preset of the impairments.
    side: str | None = None  # Its side, if it has one.


def offered() -> dict[str, Sequence[str]]:
    """Return what can be chosen, by the field of `Choices`."""
    language = language_of(InfantSpec)
    return {
        "hands": language.outline(("body", "hands")).choices,
        "actuation": language.outline(("actuation", "model")).choices,
        "senses": tuple(language.outline(("senses",)).keys),
        "scene": language.outline(("scene", "kind")).choices,
        "pose": language.outline(("scene", "pose")).choices,
        "impairment": [name for name in language.outline(("impairments", "preset")).choices if name != "none"],
        "side": language.outline(("impairments", "side")).choices,
        "task": [name for name in language.kinds_of(("task",)) if name != "free"],
    }


def new_spec(choices: Choices, schema: Path | None = None) -> str:
    """Return the text of a spec, in which comments say what else each key may be.

    Whether its choices are possible shows when it is read. Editors are to use the schema.
    """
    lines = [*with_schema("", schema).splitlines(), *_lines(choices, language_of(InfantSpec))]
    return "\n".join(lines) + "\n"


def with_schema(text: str, schema: Path | None) -> str:
    """Return the text of a spec with a first line that tells editors which JSON Schema it follows."""
    return f"# yaml-language-server: $schema={schema}\n{text}" if schema else text


def _lines(choices: Choices, language: Language) -> Iterator[str]:
    def said(key: str, value: object, path: KeyPath, margin: str = "  ") -> str:
        return _beside(margin + _line(key, value), _or(language.outline(path).choices))

    yield "mimoc: 1"
    yield _line("name", choices.name)
    yield _beside(_line("age_months", choices.age_months), "0 to 24")
    yield from ("", "body:", said("hands", choices.hands, ("body", "hands")))
    individual = "individual: {sex: female, length_percentile: 50, weight_percentile: 50}"
    yield _beside(f"  # {individual}", "a child of WHO's percentiles")
    looks = LooksSpec()
    colours = f"looks: {{skin: {looks.skin}, hair: {looks.hair}, eyes: {looks.eyes}}}"
    yield _beside(f"  # {colours}", "and clothes: " + _or(language.outline(("body", "looks", "clothes")).choices))
    preset = {"preset": choices.impairment, "side": choices.side}
    given = ", ".join(f"{key}: {value}" for key, value in preset.items() if value is not None)
    impairments = f"impairments: {{{given}}}" if given else "# impairments: {preset: hemiparesis, side: right}"
    yield from ("", _beside(impairments, _or(offered()["impairment"])))
    yield from ("", "actuation:", said("model", choices.actuation, ("actuation", "model")))
    yield from ("", _beside("senses:" if choices.senses else "senses: {}", "one that is not listed is off"))
    for name in dict.fromkeys((*choices.senses, *language.outline(("senses",)).keys)):
        yield _beside(f"  {'' if name in choices.senses else '# '}{name}: {{}}", _about(language, ("senses", name)))
    presets = language.outline(("delays", "preset")).choices
    yield from ("", _beside("# delays: {preset: physiological}", f"preset: {_or(presets)}"))
    yield from ("", "scene:", said("kind", choices.scene, ("scene", "kind")))
    yield said("pose", choices.pose, ("scene", "pose"))
    yield _beside(f"  {'' if choices.held else '# '}held: [{choices.held or 'chest'}]", "what somebody holds")
    tasks = offered()["task"]
    yield from ("", _beside(f"{'' if choices.task else '# '}task: {{kind: {choices.task or tasks[0]}}}", _or(tasks)))


def _beside(line: str, comment: str) -> str:
    return f"{line:<{COLUMN}}  # {comment}" if comment else line


def _or(words: Sequence[object]) -> str:
    *most, last = map(str, words)
    return f"{', '.join(most)} or {last}" if most else last


def _about(language: Language, path: KeyPath) -> str:
    return " ".join(language.outline(path).schema.get("description", "").split()).partition(". ")[0].removesuffix(".")


def _line(key: str, value: object) -> str:
    return dump({key: value}).rstrip()
