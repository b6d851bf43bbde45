"""Builds the set of toys that come with mimoc."""

from pathlib import Path

from mimoc.errors import UnknownToysError, suggestion
from mimoc.toys.builtin.library import BUILTIN
from mimoc.toys.choosing import Toybox
from mimoc.toys.spec import ToysSpec

BUILTIN_TOYS = Toybox(tuple(BUILTIN), lambda name: BUILTIN[name]())


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the built-in toys that a spec selects.

    Raises:
        UnknownToysError: If some of the selected names do not exist.
    """
    unknown = [name for name in spec.subset if name not in BUILTIN]
    if unknown:
        advice = {name: suggestion(name, BUILTIN_TOYS.names) for name in unknown}
        raise UnknownToysError({name: f"'{name}' is not one of mimoc's toys; {advice[name]}" for name in unknown})
    return Toybox(tuple(sorted(spec.subset)) or BUILTIN_TOYS.names, BUILTIN_TOYS.load)
