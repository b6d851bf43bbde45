"""A bundle that is being written is whole or absent, whatever fails, is killed or comes between."""

import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from support.bundles import ONE, TWO, contents

from mimoc.base.errors import BundleError
from mimoc.bundle import io as bundle_io
from mimoc.bundle.files import writer_prefix
from mimoc.bundle.io import read_bundle, write_bundle


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
@pytest.mark.parametrize("step", range(len(ONE.files) + 1))
def test_a_failed_write_leaves_what_was_there(out, monkeypatch, force, failure, step):
    if force:
        write_bundle(ONE, out)
    before = contents(out.parent)
    left = iter(range(step))
    write_bytes = Path.write_bytes

    def fail(*_: object) -> int:
        raise failure

    def write_some(path: Path, content: bytes) -> int:
        return fail() if next(left, None) is None else write_bytes(path, content)

    monkeypatch.setattr(Path, "write_bytes", write_some)
    monkeypatch.setattr(bundle_io, "swap_folders" if force else "_move_into_place", fail)
    with pytest.raises(BundleError if isinstance(failure, OSError) else KeyboardInterrupt) as error:
        write_bundle(TWO, out, force=force)
    assert isinstance(failure, KeyboardInterrupt) or "cannot be written (No space left on device)" in str(error.value)
    assert contents(out.parent) == before
    assert os.listdir(out.parent) == ([out.name] if force else [])


BUILDERS = """
import os, signal, sys
from mimoc.bundle.io import read_bundle, write_bundle
from mimoc.base.errors import BundleError

one, two = map(read_bundle, sys.argv[1:3])


def rewrite(out):
    while True:
        for bundle in (one, two):
            write_bundle(bundle, out, force=True)


def write_many(out):
    number = 0
    while True:
        write_bundle(one, f"{out}-{number}")
        number += 1


def die_at(out, step, force):
    done = iter(range(int(step)))

    def count(event, arguments):
        if event in STEPS and next(done, None) is None:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    write_bundle(two, out, force=force == "force")


STEPS = {"open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.listdir", "os.scandir", "ctypes.dlopen",
         "ctypes.dlsym", "shutil.rmtree"}


def race(out, gate, force):
    while not os.path.exists(gate):
        os.sched_yield()
    try:
        write_bundle(one if os.getpid() % 2 else two, out, force=force == "force")
        answer = "written"
    except BundleError as error:
        answer = str(error)
    with open(f"{gate}-{os.getpid()}", "w") as file:
        file.write(answer)


signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # So that who is killed is gone at once.
for line in sys.stdin:
    function, *arguments = line.rstrip("\\n").split("\\t")
    process = os.fork()
    if process == 0:
        try:
            globals()[function](*arguments)
        finally:
            os._exit(0)
    print(process, flush=True)
"""


class Builders:
    """A process that forks builders, each in a process of its own."""

    def __init__(self, one: Path, two: Path):
        command = [sys.executable, "-c", BUILDERS, str(one), str(two)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def start(self, function: str, *arguments: object) -> int:
        """Return the ID of a new process that runs one of the functions of the script."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(function, *arguments, sep="\t", file=self._process.stdin, flush=True)
        return int(self._process.stdout.readline())

    def close(self) -> None:
        self._process.communicate(timeout=10)


@pytest.fixture(scope="module")
def builders(tmp_path_factory) -> Iterator[Builders]:
    folder = tmp_path_factory.mktemp("builders")
    found = Builders(write_bundle(ONE, folder / "one"), write_bundle(TWO, folder / "two"))
    yield found
    found.close()


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def wait_until(condition: Callable[[], bool], seconds: float = 20) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.0002)


def kill(process: int) -> None:
    os.kill(process, signal.SIGKILL)
    wait_until(lambda: not is_alive(process))


def leftovers(out: Path) -> list[str]:
    return [name for name in os.listdir(out.parent) if name.startswith(f".{out.name}.")]


def test_a_build_killed_at_any_moment_leaves_one_whole_bundle(out, builders):
    write_bundle(ONE, out)
    moments, left = random.Random(2), 0
    for _ in range(40):
        started = out.stat().st_ino
        builder = builders.start("rewrite", out)
        wait_until(lambda: out.stat().st_ino != started)  # noqa: B023 - It is at work; used at once.
        time.sleep(moments.uniform(0, 0.006))
        kill(builder)
        assert read_bundle(out).files in (ONE.files, TWO.files)
        assert len(leftovers(out)) <= 1, "the last one was not swept"
        left += len(leftovers(out))
    assert left > 10, "hardly any was killed at work"
    write_bundle(ONE, out, force=True)
    assert os.listdir(out.parent) == [out.name]


def test_new_bundles_are_whole_or_absent_when_the_build_is_killed(out, builders):
    moments, left = random.Random(3), 0
    for _ in range(40):
        builder = builders.start("write_many", out)
        wait_until(lambda: out.with_name(f"{out.name}-0").exists())
        time.sleep(moments.uniform(0, 0.006))
        kill(builder)
        hidden = {name for name in os.listdir(out.parent) if name.startswith(".")}
        left += len(hidden)
        for name in set(os.listdir(out.parent)) - hidden:
            assert contents(out.parent / name) == dict(ONE.files)
        for name in hidden:
            target = out.parent / name.split(".")[1]
            assert not target.exists()
            write_bundle(TWO, target)
        assert not [name for name in os.listdir(out.parent) if name.startswith(".")]
        shutil.rmtree(out.parent)
        out.parent.mkdir()
    assert left > 10, "hardly any was killed at work"


@pytest.mark.parametrize("name", ["infant", "run[1]", "run*"])
def test_only_leftovers_of_killed_builds_of_the_same_bundle_are_removed(tmp_path, builders, name):
    dead = builders.start("no such function")
    wait_until(lambda: not is_alive(dead))
    ours = writer_prefix(bundle_io._staging_prefix(tmp_path / name))
    swept, *kept = [
        f"{ours}{dead}-1",
        f"{ours}{os.getpid()}-1",
        f"{ours}x-1",
        f".other.mimoc-host-{dead}-1",
        f"{name}-1",
    ]
    for each in (swept, *kept):
        (tmp_path / each).mkdir()
    write_bundle(ONE, tmp_path / name)
    assert set(os.listdir(tmp_path)) == {name, *kept}


@pytest.mark.parametrize("force", ["force", ""])
def test_a_build_killed_at_each_of_its_steps_leaves_the_old_or_the_new(out, builders, force):
    seen: list[str] = []
    for step in range(200):
        if force:
            write_bundle(ONE, out, force=True)
        builder = builders.start("die_at", out, step, force)
        wait_until(lambda: not is_alive(builder))  # noqa: B023 - Used at once.
        seen.append(read_bundle(out).manifest.name if out.exists() else "absent")
        finished = not leftovers(out) and seen[-1] == "two"
        write_bundle(ONE, out, force=True)
        assert os.listdir(out.parent) == [out.name]
        if finished:
            break
        if not force:
            shutil.rmtree(out)
    before = "one" if force else "absent"
    turn = seen.index("two")
    assert seen == [before] * turn + ["two"] * (len(seen) - turn)
    assert turn > 20, "the steps were not seen"


@pytest.mark.parametrize("force", ["force", ""])
def test_builds_of_one_bundle_at_once_leave_one_whole_bundle(out, builders, force):
    error = f"{out}: a bundle already exists here; replace it with --force, or name a new folder"
    for turn in range(12):
        gate = out.parent.parent / f"gate-{turn}"
        processes = [builders.start("race", out, gate, force) for _ in range(4)]
        gate.touch()
        wait_until(lambda: not any(map(is_alive, processes)))  # noqa: B023 - Used at once.
        answers = sorted(Path(f"{gate}-{process}").read_text() for process in processes)
        assert answers == (["written"] * 4 if force else [error] * 3 + ["written"])
        assert read_bundle(out).files in (ONE.files, TWO.files)
        assert os.listdir(out.parent) == [out.name]
        shutil.rmtree(out)


def test_a_reader_never_sees_half_of_two_bundles(out, builders):
    write_bundle(ONE, out)
    builder = builders.start("rewrite", out)
    try:
        seen = [read_bundle(out).manifest.name for _ in range(400)]
    finally:
        kill(builder)
    assert set(seen) == {"one", "two"}
