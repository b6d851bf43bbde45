import inspect
import io
import json
import os
import pty
import re
import shlex
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import pytest
from support.commands import process
from support.full import FULL

import mimoc
from mimoc import cli
from mimoc.cli import console
from mimoc.cli.terminal import resumable
from mimoc.cli.train import Lines, shown
from mimoc.runtime.quantities import EpisodeResult
from mimoc.training.checkpoint import read_progress
from mimoc.training.curve import summarize

EVERY = 128  # Steps between checkpoints.
TOLD = ["--envs", "2", "--checkpoint-every", str(EVERY), "--threads", "2"]
for knob in ("n_steps=32", "batch_size=64", "n_epochs=1", "width=8", "layers=1"):
    TOLD += ["--set", knob]
DEADLINE_S = 240
LINE = re.compile(r"[\d,]+ of 256 steps(, mean return -?[\d.]+)?(, [\d.]+ (s|min) left)?")
"""What is printed now and then where there is no terminal."""
TASKS = """
import gymnasium, numpy

class Height:
    spaces = {"goal": gymnasium.spaces.Box(0.0, 1.0, (1,), numpy.float32)}

    def observe(self):
        return {"goal": numpy.ones(1, numpy.float32)}

    def judge(self, data, action, effort):
        return float(data.qpos[2])

class Dull(Height):
    def judge(self, data, action, effort):
        return 0.0
"""


@pytest.fixture
def here(tmp_path, monkeypatch, bundle) -> Path:
    """Return the working directory, with the bundle in `out`."""
    monkeypatch.chdir(tmp_path)
    mimoc.write_bundle(bundle, "out")
    return tmp_path


def started(*arguments, **options) -> subprocess.Popen:
    pipes = {"stdout": None, "stderr": None, "text": False}
    return process("train", "out", "-o", "run", "--steps", 10**7, *TOLD, *arguments, **pipes | options)


def wait_for(path: Path, running: subprocess.Popen) -> None:
    deadline = time.monotonic() + DEADLINE_S
    while not path.exists():
        if running.poll() is not None or time.monotonic() > deadline:
            running.kill()  # Else `with` would wait for a training without end.
            pytest.fail(f"{path} is not written")
        time.sleep(0.01)


def test_train_and_run_print_a_summary(invoke, here):
    code, out, err = invoke("train", "out", "-o", "run", "--steps", 2 * EVERY, *TOLD)
    assert code == 0
    assert all(LINE.fullmatch(line) for line in err.splitlines())
    for said in (
        "trained for 256 control steps",
        "start",
        "end",
        "Share of episodes that succeed",
        "Their return so far",
        "mimoc run run/bundle --policy run/policy.zip",
    ):
        assert said in out
    code, out, err = invoke("run", "out", "--policy", "run/policy.zip", "--steps", 100)
    assert (code, err) == (0, "")
    for said in ("Return of an episode", "Share of episodes that succeed", "Completed episodes"):
        assert said in out


def test_what_is_taken_for_granted_and_what_is_wrong_with_a_reward_is_a_line_each(invoke, here, built):
    """And the learning goes on."""
    (here / "dull.py").write_text(TASKS)
    mimoc.write_bundle(built(task={"kind": "free"}), "free")
    code, _, err = invoke("train", "free", "-o", "run", "--task", "dull:Dull", "--steps", 1024, *TOLD)
    said = err.splitlines()
    assert code == 0
    assert said[0].startswith("note: the task of 'reaching' does not limit its episodes: this training ends them after")
    (warning,) = (line for line in said[1:] if line.startswith("warning: "))
    assert "the reward of all 1,000 control steps so far is 0" in warning


def test_the_command_that_is_proposed_runs_a_policy_with_the_task_that_it_observes(invoke, here):
    (here / "height.py").write_text(TASKS)
    code, out, _ = invoke("train", "out", "-o", "run", "--task", "height:Height", "--steps", EVERY, *TOLD)
    assert code == 0
    proposed = shlex.split(out.splitlines()[-1].partition("or try: mimoc ")[2])
    assert proposed[-2:] == ["--task", "height:Height"]
    code, out, _ = invoke(*proposed, "--steps", 60)
    assert code == 0
    assert "Return of an episode" in out


def test_lines_come_with_the_first_row_and_then_now_and_then():
    """Less and less often, as time goes on."""
    written, now_s = [], 0.0
    lines = Lines(written.append, lambda: now_s)
    for step in range(1, 100_001):
        now_s = step / 10
        lines.report(100 + step, 100_100)
        if step == 50:
            lines.on_row(summarize([], 150, 5.0, [EpisodeResult(1.5, 8, False, 0.08)]))
        if step == 1000:
            lines.on_row(summarize([EpisodeResult(-2.0, 9, False, 0.09)], 1100, 100.0))
    assert written[0] == "150 of 100,100 steps, mean return so far 1.5 in unfinished episodes, 2.8 h left"
    assert written[-1].startswith("9")
    assert ", mean return -2, " in written[-1]
    done = [int(line.split(" ")[0].replace(",", "")) for line in written]
    pauses = [after - before for before, after in pairwise(done)]
    assert pauses == sorted(pauses)
    assert (min(pauses), len(written) < 120) == (100, True)


def test_in_a_terminal_a_bar_has_the_return_before_it(monkeypatch):
    """Though while there is a bar, what is printed goes through something that is no terminal."""
    drawn = []

    @contextmanager
    def progress(what):
        monkeypatch.setattr(sys, "stderr", io.StringIO())
        yield lambda done, total, what=what: drawn.append((done, total, what))

    monkeypatch.setattr(console, "progress", progress)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with shown() as training:
        training.report(1, 9)
        training.on_row(summarize([EpisodeResult(-2.0, 9, False, 0.09)], 2, 1.0))
        training.report(2, 9)
    assert drawn == [(1, 9, "training"), (2, 9, "training, mean return -2")]


def test_ctrl_c_says_which_file_has_what_was_learnt_so_far(capsys, tmp_path):
    for file, said in (
        (tmp_path / "none", "stopped; run"),
        (tmp_path, f"stopped; {tmp_path} has the result so far; run"),
    ):
        with pytest.raises(KeyboardInterrupt), resumable(file):
            raise KeyboardInterrupt
        assert capsys.readouterr().err == f"{said} the same command again to resume\n"


def test_the_command_and_the_function_have_the_same_defaults():
    told, known = (inspect.signature(each).parameters for each in (cli.train.train, mimoc.train))
    for name in ("algo", "steps", "seed", "envs", "threads", "processes", "force", "checkpoint_every"):
        assert told[name].default == known[name].default


def test_the_same_command_resumes_the_run(invoke, here):
    assert invoke("train", "out", "-o", "run", "--steps", EVERY, *TOLD)[0] == 0
    code, out, _ = invoke("train", "out", "-o", "run", "--steps", 2 * EVERY, *TOLD)
    assert code == 0
    assert "resumed at step 128" in out


def test_the_command_in_the_run_folder_gives_the_same_policy(invoke, here, learned, same):
    assert invoke("train", "out", "-o", "run", "--steps", EVERY, "--seed", 4, *TOLD)[0] == 0
    command = json.loads(Path("run/run.json").read_text())["command"].split()
    command[2:5] = ["run/bundle", "-o", "again"]
    assert invoke(*command[1:])[0] == 0
    assert same(learned(Path("run/policy.zip")), learned(Path("again/policy.zip")))


@FULL
@pytest.mark.slow
def test_a_kill_loses_at_most_the_last_interval(here, learn, learned, same):
    """And the resumed run gives the same policy as an uninterrupted one."""
    with started() as running:
        wait_for(here / "run" / "checkpoints" / f"{2 * EVERY:010d}.zip", running)
        running.kill()
    state = here / "run" / "state.zip"
    kept = read_progress(state.read_bytes()).steps if state.exists() else 0
    assert kept >= EVERY
    newest = max(int(path.stem) for path in (here / "run" / "checkpoints").glob("*.zip"))
    assert newest - kept <= EVERY
    training = learn("run", steps=kept + EVERY)
    assert (training.resumed_at, training.curve.steps) == (kept, kept + EVERY)
    assert same(learned(training.policy), learned(learn("whole", steps=kept + EVERY).policy))


@pytest.mark.slow
def test_control_c_ends_a_run_quietly_and_it_can_be_resumed(invoke, here):
    """As in a terminal, where the signal also reaches the processes of the environments; those of growing infants."""
    (ours, theirs), growth = pty.openpty(), ("--grow", "17:18", "--grow-steps", 4 * EVERY)
    with started("--processes", *growth, stdout=theirs, stderr=theirs, start_new_session=True) as running:
        os.close(theirs)
        with ThreadPoolExecutor() as pool:  # A terminal that nobody reads is soon full.
            reading = pool.submit(drained, ours)
            wait_for(here / "run" / "checkpoints" / f"{EVERY:010d}.zip", running)
            os.killpg(running.pid, signal.SIGINT)
            shown = reading.result()
    assert running.returncode == 130
    assert b"Traceback" not in shown
    kept = read_progress(Path("run/state.zip").read_bytes()).steps if Path("run/state.zip").exists() else 0
    code, out, _ = invoke("train", "out", "-o", "run", "--steps", kept + EVERY, *TOLD, *growth)
    assert code == 0
    assert f"trained for {kept + EVERY} control steps" in out


def drained(terminal: int) -> bytes:
    """Return all that is written to a terminal until nobody writes to it any more."""
    shown = b""
    try:
        while part := os.read(terminal, 4096):
            shown += part
    except OSError:  # So Linux says that its other end is closed.
        pass
    os.close(terminal)
    return shown


@pytest.fixture(scope="module")
def blind(built) -> mimoc.Bundle:
    return built(senses={})


BAD_INPUT = {
    "an unknown algorithm": ("train out -o run --algo ppp", "'ppp' is not a learning algorithm; did you mean 'ppo'?"),
    "an unknown hyper-parameter": ("train out -o run --set gama=1", "did you mean 'gamma'?"),
    "no hyper-parameter": ("train out -o run --set gamma", "'gamma' is not an assignment"),
    "one age": ("train out -o run --grow 12", "'12' is not a range of ages; write two ages in months, such as 6:12"),
    "ages backwards": ("train out -o run --grow 12:6", "the younger first, such as 6:12"),
    "an age out of range": ("train out -o run --grow 6:30", "'6:30' is not a range of ages from 0 to 24 months"),
    "an unknown schedule": ("train out -o run --grow 6:12 --schedule grwn", "did you mean 'grown'?"),
    "a schedule of nothing": ("train out -o run --schedule shuffled", "schedule needs a range of ages as well: grow"),
    "steps of nothing": ("train out -o run --grow-steps 9", "grow_steps needs a range of ages as well: grow"),
    "nothing to observe": ("train blind -o run", "'reaching' observes nothing to learn from; give its spec a sense"),
    "longer episodes": ("train out -o run --steps-per-episode 31", "the task ends episodes after 30 control steps"),
    "no bundle": ("train nowhere -o run", "nowhere: there is no such folder"),
    "no spec": ("train nowhere.yaml -o run", "nowhere.yaml:1:1: the file does not exist"),
    "a folder of something else": ("train out -o folder", "folder: not the folder of a training run"),
    "a bundle to train in": ("train out -o out", "out: not the folder of a training run"),
    "a place nobody can write to": ("train out -o /proc/run", "/proc/run: cannot be written"),
    "no policy": ("run out --policy nowhere.zip", "nowhere.zip: there is no such file"),
    "a file that is no policy": ("run out --policy junk.zip", "junk.zip: not a policy trained by mimoc"),
}


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input_ends_in_exit_code_2_with_one_clear_line_and_nothing_written(case, invoke, here, blind):
    mimoc.write_bundle(blind, "blind")
    (here / "folder").mkdir()
    (here / "folder" / "thesis.tex").touch()
    (here / "junk.zip").write_bytes(b"junk")
    before = sorted(here.rglob("*"))
    command, said = BAD_INPUT[case]
    code, out, err = invoke(*command.split())
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert said in err
    assert sorted(here.rglob("*")) == before
