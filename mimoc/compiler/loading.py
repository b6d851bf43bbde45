"""Reading specs from files."""

from pathlib import Path

from mimoc.schema import source
from mimoc.schema.infant import InfantSpec, read_spec

SPEC_SUFFIXES = (".yaml", ".yml")


def load_spec(path: str | Path) -> InfantSpec:
    """Return the spec in a YAML file.

    Raises:
        SpecError: If the spec is invalid; the error lists all problems.
    """
    return read_spec(source.read(path))
