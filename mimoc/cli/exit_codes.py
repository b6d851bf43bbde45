"""Exit codes of the commands, and their message on an interruption."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

BAD_INPUT, FAILED_CHECK = 2, 1
BROKEN_PIPE = 128 + 13
"""Exit code of a process ended by SIGPIPE: the reader of its output has closed the pipe."""


@contextmanager
def resumable() -> Iterator[None]:
    """On Ctrl-C, say that the same command resumes the work."""
    try:
        yield
    except KeyboardInterrupt:
        print("stopped; run the same command again to resume", file=sys.stderr)
        raise
