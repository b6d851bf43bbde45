"""Signals on their way in an infant whose delays change, since it grows: they keep their content and their order."""

from collections.abc import Sequence
from typing import TypeVar

from mimoc.delays.jittered import JitteredCommands, JitteredSamples
from mimoc.delays.signals import DelayedCommands, DelayedSamples, Mask
from mimoc.delays.timing import Commands, Samples
from mimoc.senses.sense import Sample

Item = TypeVar("Item")


def transfer_samples(groups: Sequence[Samples], former: Sequence[Samples]) -> None:
    """Put the samples of a sense that are on their way into those with the delays of another age.

    The newest samples stay on their way, as many as the delay now has room for; the one before them has arrived. Where
    there is room for more, the oldest is observed for longer.

    Args:
        groups: The samples by their new delays.
        former: The same samples by their former delays, which are left as they are.
    """
    plain = [group for group in former if isinstance(group, DelayedSamples)]
    history = _history(plain) if len(plain) == len(former) else []
    for index, group in enumerate(groups):
        before = former[min(index, len(former) - 1)]
        if isinstance(group, DelayedSamples) and history:
            group.state = _resized(history, group.length + 1, history[0])
        elif isinstance(group, JitteredSamples) and isinstance(before, JitteredSamples):
            group.state = before.state
        else:  # One delay varies and the other does not.
            group.reset(before.arrived)


def transfer_commands(groups: Sequence[Commands], former: Sequence[Commands]) -> None:
    """Put the commands that are on their way into those with the delays of another age; see `transfer_samples`.

    Where there is room for more, actuators keep their controls for longer.
    """
    for index, group in enumerate(groups):
        before = former[min(index, len(former) - 1)]
        if isinstance(group, DelayedCommands) and isinstance(before, DelayedCommands):
            group.state = _resized(before.state, group.length, None)
        elif isinstance(group, JitteredCommands) and isinstance(before, JitteredCommands):
            group.state = before.state
        else:
            group.reset()


def _resized(items: Sequence[Item], length: int, oldest: Item) -> list[Item]:
    """Return the newest items, which are last, preceded by *oldest* as often as some are missing."""
    kept = items[max(len(items) - length, 0) :]
    return [*[oldest] * (length - len(kept)), *kept]


def _history(groups: Sequence[DelayedSamples]) -> list[Sample]:
    """Return the samples of a sense from the oldest to the newest, each number with the delay of its own group."""
    longest = max(group.length for group in groups) + 1
    lines = [(group.part, _resized(group.state, longest, group.arrived)) for group in groups]
    if len(lines) == 1:
        return lines[0][1]
    return [_merged([(part, line[at]) for part, line in lines]) for at in range(longest)]


def _merged(samples: Sequence[tuple[Mask | None, Sample]]) -> Sample:
    merged = samples[0][1].copy()
    for part, sample in samples[1:]:
        merged[part] = sample[part]
    return merged
