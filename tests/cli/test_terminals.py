"""Commands in processes of their own: in terminals, in pipes, and when they are stopped."""

import os
import pty
import re
import shlex
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from support.commands import drained, finished, finished_together, process
from support.full import full_but

import mimoc
from mimoc.base import interruption
from mimoc.cli import doctor
from mimoc.cli.console import PlainProgress
from mimoc.cli.terminal import printable

SPEC = str(Path(__file__).parents[2] / "configs" / "nine_months.yaml")
ESCAPE = "\x1b"


@pytest.mark.full
def test_python_dash_m_is_the_same_command(invoke, built, here):
    assert finished("--version") == invoke("--version")
    assert finished("explain", built, "body.left_foot.mass") == invoke("explain", built, "body.left_foot.mass")


@pytest.mark.full
@pytest.mark.parametrize("arguments", ["run {built} --steps 1000000000", "validate"])
def test_control_c_ends_a_command_at_once_and_quietly(arguments, built):
    """In a terminal, once its progress bar has moved."""
    ours, theirs = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
    with process(*shlex.split(arguments.format(built=built)), stderr=theirs, env=environment) as running:
        os.close(theirs)
        shown = b""
        while not re.search(rb"\d/\d", shown):
            shown += os.read(ours, 1024)
        running.send_signal(signal.SIGINT)
        out = running.stdout.read()
        shown += drained(ours)
    os.close(ours)
    assert (running.returncode, out) == (130, "")
    assert b"Traceback" not in shown


@pytest.mark.full
def test_progress_is_for_the_terminal_and_results_are_for_the_pipe(built):
    ours, theirs = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "80", "NO_COLOR": "1"}
    with process("check", built, stderr=theirs, env=environment) as running:
        os.close(theirs)
        shown, out = drained(ours), running.stdout.read()
    os.close(ours)
    assert [line.split()[0] for line in out.splitlines()] == ["ok"] * 5
    assert ESCAPE not in out
    assert re.search(rb"checking .* \d/4 \d:\d\d:\d\d", shown)


@pytest.mark.full
def test_there_is_no_progress_in_a_pipe_even_if_colours_are_wanted_there(built):
    assert finished("check", built, FORCE_COLOR="1").err == ""


@pytest.mark.full
def test_bash_completes_commands():
    """By the script that `mimoc --install-completion` installs."""
    typed = "COMP_WORDS=(mimoc va); COMP_CWORD=1; _mimoc_completion mimoc; echo ${COMPREPLY[@]}"
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    script = f". <(_MIMOC_COMPLETE=source_bash mimoc); {typed}"
    done = subprocess.run(["bash", "-c", script], env=os.environ | {"PATH": path}, capture_output=True, check=True)
    assert (done.stdout, done.stderr) == (b"validate\n", b"")


@pytest.mark.full
@pytest.mark.parametrize(
    "arguments",
    full_but(
        ["validate {one_age} --json", "explain {built} body.left_foot.mass"],
        ["validate {one_age}", "run {built} --steps 3", "check {built}"],
    ),
)
def test_a_broken_pipe_is_no_error(arguments, built, one_age):
    with process(*shlex.split(arguments.format(built=built, one_age=one_age))) as running:
        running.stdout.close()
        errors = running.stderr.read()
    assert errors == ""
    assert running.returncode == 141  # As of a process that SIGPIPE ends.


@pytest.mark.full
@pytest.mark.parametrize(
    "environment",
    full_but([{"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}], [{"PYTHONIOENCODING": "ascii"}]),
    ids=["C locale", "ascii"],
)
def test_a_terminal_without_unicode_is_no_error(environment, built, here):
    *well, refused = finished_together(
        ["build", SPEC, "-o", "säugling"],
        ["run", built, "--steps", 3],
        ["build", "--help"],
        ["check", "söugling"],
        **environment,
    )
    for done in well:
        assert (done.code, done.err) == (0, "")
        assert done.out
    assert refused.code == 2
    assert len(refused.err.splitlines()) == 1
    assert mimoc.read_bundle("säugling")


@pytest.mark.parametrize(
    "command", ["validate {one_age}", "run {built} --steps 3", "check {built}", "explain {built} spec.name"]
)
def test_a_pipe_gets_plain_text(invoke, command, built, one_age):
    done = invoke(*shlex.split(command.format(built=built, one_age=one_age)))
    assert done.out
    assert ESCAPE not in done.out + done.err


def test_colours_can_be_forced_and_switched_off(invoke, built, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    colour = re.compile(r"\x1b\[[\d;]*3\d")
    assert colour.search(invoke("check", built).out)
    monkeypatch.setenv("NO_COLOR", "1")
    assert not colour.search(invoke("check", built).out)


@pytest.mark.parametrize("library", ["junk", "egl"])
def test_an_opengl_that_mujoco_cannot_load_is_one_clear_line(library, built, tmp_path):
    """Importing MuJoCo fails then, even for commands that render nothing."""
    for name in ("libEGL.so", "libEGL.so.1"):
        (tmp_path / name).write_text("not a library")
    done = finished("check", built, MUJOCO_GL=library, LD_LIBRARY_PATH=str(tmp_path))
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"MuJoCo cannot be loaded with MUJOCO_GL={library} (")
    assert "apt-get install libegl1, or libosmesa6" in done.err
    assert len(done.err.splitlines()) == 1


def test_elsewhere_than_in_a_terminal_long_work_is_a_line_now_and_then():
    """Nothing of what is short; then a line in half a minute, and ever fewer."""
    written, now_s = [], 0.0
    show = PlainProgress("fitting", written.append, lambda: now_s)
    for done in range(2001):
        now_s = 1.0 * done
        show(done, 2000)
    assert written[0] == "fitting: 30 of 2,000, 33 min left"
    assert 5 < len(written) < 40
    show(2000, 2000)
    assert written[-1].endswith(" left")


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("out/Zoë 3", "out/Zoë 3"),
        ("a\x1b[31mb", "a\\x1b[31mb"),
        ("a\rb\x07", "a\\rb\\x07"),
        ("a\u202eb", "a\\u202eb"),
        ("two\nlines", "two\nlines"),
    ],
)
def test_what_a_terminal_would_obey_is_escaped(text, printed):
    assert printable(text) == printed


def test_a_command_escapes_the_names_of_its_files(invoke, here):
    wrong = invoke("build", "a\x1b[31m.yaml", "-o", "out")
    assert (wrong.code, wrong.err) == (2, "a\\x1b[31m.yaml:1:1: the file does not exist; check the path\n")
    written = invoke("schema", "-o", "b\x1b[31m.json")
    assert (written.code, written.out) == (0, "b\\x1b[31m.json\n")


ROOT = Path(__file__).parents[2]


@pytest.fixture
def findings(invoke, monkeypatch):
    def run(**environment: str):
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        code, out, err = invoke("doctor")
        assert err == ""
        return code, {line[7:].split("  ")[0].strip(): line for line in out.splitlines()}

    return run


def program(folder: Path, name: str, *lines: str) -> None:
    path = folder / name
    path.write_text("\n".join(("#!/bin/sh", *lines)))
    path.chmod(0o755)


def test_what_there_is_and_what_there_is_not(findings, tmp_path, monkeypatch):
    monkeypatch.setattr(doctor, "requires", lambda name: ["numpy>=1; extra == 'report'", "nowhere; extra == 'ray'"])
    code, found = findings(PATH=str(tmp_path))
    assert code == 0
    assert found["MuJoCo"].endswith("infants compile and move")
    assert found["mimoc[report]"].startswith("ok     mimoc[report]  plots and pages (numpy ")
    assert found["mimoc[ray]"] == "none   mimoc[ray]     for cohorts on Ray: pip install 'mimoc[ray]'"
    assert found["SLURM"] == "none   SLURM          no command 'sinfo'"


def test_what_is_broken_says_so_in_one_line(findings, tmp_path):
    program(tmp_path, "sinfo", "echo no controller >&2", "exit 1")
    program(tmp_path, "nvidia-smi", "echo Somebody 5090, 999.1", "echo Somebody 5090, 999.1")
    code, found = findings(PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert code == 0
    assert found["SLURM"] == "broken SLURM          no controller"
    assert found["NVIDIA GPU"] == "ok     NVIDIA GPU     Somebody 5090, 999.1, Somebody 5090, 999.1"


def test_the_exit_code_is_1_if_no_infant_can_move(findings, monkeypatch):
    monkeypatch.setattr(mimoc, "make", lambda spec: 1 / 0)
    code, found = findings()
    assert (code, found["MuJoCo"]) == (1, "broken MuJoCo         division by zero")


def test_every_extra_has_a_purpose():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert set(doctor.EXTRAS) == set(extras) - {"test", "pages", "docs", "dev"}


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
