"""What can go wrong, said so that a user knows where and what to do."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

_MOST_NAMES = 40
"""As many names as an error lists when none is near."""


class MimocError(Exception):
    """Base of every error a user of mimoc is meant to see."""


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """One thing wrong in one place of a spec."""

    file: str
    line: int
    """From 1; 0 where there are no lines to look at, as of a spec that was made in Python."""
    column: int
    key: str
    """Dotted path of the key, or empty where the whole file is meant."""
    message: str
    """What is wrong; what to do."""

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        return f"{place}: {self.key + ': ' if self.key else ''}{self.message}"


class SpecError(MimocError):
    """A spec that cannot be built, with every problem found in it."""

    def __init__(self, problems: Iterable[Problem]):
        self.problems = tuple(sorted(set(problems)))
        super().__init__("\n".join(map(str, self.problems)))


class GeometryError(MimocError):
    """Measurements that no body can have."""


class IndividualError(MimocError):
    """No child matches the requested measures."""


class NoRoomError(MimocError):
    """Toys that have no place."""


class UnplayableError(MimocError):
    """A spec that asks of an infant what it has no limbs or no world for."""

    def __init__(self, message: str, key: tuple[str, ...] = ("task", "kind")):
        super().__init__(message)
        self.key = key
        """Of the spec, what asks for it."""


class DataError(MimocError):
    """A table that came with mimoc is missing or damaged."""


class BundleError(MimocError):
    """A folder that is not a bundle, or not the one that was written."""


class TextureError(MimocError):
    """Pictures of a user's own that a room cannot be decorated with."""


class ModelError(MimocError):
    """MuJoCo refuses a compiled model."""

    def __init__(self, message: str, element: str | None = None):
        super().__init__(message)
        self.element = element
        """Name of the element that it refuses, if it says so."""


class RenderingError(MimocError):
    """Pictures cannot be drawn here."""


class ToyError(MimocError):
    """A toy that cannot be had, or no folder to have it from."""

    def __init__(self, message: str, name: str | None = None):
        super().__init__(message)
        self.name = name
        """Of the object or category, if one is meant."""


class TrainingError(MimocError):
    """A training that cannot be begun or gone on with."""


class PolicyError(MimocError):
    """A file that is no trained policy, or the policy of another infant."""


class ControlError(MimocError):
    """A controller is asked for what it cannot do."""


class OutputError(MimocError):
    """A file cannot be written."""


class MissingExtraError(MimocError):
    """An optional dependency is not installed."""

    def __init__(self, library: str, extra: str):
        super().__init__(f"{library} is not installed; run: pip install 'mimoc[{extra}]'")


class UnknownNameError(MimocError):
    """A name that is not in the table it was looked up in."""

    def __init__(self, kind: str, name: str, known: Collection[str]):
        super().__init__(f"'{name}' is not a {kind}; {suggestion(name, known)}")


def suggestion(name: str, known: Collection[str]) -> str:
    """Return advice on which of *known* was meant by *name*, as the second half of a message."""
    near = get_close_matches(name, known, n=3, cutoff=0.6)
    if near:
        return f"did you mean {_alternatives(near)}?"
    names = sorted(known)
    shown = names if len(names) <= _MOST_NAMES else [*names[:_MOST_NAMES], f"... ({len(names)} in all)"]
    return f"choose from {', '.join(shown)}"


def _alternatives(names: Sequence[str]) -> str:
    return " or ".join(f"'{name}'" for name in names)
