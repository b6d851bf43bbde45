"""How the command ends when it is told to, by Ctrl-C or SIGTERM: quietly, and with nothing left half-written."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

HEEDED = (signal.SIGINT, signal.SIGTERM)


def is_command() -> bool:
    """Return whether this process is the command `mimoc`, or becomes it: `python -m` imports the package first."""
    return os.path.basename(next(iter(sys.argv), "")).removesuffix(".exe") in ("mimoc", "-m")


def quit_at_once() -> None:
    """Let the signals end this process from now on, where there is nothing to be cleaned up yet, or any more."""
    for number in HEEDED:
        if signal.getsignal(number) is not signal.SIG_IGN:  # As `nohup` and shells have it for what runs behind.
            signal.signal(number, _quit)


@contextmanager
def ending_orderly() -> Iterator[None]:
    """Let SIGTERM end what is done meanwhile as Ctrl-C does, which raises `KeyboardInterrupt`.

    The process exits with code 130 or 143 then, as shells have it.
    """
    received: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> None:
        if os.getpid() != process:  # A process that was forked from this one.
            signal.signal(number, signal.SIG_DFL)
            signal.raise_signal(number)
        received.append(number)
        raise KeyboardInterrupt

    process = os.getpid()
    before = {number: signal.getsignal(number) or signal.SIG_DFL for number in HEEDED}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, interrupt)
    try:
        yield
    except BaseException as error:  # Libraries make other errors of an interruption.
        if received and getattr(error, "code", None) != 0:
            sys.exit(128 + received[0])
        raise
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _quit(number: int, frame: FrameType | None) -> None:
    os._exit(128 + number)
