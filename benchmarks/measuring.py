"""Medians of CPU time, measured alternately so that other load on the machine affects all candidates equally."""

import os
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any


def cpu_medians_s(candidates: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Return the median CPU time of each candidate over some rounds; a first one warms up and is not counted."""
    times: dict[str, list[float]] = {name: [] for name in candidates}
    for _ in range(rounds + 1):
        for name, call in candidates.items():
            start = time.process_time()
            call()
            times[name].append(time.process_time() - start)
    return {name: statistics.median(taken[1:]) for name, taken in times.items()}


def felt(env: Any, commands: Iterable[Any]) -> None:
    """Run an episode of a Gymnasium environment."""
    env.reset(seed=0)
    for command in commands:
        env.step(command)


def command_medians_s(commands: Mapping[str, Sequence[str]], rounds: int) -> dict[str, float]:
    """Return the median CPU time, user and system, of each command over some rounds after a first one."""
    times: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(rounds + 1):
        for name, command in commands.items():
            times[name].append(_command_s(command))
    return {name: statistics.median(taken[1:]) for name, taken in times.items()}


def _command_s(command: Sequence[str]) -> float:
    silence = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    process = os.posix_spawn(command[0], command, os.environ, file_actions=silence)
    _, status, used = os.wait4(process, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return used.ru_utime + used.ru_stime
