"""The `mimoc` command as the shell starts it: errors as one line each."""

import io
import os
import sys

from mimoc.cli.commands import app
from mimoc.cli.exits import BAD_INPUT
from mimoc.errors import MimocError


def main() -> None:
    """Run the command line; what a user did wrong ends in exit code 2, without a traceback."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # For names of folders that the terminal cannot show.
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
