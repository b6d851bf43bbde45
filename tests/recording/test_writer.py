"""The thread that writes what is recorded."""

from threading import Event

import pytest
from support.forks import status_of_fork

from mimoc.recording.observer import WAITING, Writer


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_writes_nothing_and_waits_for_nobody():
    """Though so many jobs were waiting when it was forked that its process would have had to wait."""
    writer, may_go_on, done = Writer(), Event(), []
    writer(lambda: may_go_on.wait(60) and None)
    for number in range(WAITING):
        writer(lambda number=number: done.append(number))

    def use() -> None:
        writer(lambda: done.append("child"))
        writer.drain()
        writer.close()
        assert done == []

    assert status_of_fork(use) == 0
    may_go_on.set()
    writer.close()
    assert done == list(range(WAITING))
