"""Tasks on a device: the rewards of all infants at once."""

from collections.abc import Callable, Mapping, Sequence

from mimoc.errors import MimocError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.tasks.catch import DeviceCatch
from mimoc.runtime.warp.tasks.reach import DeviceReach
from mimoc.runtime.warp.tasks.rollover import DeviceRollover
from mimoc.runtime.warp.tasks.selfbody import DeviceSelfbody
from mimoc.runtime.warp.tasks.standup import DeviceStandup
from mimoc.runtime.warp.tasks.task import DeviceTask
from mimoc.tasks.custom import CustomTask

TASKS: Mapping[str, Callable[[Sequence[InfantEnv], int], DeviceTask]] = {
    "free": DeviceTask,
    "reach": DeviceReach,
    "standup": DeviceStandup,
    "rollover": DeviceRollover,
    "selfbody": DeviceSelfbody,
    "catch": DeviceCatch,
}
"""Those that are there."""


def device_task(infants: Sequence[InfantEnv], worlds: int) -> DeviceTask:
    """Return the task of infants of some different bodies in some number of worlds.

    Raises:
        MimocError: If it is not there on a device.
    """
    kind = infants[0].manifest.task.kind
    if isinstance(infants[0].task, CustomTask) or kind not in TASKS:
        raise MimocError(
            f"the task '{kind}', or the object passed as one, runs on the CPU only; "
            f"leave out device, or choose from {', '.join(TASKS)}"
        )
    return TASKS[kind](infants, worlds)
