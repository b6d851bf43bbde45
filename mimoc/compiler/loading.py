"""Reading specs from files."""

from pathlib import Path

from mimoc.schema import source
from mimoc.schema.infant import InfantSpec, read_spec

SPEC_SUFFIXES = (".yaml", ".yml")


def load_spec(path: str | Path) -> InfantSpec:
    """Return the spec that a YAML file holds.

    Raises:
        SpecError: If anything is wrong with it, with all that is.
    """
    return read_spec(source.read(path))
