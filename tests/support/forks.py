"""A forked process that does something and ends."""

import os
import signal
from collections.abc import Callable

PATIENCE_S = 60


def status_of_fork(act: Callable[[], object]) -> int:
    """Return how a forked process has ended that did something, 0 if it could; a signal ends it if it hangs."""
    child = os.fork()
    if not child:
        signal.alarm(PATIENCE_S)
        try:
            act()
            os._exit(0)
        finally:
            os._exit(1)
    return os.waitpid(child, 0)[1]
