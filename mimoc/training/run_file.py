"""What `run.json` in the folder of a training run contains, which anyone may have written."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from mimoc.bundle.json_files import one_line, read_json_file
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.errors import MimocError
from mimoc.schema.base import Model
from mimoc.schema.bounded import Plain, bounded
from mimoc.training.settings import Settings


class RunFile(Model):
    """A training run: what its result depends on, and what it was done with."""

    run: Literal[1]
    """Version of this kind of file."""
    command: str = ""
    """Command that trains another infant with these settings."""
    settings: Settings
    bundle: str
    """Digest of the lock of its infant."""
    sessions: tuple[Mapping[str, str], ...]
    """Versions of the software of each session with other ones than the session before."""
    origin: Mapping[str, Plain] | None = None
    """What the run belongs to, such as the name of a cohort and of a job."""


def read_run_file(path: Path) -> RunFile | None:
    """Return what is in a file, None if it does not exist or cannot be read.

    Raises:
        UnusableFileError: If it is not a regular file, too large, or describes what no training can be.
    """
    run = read_json_file(path, RunFile)
    try:
        if run is not None:
            Settings.choose(**bounded(run.settings.data()))
    except (ValueError, MimocError) as error:
        raise UnusableFileError(one_line(f"settings: {error}")) from None
    return run
