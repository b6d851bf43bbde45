"""What mimoc uses of submitit, so that types can be checked where it is not installed."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from submitit import core as core

class Job:
    job_id: str

class SlurmExecutor:
    def __init__(self, folder: Path) -> None: ...
    def update_parameters(self, **parameters: Any) -> None: ...
    def map_array(self, function: Callable[..., Any], *arguments: Iterable[Any]) -> list[Job]: ...
