"""What `run.json` in the folder of a training run contains, which anyone may have written."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from mimoc.errors import MimocError
from mimoc.schema.base import Model
from mimoc.schema.bounded import Plain, bounded
from mimoc.training.settings import Settings


def _possible(settings: Settings) -> Settings:
    """Return settings that a training can have."""
    try:
        Settings.choose(**bounded(settings.data()))
    except MimocError as error:
        raise ValueError(str(error)) from None
    return settings


class RunFile(Model):
    """A training run: what its result depends on, and what it was done with."""

    run: Literal[1]
    """Version of this kind of file."""
    command: str = ""
    """Command that trains another infant with these settings."""
    settings: Annotated[Settings, AfterValidator(_possible)]
    bundle: str
    """Digest of the lock of its infant."""
    sessions: tuple[Mapping[str, str], ...]
    """Versions of the software of each session with other ones than the session before."""
    origin: Mapping[str, Plain] = Field(default_factory=dict)
    """What the run belongs to, such as the name of a cohort and of a job."""
