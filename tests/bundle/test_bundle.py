"""A bundle that is read is intact, or it is refused; a bundle is written all or nothing."""

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimoc.bundle import atomic_swap
from mimoc.bundle import io as bundle_io
from mimoc.bundle.atomic_swap import swap_folders
from mimoc.bundle.io import (
    LOCK,
    MANIFEST,
    MAX_LOCK_BYTES,
    Bundle,
    digests,
    read_bundle,
    seal,
    write_bundle,
)
from mimoc.errors import BundleError

MANIFEST_DATA = {
    "name": "infant",
    "child": {
        "age_months": 9,
        "length_cm": 70,
        "weight_kg": 9,
        "head_circumference_cm": 44,
        "arm_circumference_cm": 14,
    },
    "root_body": "hip",
    "root_joint": "free",
    "timestep_ms": 5,
    "step_ms": 10,
    "pose": "supine",
    "poses": ["supine"],
    "actuation": {"actuators": []},
    "senses": {},
}


def make_bundle(mark: str = "one", **changes: object) -> Bundle:
    """Return a bundle whose every file says which one it is."""
    files = {f"assets/{n}.png": f"{mark} {n}".encode() * 3000 for n in range(8)}
    manifest = json.dumps({**MANIFEST_DATA, "name": mark, **changes}).encode()
    return seal({"infant.xml": mark.encode(), **files, MANIFEST: manifest}, {"mimoc": "1"}, {"who.csv": b"1,2"})


ONE, TWO = make_bundle("one"), make_bundle("two")


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file below a folder, hidden ones too."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def out(tmp_path) -> Path:
    """Return a folder for a bundle, alone in its parent."""
    (tmp_path / "builds").mkdir()
    return tmp_path / "builds" / "infant"


# What is written is what is read.


def test_what_is_written_is_what_is_read(out):
    assert write_bundle(ONE, out) == out
    read = read_bundle(out)
    assert (read.files, read.manifest, read.path) == (ONE.files, ONE.manifest, out)
    assert contents(out) == dict(ONE.files)
    assert os.listdir(out.parent) == [out.name]


PARTS = st.text(st.characters(categories=["Ll", "Nd", "Lo"], include_characters=" -_.$*[]"), min_size=1, max_size=9)
FOLDERS = st.lists(PARTS.map(lambda part: f"d{part}"), max_size=3)
FILE_NAMES = st.builds(lambda above, name: "/".join([*above, f"f{name}"]), FOLDERS, PARTS)


@given(files=st.dictionaries(FILE_NAMES, st.binary(max_size=99), max_size=8))
def test_any_tree_of_files_survives_the_round_trip(files, tmp_path_factory):
    whole = seal({**files, MANIFEST: ONE.files[MANIFEST]}, {}, {})
    folder = write_bundle(whole, tmp_path_factory.mktemp("tree") / "out")
    assert read_bundle(folder).files == whole.files
    assert contents(folder) == dict(whole.files)


def test_the_lock_has_the_digest_of_every_file_and_input():
    lock = json.loads(ONE.files[LOCK])
    assert lock["files"] == digests({name: content for name, content in ONE.files.items() if name != LOCK})
    assert lock["inputs"] == digests({"who.csv": b"1,2"})
    assert lock["versions"] == {"mimoc": "1"}
    assert digests({"a": b""}) == {"a": "sha256:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"}


def test_the_same_files_in_another_order_are_the_same_bundle():
    files = {name: content for name, content in ONE.files.items() if name != LOCK}
    again = seal(dict(reversed(files.items())), {"mimoc": "1"}, {"who.csv": b"1,2"})
    assert list(again.files.items()) == list(ONE.files.items())


def test_a_bundle_in_memory_cannot_be_changed():
    with pytest.raises(TypeError):
        ONE.files["infant.xml"] = b""  # pyright: ignore[reportIndexIssue]


# What was changed is named.


def test_a_changed_file_is_named(out):
    write_bundle(ONE, out)
    (out / "infant.xml").write_bytes(b"One")
    with pytest.raises(BundleError) as error:
        read_bundle(out)
    assert str(error.value) == f"{out}: infant.xml was changed; build it again with 'mimoc build --force'"


def test_every_file_that_is_wrong_is_named(out):
    write_bundle(ONE, out)
    (out / "infant.xml").write_bytes(b"")
    (out / "assets/3.png").write_bytes(b"x")
    (out / "assets/5.png").unlink()
    (out / MANIFEST).unlink()
    with pytest.raises(
        BundleError,
        match=r"assets/5.png is missing, manifest.json is missing, assets/3.png was changed, infant.xml was changed",
    ):
        read_bundle(out)


@pytest.mark.parametrize("name", sorted(ONE.files.keys() - {LOCK}))
def test_a_change_of_any_file_is_found(out, name):
    write_bundle(ONE, out)
    (out / name).write_bytes(ONE.files[name] + b" ")
    with pytest.raises(BundleError, match=f"{name} was changed"):
        read_bundle(out)


@pytest.mark.parametrize("replace", [os.mkdir, os.mkfifo, lambda path: os.symlink(path, path)])
def test_a_path_that_is_no_longer_a_file_is_missing(out, replace):
    """A named pipe, too, which the reader does not wait for."""
    write_bundle(ONE, out)
    (out / "infant.xml").unlink()
    replace(out / "infant.xml")
    with pytest.raises(BundleError, match=r"infant.xml is missing"):
        read_bundle(out)


def test_files_outside_the_lock_are_ignored_but_do_not_survive_force(out):
    """`--force` replaces the folder as a whole."""
    write_bundle(ONE, out)
    (out / "notes.txt").write_text("mine")
    assert read_bundle(out).files == ONE.files
    write_bundle(TWO, out, force=True)
    assert contents(out) == dict(TWO.files)


# What is no bundle is refused.


def test_the_error_for_a_missing_folder_says_how_to_build_a_bundle(tmp_path):
    with pytest.raises(BundleError, match=r"nothing: there is no such folder; build one there with 'mimoc build SPEC"):
        read_bundle(tmp_path / "nothing")


def test_a_file_or_another_folder_is_not_a_bundle(tmp_path):
    (tmp_path / "infant.xml").write_text("<mujoco/>")
    with pytest.raises(BundleError, match="there is no such folder"):
        read_bundle(tmp_path / "infant.xml")
    with pytest.raises(BundleError, match=r"this is not a bundle, it has no lock.json"):
        read_bundle(tmp_path)


NO_LOCKS = {
    "empty": b"",
    "no JSON": b"<mujoco/>",
    "no text": b"\xff\xfe\x00",
    "a list": b"[]",
    "a number": b"1e999",
    "no files": b"{}",
    "files in a list": b'{"files": ["manifest.json"]}',
    "no manifest": b'{"files": {"infant.xml": "sha256:0"}}',
    "a bomb": b"[" * 200_000,
    "cut off": ONE.files[LOCK][:-20],
    "huge": ONE.files[LOCK] + b" " * MAX_LOCK_BYTES + b"!",
    "above": b'{"files": {"manifest.json": "", "../secret": ""}}',
    "above, inside": b'{"files": {"manifest.json": "", "assets/../../secret": ""}}',
    "absolute": b'{"files": {"manifest.json": "", "/etc/passwd": ""}}',
    "backslash": rb'{"files": {"manifest.json": "", "..\\secret": ""}}',
    "NUL": rb'{"files": {"manifest.json": "", "a\u0000b": ""}}',
    "half a character": rb'{"files": {"manifest.json": "", "\ud800": ""}}',
    "a new line": rb'{"files": {"manifest.json": "", "a\nb": ""}}',
}


@pytest.mark.parametrize("lock", NO_LOCKS.values(), ids=NO_LOCKS.keys())
def test_a_folder_with_a_damaged_lock_is_neither_read_nor_replaced(out, lock):
    write_bundle(ONE, out)
    (out / LOCK).write_bytes(lock)
    before = contents(out)
    with pytest.raises(BundleError, match=r"lock.json is damaged; remove the folder and build it again$"):
        read_bundle(out)
    with pytest.raises(BundleError, match="is not a bundle and is never replaced"):
        write_bundle(TWO, out, force=True)
    assert contents(out) == before


@pytest.mark.parametrize("digest", ["", "sha256:", None, 7, ["sha256:0"]])
def test_a_lock_with_an_invalid_digest_matches_no_file(out, digest):
    write_bundle(ONE, out)
    lock = json.loads(ONE.files[LOCK])
    lock["files"]["infant.xml"] = digest
    (out / LOCK).write_text(json.dumps(lock))
    with pytest.raises(BundleError, match=r"infant.xml was changed"):
        read_bundle(out)


@pytest.mark.parametrize("manifest", [b"{}", b'{"manifest": 2}', b"[]", b"\xff", b"", b"[" * 200_000])
def test_a_manifest_of_another_version_is_refused_with_a_clear_error(out, manifest):
    files = {"infant.xml": b"", MANIFEST: manifest}
    (out / "assets").mkdir(parents=True)
    for name, content in {**files, LOCK: json.dumps({"files": digests(files)}).encode()}.items():
        (out / name).write_bytes(content)
    with pytest.raises(BundleError, match="this version of mimoc reads manifests of version 1 only; build it again"):
        read_bundle(out)
    assert read_bundle(write_bundle(ONE, out, force=True)).files == ONE.files


# Nothing is lost.


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_that_is_not_a_bundle_is_never_replaced(out, force):
    out.mkdir()
    (out / "thesis.tex").write_text("months of work")
    with pytest.raises(BundleError, match="this folder is not a bundle and is never replaced; name a new folder"):
        write_bundle(ONE, out, force=force)
    assert contents(out.parent) == {"infant/thesis.tex": b"months of work"}


@pytest.mark.parametrize("force", [False, True])
def test_a_file_is_never_replaced(out, force):
    out.write_text("work")
    with pytest.raises(BundleError, match="this is a file; name a new folder"):
        write_bundle(ONE, out, force=force)
    assert contents(out.parent) == {"infant": b"work"}


def test_a_bundle_is_replaced_only_with_force(out):
    write_bundle(ONE, out)
    with pytest.raises(BundleError) as error:
        write_bundle(TWO, out)
    assert str(error.value) == f"{out}: a bundle already exists here; replace it with --force, or name a new folder"
    assert read_bundle(out).files == ONE.files
    write_bundle(TWO, out, force=True)
    assert read_bundle(out).files == TWO.files
    assert os.listdir(out.parent) == [out.name]


def test_a_damaged_bundle_can_be_built_again(out):
    write_bundle(ONE, out)
    (out / "infant.xml").unlink()
    write_bundle(ONE, out, force=True)
    assert read_bundle(out).files == ONE.files


def test_an_empty_folder_can_be_written_to(out):
    out.mkdir()
    write_bundle(ONE, out)
    assert read_bundle(out).files == ONE.files


# Any way to name a folder.


def test_a_link_is_followed_and_stays_a_link(out, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(out)
    for whole, force in ((ONE, False), (TWO, True)):
        assert write_bundle(whole, link, force=force) == link
        assert link.is_symlink()
        assert read_bundle(link).files == read_bundle(out).files == whole.files
    assert set(os.listdir(tmp_path)) == {"builds", "link"}
    assert os.listdir(out.parent) == [out.name]


@pytest.mark.parametrize("name", ["~/infant", "builds/infant", "builds/infant/", "./builds/../builds/infant", "a/b/c"])
def test_home_relative_and_missing_folders_are_accepted(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    write_bundle(ONE, name)
    write_bundle(TWO, name, force=True)
    assert read_bundle(name).files == TWO.files
    assert len(list(tmp_path.rglob(LOCK))) == 1


def test_the_working_directory_is_never_replaced(out, monkeypatch):
    """A shell in it would be left in a deleted folder."""
    out.mkdir()
    monkeypatch.chdir(out)
    with pytest.raises(BundleError, match="the folder you are in"):
        write_bundle(ONE, ".")
    assert write_bundle(ONE, "inside").exists()


def test_nothing_is_written_outside_the_folder(out):
    stray = replace(ONE, files={**ONE.files, "../stray": b""})
    with pytest.raises(BundleError, match=r"'../stray' is outside the bundle's folder"):
        write_bundle(stray, out)
    assert not out.exists()
    assert os.listdir(out.parent) == []


def test_impossible_names_are_refused(tmp_path):
    with pytest.raises(BundleError, match="cannot have this name"):
        write_bundle(ONE, tmp_path / "no\0name")


@pytest.mark.parametrize("name", ["with blank", "run[1]", "run*", "häschen", "-o", ".hidden", "a" * 100])
def test_unusual_folder_names_are_accepted(tmp_path, name):
    write_bundle(ONE, tmp_path / name)
    write_bundle(TWO, tmp_path / name, force=True)
    assert read_bundle(tmp_path / name).files == TWO.files
    assert os.listdir(tmp_path) == [name]


@pytest.mark.parametrize(
    ("name", "reason"), [("file/out", "File exists|Not a directory"), ("a" * 300, "File name too long")]
)
def test_a_path_that_cannot_be_a_folder_is_named_in_the_error(tmp_path, name, reason):
    (tmp_path / "file").write_text("work")
    with pytest.raises(BundleError, match=rf"cannot be written \(({reason})\); choose another folder"):
        write_bundle(ONE, tmp_path / name)
    assert contents(tmp_path) == {"file": b"work"}


def test_the_home_of_an_unknown_user_is_an_ordinary_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_bundle(ONE, "~nobody_of_that_name/out")
    assert read_bundle("~nobody_of_that_name/out").files == ONE.files


def test_permissions_are_those_of_the_users_mask(out):
    kept = os.umask(0o027)
    try:
        write_bundle(ONE, out)
    finally:
        os.umask(kept)
    assert {oct(path.stat().st_mode & 0o777) for path in (out, out / "assets")} == {"0o750"}
    assert {oct((out / name).stat().st_mode & 0o777) for name in ONE.files} == {"0o640"}


# What is interrupted leaves nothing.


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
@pytest.mark.parametrize("step", range(len(ONE.files) + 1))
def test_a_failed_write_leaves_what_was_there(out, monkeypatch, force, failure, step):
    """At every file, and when the finished folder is to be moved."""
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


# Builds that are killed or race with each other: a process that has loaded mimoc forks builders.

BUILDERS = """
import os, signal, sys
from mimoc.bundle.io import read_bundle, write_bundle
from mimoc.errors import BundleError

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
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(timeout=10)


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
    ours = bundle_io._staging_prefix(tmp_path / name)
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


# Two folders change places.


@pytest.fixture
def folders(tmp_path) -> tuple[Path, Path]:
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
        (folder / "name").write_text(folder.name)
    return first, second


def names(*folders: Path) -> list[str]:
    return [(folder / "name").read_text() for folder in folders]


def refuse(number: int) -> Callable[..., None]:
    def function(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return function


def test_two_folders_are_swapped(folders):
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]


@pytest.mark.parametrize("number", [errno.ENOSYS, errno.EINVAL, errno.ENOTSUP])
def test_two_folders_are_swapped_if_the_system_has_no_atomic_swap(folders, monkeypatch, number):
    monkeypatch.setattr(atomic_swap, "_swap_at_once", refuse(number))
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]
    assert len(os.listdir(folders[0].parent)) == 2


def test_two_folders_are_swapped_on_an_unknown_system(folders, monkeypatch):
    monkeypatch.setattr(sys, "platform", "plan9")
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]


def test_a_failed_swap_without_atomic_swap_restores_both_folders(folders, monkeypatch):
    monkeypatch.setattr(atomic_swap, "_swap_at_once", refuse(errno.EINVAL))
    rename = os.rename
    monkeypatch.setattr(os, "rename", lambda a, b: refuse(errno.EIO)() if a == folders[0] else rename(a, b))
    with pytest.raises(OSError, match=os.strerror(errno.EIO)):
        swap_folders(*folders)
    assert names(*folders) == ["first", "second"]


def test_other_failures_of_a_swap_are_raised(folders, monkeypatch):
    with pytest.raises(FileNotFoundError):
        swap_folders(folders[0], folders[1] / "nothing")
    monkeypatch.setattr(atomic_swap, "_swap_at_once", refuse(errno.EACCES))
    with pytest.raises(PermissionError):
        swap_folders(*folders)
    assert names(*folders) == ["first", "second"]


def test_a_bundle_is_replaced_without_atomic_swap_too(out, monkeypatch):
    write_bundle(ONE, out)
    monkeypatch.setattr(atomic_swap, "_swap_at_once", refuse(errno.EINVAL))
    write_bundle(TWO, out, force=True)
    assert read_bundle(out).files == TWO.files
    assert os.listdir(out.parent) == [out.name]
