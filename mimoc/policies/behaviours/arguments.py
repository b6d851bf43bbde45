"""The argument of a behaviour: words and places, then numbers by name, as in `toy, right, speed_m_s=0.3`."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.base.errors import PolicyError, check_name

SEPARATOR = re.compile(r",(?![^(]*\))")


@dataclass(frozen=True, slots=True)
class Option:
    """A number that can be given by its name."""

    default: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Arguments:
    """The arguments of a behaviour."""

    words: tuple[str, ...]
    """What has no name, such as a target and a side; a place is one word, `(0.3, 0, 0.2)`."""
    numbers: Mapping[str, float]
    """All options by their names, with their defaults where none is given."""


def read_arguments(behaviour: str, text: str, options: Mapping[str, Option], most_words: int = 0) -> Arguments:
    """Return the arguments in a text, or raise a PolicyError or, for an option, an UnknownNameError."""
    words, numbers = list[str](), {name: option.default for name, option in options.items()}
    # Three bare numbers at the beginning get parentheses.
    number = r"\s*[-+]?\d*\.?\d+\s*"
    for piece in filter(
        None, map(str.strip, SEPARATOR.split(re.sub(rf"^({number},{number},{number})(?=,|$)", r"(\1)", text)))
    ):
        name, sign, value = map(str.strip, piece.partition("="))
        if not sign:
            words.append(piece)
            continue
        check_name(f"setting of '{behaviour}'", name, options)
        numbers[name] = _number(behaviour, name, value, options[name])
    if len(words) > most_words:
        raise PolicyError(f"'{behaviour}' does not take '{words[most_words]}'; {_usage(options)}")
    return Arguments(tuple(words), numbers)


def place_of(word: str) -> tuple[float, float, float] | None:
    """Return the place that a word is, [m]; None if it is none."""
    if not (word.startswith("(") and word.endswith(")")):
        return None
    try:
        x, y, z = map(float, word[1:-1].split(","))
    except ValueError:
        x = y = z = math.nan
    if not math.isfinite(x + y + z):
        raise PolicyError(f"'{word}' is no place; give x, y and z in metres, such as (0.3, 0, 0.2)")
    return x, y, z


def _number(behaviour: str, name: str, value: str, option: Option) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not option.low <= number <= option.high:
        bounds = f"a number from {option.low:g} to {option.high:g}"
        raise PolicyError(f"'{behaviour}': {name}={value} is not possible; give {bounds}")
    return number


def _usage(options: Mapping[str, Option]) -> str:
    if not options:
        return "it takes no more"
    return f"it takes {', '.join(f'{name}={option.default:g}' for name, option in options.items())}"
