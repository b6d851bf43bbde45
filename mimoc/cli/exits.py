"""How commands end: exit codes, and what is said of an interruption."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

BAD_INPUT, FAILED_CHECK = 2, 1
READER_GONE = 128 + 13
"""As of what SIGPIPE ends, the signal of a pipe that nobody reads any more."""


@contextmanager
def can_go_on() -> Iterator[None]:
    """Say, where Ctrl-C ends something long, that nothing but the last part is lost."""
    try:
        yield
    except KeyboardInterrupt:
        print("stopped; the same command goes on from what is there", file=sys.stderr)
        raise
