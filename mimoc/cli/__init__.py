"""The `mimoc` command line: its entry point, which prints errors of the user as one line each."""

import io
import os
import select
import sys
import warnings
from typing import TextIO

from mimoc.base.errors import MimocError, problem_of_loading_mujoco
from mimoc.base.interruption import ending_orderly
from mimoc.cli.terminal import BAD_INPUT, BROKEN_PIPE, FAILED_CHECK, printable


def main() -> None:
    """Run the command line; a user's mistake ends with exit code 2 and no traceback."""
    with ending_orderly():
        out = sys.stdout
        if isinstance(out, io.TextIOWrapper):
            out.reconfigure(errors="backslashreplace")  # For folder names that the terminal cannot encode.
        try:
            _run()
        except SystemExit as ended:
            if not _is_pipe_broken(out, ended.code):
                raise
            os.dup2(os.open(os.devnull, os.O_WRONLY), out.fileno())  # Otherwise flushing at exit raises again.
            sys.exit(BROKEN_PIPE)


def _run() -> None:
    warnings.formatwarning = lambda message, *_place: f"warning: {printable(message)}\n"
    try:
        from mimoc.cli.commands import app

        app(standalone_mode=True)
    except MimocError as error:
        print(printable(error), file=sys.stderr)
        sys.exit(BAD_INPUT)
    except Exception as error:
        problem = problem_of_loading_mujoco(error)
        if not problem:
            raise
        print(printable(problem), file=sys.stderr)
        sys.exit(BAD_INPUT)


def _is_pipe_broken(out: TextIO, code: object) -> bool:
    """Return whether the reader of the output has closed its end of the pipe, as `| head` does."""
    try:
        out.flush()
    except BrokenPipeError:
        return True
    if code != FAILED_CHECK:  # The code that click and rich exit with on a broken pipe, too.
        return False
    pipe = select.poll()
    try:
        pipe.register(out.fileno(), 0)
    except OSError:  # Not a file.
        return False
    return any(events & (select.POLLERR | select.POLLHUP) for _, events in pipe.poll(0))
