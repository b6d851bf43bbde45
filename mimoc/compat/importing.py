"""Conversion of other systems' configurations into specs."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from mimoc.base.errors import UnknownNameError
from mimoc.compat.import_babybench import import_babybench
from mimoc.compat.import_mimo import import_mimo
from mimoc.compat.settings import Imported

IMPORTERS: Mapping[str, Callable[[str | Path], Imported]] = MappingProxyType(
    {"babybench": import_babybench, "mimo": import_mimo}
)
"""Function that converts the configuration of each system."""


def import_config(system: str, path: str | Path) -> Imported:
    """Convert another system's configuration, a key of `IMPORTERS`, into a spec; a SpecError lists all problems."""
    if system not in IMPORTERS:
        raise UnknownNameError("format to import from", system, IMPORTERS)
    return IMPORTERS[system](path)
