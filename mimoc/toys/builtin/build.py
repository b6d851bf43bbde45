"""The toys that come with mimoc, to choose from."""

from pathlib import Path

from mimoc.errors import UnknownToysError, suggestion
from mimoc.toys.builtin.library import BUILTIN
from mimoc.toys.choosing import Toybox
from mimoc.toys.spec import ToysSpec

BUILTIN_TOYS = Toybox(tuple(BUILTIN), lambda name: BUILTIN[name]())


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the toys that a spec wants of these.

    Raises:
        UnknownToysError: If there are none of some names.
    """
    unknown = [name for name in spec.subset if name not in BUILTIN]
    if unknown:
        advice = {name: suggestion(name, BUILTIN_TOYS.names) for name in unknown}
        raise UnknownToysError({name: f"'{name}' is not among mimoc's toys; {advice[name]}" for name in unknown})
    return Toybox(tuple(sorted(spec.subset)) or BUILTIN_TOYS.names, BUILTIN_TOYS.load)
