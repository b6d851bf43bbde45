"""The `mimoc` command as the shell starts it: errors as one line each."""

import io
import os
import select
import sys
from typing import TextIO

from mimoc.cli.commands import app
from mimoc.cli.exits import BAD_INPUT, FAILED_CHECK, READER_GONE
from mimoc.errors import MimocError


def main() -> None:
    """Run the command line; what a user did wrong ends in exit code 2, without a traceback."""
    out = sys.stdout
    if isinstance(out, io.TextIOWrapper):
        out.reconfigure(errors="backslashreplace")  # For names of folders that the terminal cannot show.
    try:
        _run()
    except SystemExit as ended:
        if not _reader_has_gone(out, ended.code):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), out.fileno())  # Or Python complains when it flushes at its end.
        sys.exit(READER_GONE)


def _run() -> None:
    try:
        app(standalone_mode=True)
    except MimocError as error:
        print(error, file=sys.stderr)
        sys.exit(BAD_INPUT)
    except Exception as error:
        if "MUJOCO_GL" not in os.environ or "mujoco" in sys.modules:
            raise
        wished = os.environ["MUJOCO_GL"]
        print(f"MuJoCo does not start with MUJOCO_GL={wished} ({error}); unset it or choose another", file=sys.stderr)
        sys.exit(BAD_INPUT)


def _reader_has_gone(out: TextIO, code: object) -> bool:
    """Say whether a command ended, or is about to end, for nobody reads its output any more, as behind `| head`."""
    try:
        out.flush()
    except BrokenPipeError:
        return True
    if code != FAILED_CHECK:  # What click and rich make of a broken pipe, too.
        return False
    pipe = select.poll()
    try:
        pipe.register(out.fileno(), 0)
    except OSError:  # It is no file.
        return False
    return any(events & (select.POLLERR | select.POLLHUP) for _, events in pipe.poll(0))
