"""Configurations of other systems, turned into specs."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from mimoc.errors import UnknownNameError
from mimoc.importers.babybench import import_babybench
from mimoc.importers.imported import Imported

IMPORTERS: Mapping[str, Callable[[str | Path], Imported]] = MappingProxyType({"babybench": import_babybench})
"""What reads the configuration of each system."""


def import_config(system: str, path: str | Path) -> Imported:
    """Return the spec that another system's configuration comes to.

    Args:
        system: A name of `IMPORTERS`.
        path: Of the configuration.

    Raises:
        UnknownNameError: If there is no such system.
        SpecError: If the configuration cannot be read, with everything wrong with it.
    """
    if system not in IMPORTERS:
        raise UnknownNameError("format to import from", system, IMPORTERS)
    return IMPORTERS[system](path)
