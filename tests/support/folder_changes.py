"""How often the calls that something makes lead from one folder of mimoc into another."""

import inspect
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import mimoc

ROOT = f"{Path(mimoc.__file__).parent}/"


def folder_changes(call: Callable[[], object]) -> Counter[tuple[str, str]]:
    """Return how often a function of one folder called one of another, by these folders, while something is called.

    The caller is the closest function of mimoc that waits for the call: what libraries and templates call in between,
    such as validators and filters, is called by whoever called the library. Generators that go on are not called.
    """
    changes: Counter[tuple[str, str]] = Counter()

    def trace(frame: FrameType, event: str, _: object) -> None:
        if event != "call" or frame.f_code.co_flags & inspect.CO_GENERATOR or (here := _folder(frame)) is None:
            return
        caller = frame.f_back
        while caller and _folder(caller) is None:
            caller = caller.f_back
        there = _folder(caller) if caller else here
        if there is not None and there != here:
            changes[there, here] += 1

    sys.setprofile(trace)
    try:
        call()
    finally:
        sys.setprofile(None)
    return changes


def _folder(frame: FrameType) -> str | None:
    """Return the folder of the module that a frame is of, if that is mimoc's."""
    file = frame.f_code.co_filename
    return file.removeprefix(ROOT).rpartition("/")[0] if file.startswith(ROOT) and file.endswith(".py") else None
