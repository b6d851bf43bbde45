"""Commands that are told to end: they do so at once and quietly, whatever they are at."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mimoc.base import interruption

SPEC = str(Path(__file__).parents[2] / "configs" / "nine_months.yaml")
CODES = {signal.SIGINT: 130, signal.SIGTERM: 143}

AT_AN_IMPORT = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)

class Telling:
    left, number = map(int, sys.argv[1:3])
    def find_spec(self, name, path=None, target=None):
        self.left -= 1
        if not self.left:
            signal.raise_signal(self.number)

telling = Telling()
sys.meta_path.insert(0, telling)
sys.argv = ["mimoc", *sys.argv[3:]]
from mimoc.cli import main
try:
    main()
finally:
    if telling.left > 0:
        print(telling.left, file=sys.stderr)
"""
"""Runs a command in which a signal comes at its n-th import, if it has as many, and prints how many were left."""


def build_interrupted_at(imports: int, number: int, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", AT_AN_IMPORT, str(imports), str(int(number)), "build", SPEC, "-o", "out"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def imports_of_a_build(tmp_path_factory):
    """How often a build imports something: it depends on the packages that are installed."""
    many = 100_000
    done = build_interrupted_at(many, signal.SIGINT, tmp_path_factory.mktemp("whole"))
    return many - int(done.stderr)


@pytest.mark.full
@pytest.mark.parametrize("number", CODES)
@pytest.mark.parametrize("share", [0.05, 0.2, 0.5, 0.9])
def test_a_command_ends_quietly_while_it_loads(imports_of_a_build, share, number, tmp_path):
    done = build_interrupted_at(int(share * imports_of_a_build), number, tmp_path)
    assert (done.returncode, done.stdout, done.stderr.strip()) == (CODES[number], "", "")
    assert not list(tmp_path.iterdir())


@pytest.fixture
def heeded():
    """Heed the signals, also where the tests run in the background and so ignore Ctrl-C."""
    before = {each: signal.signal(each, signal.default_int_handler) for each in CODES}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("heeded")
@pytest.mark.parametrize("number", CODES)
def test_what_is_done_is_undone_as_on_control_c(number):
    steps = []

    def work():
        with interruption.ending_orderly():
            try:
                signal.raise_signal(number)
            except KeyboardInterrupt:
                steps.append("undone")
                raise

    with pytest.raises(SystemExit) as ended:
        work()
    assert (steps, ended.value.code) == (["undone"], CODES[number])


@pytest.mark.parametrize("error", [ValueError("KeyboardInterrupt"), SystemExit(1)])
def test_an_interruption_that_a_library_makes_another_error_of_is_one_still(error):
    def work():
        with interruption.ending_orderly():
            try:
                signal.raise_signal(signal.SIGTERM)
            except KeyboardInterrupt:
                raise error from None

    with pytest.raises(SystemExit) as ended:
        work()
    assert ended.value.code == 143


def test_signals_are_as_they_were_afterwards():
    before = [signal.getsignal(number) for number in CODES]
    with interruption.ending_orderly():
        pass
    assert [signal.getsignal(number) for number in CODES] == before


def test_other_errors_are_left_alone():
    with pytest.raises(ValueError, match="other"), interruption.ending_orderly():
        raise ValueError("other")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no processes are forked here")
def test_a_forked_process_is_ended_by_the_signal_itself():
    with interruption.ending_orderly():
        child = os.fork()
        if not child:
            try:
                signal.raise_signal(signal.SIGTERM)
            finally:
                os._exit(0)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGTERM
