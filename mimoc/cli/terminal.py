"""Exit codes, what is said of an interruption, and foreign text as a terminal can show it."""

import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

BAD_INPUT, FAILED_CHECK = 2, 1
BROKEN_PIPE = 128 + 13  # Exit code of a process ended by SIGPIPE: the reader of its output has closed the pipe.


@contextmanager
def resumable(result: Path | None = None) -> Generator[None, None, None]:
    """On Ctrl-C, say that the same command resumes the work, and which file has the result so far, if it exists."""
    try:
        yield
    except KeyboardInterrupt:
        so_far = f"{result} has the result so far; " if result and result.exists() else ""
        print(printable(f"stopped; {so_far}run the same command again to resume"), file=sys.stderr)
        raise


def printable(text: object) -> str:
    r"""Return a text with all that is not to be printed escaped, such as `\x1b`; line breaks stay."""
    return "".join(
        character if character.isprintable() or character == "\n" else character.encode("unicode_escape").decode()
        for character in str(text)
    )
