"""Terms: what is measured or judged of infants, written once and run on one infant, on many, and on a device.

A term is a frozen dataclass whose `__call__` is one expression over arrays with a leading axis of k infants:

    @dataclass(frozen=True)
    class Height(Term):
        head: np.ndarray        # Whole numbers are addresses: where to look, the same for all infants of a batch.
        length_m: np.ndarray    # Real numbers are amounts: how much, with a row for each infant.

        def __call__(self, worlds):
            return worlds.xp.take(worlds.xpos, self.head, axis=1)[..., 2] / self.length_m

What an author writes, and binds to a model, is the term of one infant: `Height(np.array([3]), np.array([0.7]))`. Before
it runs, `stack_terms` gives its amounts the leading axis, for one infant as for many:

    field       of one infant    of k infants, as `__call__` sees it
    head        (1,)             (1,)      on a device: torch's int64 there
    length_m    (1,)             (k, 1)    on a device: torch's float32 there

A term may not branch on values, make shapes depend on them, or multiply matrices (`@`, `einsum`) over the axis of
infants, whose bits differ with k. So one infant equals row i of many to the bit, and nothing waits for a device.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, TypeVar

import numpy as np
import numpy.typing as npt

from mimoc.runtime.worlds import Worlds

Put = Callable[[np.ndarray], Any]  # Converts NumPy's array to that of the library in which a term runs.


@dataclass(frozen=True)
class Term:
    """A base for terms; a field can also be a term, or a tuple of terms.

    `term(worlds, ...)` returns what is measured of k infants, an array of shape (k, ...), or what a kind asks of its
    terms; what else a kind gives them has a leading axis of k, too.

    Example:
        >>> import mimoc
        >>> from dataclasses import dataclass
        >>> import numpy as np
        >>> from mimoc.plugin import check_term
        >>> @dataclass(frozen=True)
        ... class Height(mimoc.Term):
        ...     head: np.ndarray
        ...     def __call__(self, worlds):
        ...         return worlds.xp.take(worlds.xpos, self.head, axis=1)[..., 2]
        >>> env = mimoc.make("nine_months.yaml").unwrapped
        >>> check_term(Height(np.array([env.model.body("head").id])), env.model)
    """

    __call__: ClassVar[Callable[..., Any]]


@dataclass(frozen=True)
class Field(Term):
    """Some numbers of a field of `MjData` that has one axis, shape (k, n)."""

    name: str
    """Name of the field, such as `qpos`."""
    addresses: npt.NDArray[np.intp]
    """Which of its numbers, shape (n,)."""

    def __call__(self, worlds: Worlds) -> Any:
        """Return the numbers now."""
        return worlds.xp.take(getattr(worlds, self.name), self.addresses, axis=1)


@dataclass(frozen=True)
class Concatenated(Term):
    """What some terms measure, one after the other along the last axis."""

    terms: tuple[Term, ...]

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return the numbers of all terms, shape (k, n)."""
        return worlds.xp.concat([term(worlds, *args) for term in self.terms], axis=-1)


T = TypeVar("T", bound=Term)


def stack_terms(terms: Sequence[T], put: Put = np.asarray) -> T:
    """Return the term of k infants: amounts become rows, converted by *put*; all else is that of the first."""
    first = terms[0]
    return replace(first, **{name: _stacked(values, put) for name, values in _fields(terms).items()})


def take_rows(term: T, rows: Any) -> T:
    """Return a stacked term of NumPy's for some of its infants, by row."""

    def taken(value: Any) -> Any:
        if isinstance(value, Term):
            return take_rows(value, rows)
        if isinstance(value, tuple):
            return tuple(map(taken, value))
        return value[rows] if is_amount(value) else value

    return replace(term, **{field.name: taken(getattr(term, field.name)) for field in fields(term)})


def differing_field(terms: Sequence[Term]) -> str | None:
    """Return a field in which terms differ although they must share it; None if they can be stacked."""
    if len({type(term) for term in terms}) > 1:
        return "kind"
    for name, values in _fields(terms).items():
        nested: list[tuple[Any, ...]] = [value if isinstance(value, tuple) else (value,) for value in values]
        if len({len(items) for items in nested}) > 1:
            return name
        for items in zip(*nested, strict=True):
            if isinstance(items[0], Term):
                if within := differing_field(items):
                    return f"{name}.{within}"
            elif is_amount(items[0]):
                if len({np.shape(item) for item in items}) > 1:
                    return name
            elif any(not np.array_equal(item, items[0]) for item in items):
                return name
    return None


def _fields(terms: Sequence[Term]) -> dict[str, list[Any]]:
    return {field.name: [getattr(term, field.name) for term in terms] for field in fields(terms[0])}


def _stacked(values: Sequence[Any], put: Put) -> Any:
    first = values[0]
    if isinstance(first, Term):
        return stack_terms(values, put)
    if isinstance(first, tuple):
        return tuple(_stacked(items, put) for items in zip(*values, strict=True))
    if is_amount(first):
        return put(np.stack([np.asarray(value, np.float64) for value in values]))
    return put(first) if hasattr(first, "dtype") else first


def is_amount(value: Any) -> bool:
    """Return whether a field is an amount, which differs between infants."""
    dtype: Any = getattr(value, "dtype", None)
    return isinstance(value, float) or (dtype is not None and dtype.kind == "f")
