"""A process that does the jobs it is handed, one after the other, until there are no more."""

import os
import sys
from contextlib import suppress
from multiprocessing.connection import Connection
from threading import Thread

from mimoc.cohorts.perform import perform
from mimoc.cohorts.work import Bench
from mimoc.errors import MimocError


def main(descriptor: int) -> None:
    """Do the jobs that come over a connection, and answer each with True, or with why the folder cannot be written.

    Args:
        descriptor: File descriptor of the connection.
    """
    os.set_inheritable(descriptor, False)
    lifeline = os.dup(0)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    connection, bench = Connection(descriptor), Bench()
    with suppress(EOFError, ConnectionError):  # There are no more jobs, or nobody waits for the answer.
        while True:
            job, store = connection.recv()
            try:
                perform([job], store, bench)
            except MimocError as error:
                connection.send(error)
            else:
                connection.send(True)


def _end_with(lifeline: int) -> None:
    """End this process when the one that started it ends, however it ends."""
    while os.read(lifeline, 1):
        pass
    os._exit(1)


if __name__ == "__main__":
    main(int(sys.argv[1]))
