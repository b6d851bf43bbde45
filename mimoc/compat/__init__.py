"""MIMo and BabyBench: their models read into specs, and MIMo's environments on mimoc's runtime."""

from pathlib import Path
from typing import TYPE_CHECKING

from mimoc.base.errors import UnknownNameError

if TYPE_CHECKING:
    from mimoc.compat.settings import Imported

SYSTEMS = ("babybench", "mimo")


def import_config(system: str, path: str | Path) -> "Imported":
    """Convert another system's configuration, one of `SYSTEMS`, into a spec; a SpecError lists all problems."""
    if system not in SYSTEMS:
        raise UnknownNameError("format to import from", system, SYSTEMS)
    if system == "babybench":
        from mimoc.compat.babybench import import_babybench

        return import_babybench(path)
    from mimoc.compat.import_mimo import import_mimo

    return import_mimo(path)
