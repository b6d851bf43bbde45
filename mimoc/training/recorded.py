"""Recording of all episodes of a training, from interval to interval."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

from stable_baselines3.common.vec_env import VecNormalize

from mimoc.bundle.io import Bundle
from mimoc.errors import TrainingError
from mimoc.recording import folder
from mimoc.recording.recorder import Recording
from mimoc.training.settings import Settings


def check_recordable(record: str | Path | None, bundle: Bundle, settings: Settings, processes: bool | None) -> None:
    """Check that a training can be recorded in a folder, if there is one, before anything is written.

    Raises:
        TrainingError: If the environments are not all in one process.
        RecordingError: If the folder holds anything but a recording of these infants.
    """
    if record is None:
        return
    if processes is not None:
        raise TrainingError(
            "a training is recorded with all environments together; leave out --processes and --one-process, or the"
            " recording"
        )
    folder.check_recordable(Path(record).expanduser(), [bundle] * settings.envs)


@contextmanager
def recorded(record: str | Path | None, env: VecNormalize, settings: Settings) -> Iterator[Callable[[int], None]]:
    """Record the infants of a training, if there is a folder for it.

    Yield the function to call at the start of each interval with the control steps before it: what was recorded of the
    interval before its process was killed is replaced, since all of it comes again.
    """
    if record is None:
        yield lambda steps: None
        return
    together: Any = env.unwrapped
    with Recording(together.infants.infants, record) as recording:
        run = _name(settings)
        yield lambda steps: recording.mark(run, steps)


def _name(settings: Settings) -> str:
    """Return a name for all trainings with the same settings, however long they are: their episodes are the same."""
    data = {name: value for name, value in settings.data().items() if name != "steps"}
    return sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:16]
