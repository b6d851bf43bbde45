"""The errors of mimoc: each says where the problem is, what is wrong and what to do."""

import os
import sys
import traceback
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches

_MAX_NAMES = 40  # Largest number of names that an error lists when none is similar.


class MimocError(Exception):
    """Base class of all errors that mimoc reports to its users.

    Example:
        >>> import mimoc
        >>> try:
        ...     mimoc.build("nine_month.yaml")
        ... except mimoc.MimocError as error:
        ...     print(error)
        nine_month.yaml:1:1: the file does not exist; check the path
    """


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """One problem in one place of a spec."""

    file: str
    line: int  # Line number from 1; 0 if there are no lines, as in a spec created in Python.
    column: int
    key: str  # Dotted path of the key; empty if the problem concerns the whole file.
    message: str  # What is wrong, and what to do.

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        return f"{place}: {self.key + ': ' if self.key else ''}{self.message}"


class SpecError(MimocError):
    """A spec cannot be built; the error lists every problem found in it.

    Example:
        >>> import mimoc
        >>> from mimoc.base.errors import SpecError
        >>> try:
        ...     mimoc.load_spec("nine_months.yaml").with_(age_month=10)
        ... except SpecError as error:
        ...     print(error.problems[0].key, "-", error.problems[0].message)
        age_month - unknown key; did you mean 'age_months'?
    """

    def __init__(self, problems: Iterable[Problem]):
        self.problems = tuple(sorted(set(problems)))
        super().__init__("\n".join(map(str, self.problems)))


class GeometryError(MimocError):
    """No body can have the given measurements."""


class IndividualError(MimocError):
    """No child matches the requested measures."""


class ContractureError(MimocError):
    """A contracture leaves nothing of the range of a joint."""

    def __init__(self, movement: str, message: str):
        super().__init__(message)
        self.movement = movement
        """Name of the joint's movement in the spec."""


class NoSpaceError(MimocError):
    """There is not enough space for the toys in the scene."""


class ObjectError(MimocError):
    """An object of the spec cannot be built, or cannot be where it is to be."""

    def __init__(self, key: str, message: str, number: int = 0):
        super().__init__(message)
        self.number = number
        """Its number in the spec, from 0."""
        self.key = key
        """Its key that is to blame."""


class UnsupportedTaskError(MimocError):
    """A task, or a constraint of the scene, cannot be realised with the body of the spec."""

    def __init__(self, message: str, key: tuple[str, ...] = ("task", "kind")):
        super().__init__(message)
        self.key = key
        """Key of the spec that requires it."""


class DataError(MimocError):
    """A data table of mimoc is missing or damaged."""


class KindError(MimocError):
    """A sense, task or other kind cannot be registered or used."""


class BundleError(MimocError):
    """A folder is not a bundle, or its files were modified."""


class TextureError(MimocError):
    """A user's images cannot be used as textures."""


class ModelError(MimocError):
    """MuJoCo rejects a compiled model."""

    def __init__(self, message: str, element: str | None = None):
        super().__init__(message)
        self.element = element
        """Name of the rejected element, if MuJoCo gives one."""


class RenderingError(MimocError):
    """Images cannot be rendered on this machine."""


class ToyError(MimocError):
    """A toy, or the folder with its data, cannot be found or used."""

    def __init__(self, message: str, name: str | None = None):
        super().__init__(message)
        self.name = name
        """Name of the object or category, if the problem concerns one."""


class UnknownToysError(ToyError):
    """Requested toys do not exist in the source."""

    def __init__(self, messages: Mapping[str, str]):
        super().__init__("\n".join(messages.values()))
        self.messages = messages
        """Error message of each name."""


class TrainingError(MimocError):
    """A training run cannot be started or resumed."""


class PolicyError(MimocError):
    """A file is not a trained policy, or the policy does not fit the infant."""


class ControlError(MimocError):
    """A controller cannot do what it is asked to do."""


class OutputError(MimocError):
    """A file cannot be written."""


class RecordingError(MimocError):
    """A recording cannot be made, read or replayed."""


class MovementError(MimocError):
    """A recording of points whose movement cannot be measured, or a sample that it cannot be compared with."""


class MissingExtraError(MimocError):
    """An optional dependency is not installed."""

    def __init__(self, library: str, extra: str):
        super().__init__(f"{library} is not installed; run: pip install 'mimoc[{extra}]'")


class UnknownNameError(MimocError):
    """A name is unknown; the error suggests similar ones."""

    def __init__(self, kind: str, name: object, known: Collection[str]):
        text = f"'{name}'" if isinstance(name, str) else f"{name!r:.60}"
        super().__init__(f"{text} is not a {kind}; {suggestion(str(name), known)}")


def check_name(kind: str, name: object, known: Collection[str]) -> None:
    """Raise an UnknownNameError unless something is one of the known names of a kind."""
    if not isinstance(name, str) or name not in known:
        raise UnknownNameError(kind, name, known)


def problem_of_loading_mujoco(error: Exception) -> str:
    """Return what to do about an error that ended the first import of MuJoCo because of `MUJOCO_GL`; "" if it did not.

    MuJoCo loads the OpenGL that this variable names, and fails with an error of PyOpenGL's where there is none.
    """
    backend = os.environ.get("MUJOCO_GL")
    modules = [frame.f_globals.get("__name__") for frame, _ in traceback.walk_tb(error.__traceback__)]
    if backend is None or "mujoco" not in modules or "mujoco" in sys.modules:
        return ""
    return (
        f"MuJoCo cannot be loaded with MUJOCO_GL={backend} ({error}); unset it, choose egl or osmesa, or install what "
        "is missing (Debian: apt-get install libegl1, or libosmesa6)"
    )


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: `1 job`, `1,000 jobs`."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def suggestion(name: str, known: Collection[str]) -> str:
    """Return the advice of an error message: the *known* names that *name* may be a misspelling of."""
    near = get_close_matches(name, known, n=3, cutoff=0.6)
    if near:
        alternatives = " or ".join(f"'{name}'" for name in near)
        return f"did you mean {alternatives}?"
    names = sorted(known)
    shown = names if len(names) <= _MAX_NAMES else [*names[:_MAX_NAMES], f"... ({len(names)} in all)"]
    return f"choose from {', '.join(shown)}"
