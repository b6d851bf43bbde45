"""Two folders change places at once, or by taking turns where the system cannot do that."""

import errno
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.bundles import ONE, TWO

from mimoc.bundle import files
from mimoc.bundle.files import swap_folders
from mimoc.bundle.io import read_bundle, write_bundle


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
    monkeypatch.setattr(files, "_swap_at_once", refuse(number))
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]
    assert len(os.listdir(folders[0].parent)) == 2


def test_two_folders_are_swapped_on_an_unknown_system(folders, monkeypatch):
    monkeypatch.setattr(sys, "platform", "plan9")
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]


def test_a_failed_swap_without_atomic_swap_restores_both_folders(folders, monkeypatch):
    monkeypatch.setattr(files, "_swap_at_once", refuse(errno.EINVAL))
    rename = os.rename
    monkeypatch.setattr(os, "rename", lambda a, b: refuse(errno.EIO)() if a == folders[0] else rename(a, b))
    with pytest.raises(OSError, match=os.strerror(errno.EIO)):
        swap_folders(*folders)
    assert names(*folders) == ["first", "second"]


def test_other_failures_of_a_swap_are_raised(folders, monkeypatch):
    with pytest.raises(FileNotFoundError):
        swap_folders(folders[0], folders[1] / "nothing")
    monkeypatch.setattr(files, "_swap_at_once", refuse(errno.EACCES))
    with pytest.raises(PermissionError):
        swap_folders(*folders)
    assert names(*folders) == ["first", "second"]


def test_a_bundle_is_replaced_without_atomic_swap_too(out, monkeypatch):
    write_bundle(ONE, out)
    monkeypatch.setattr(files, "_swap_at_once", refuse(errno.EINVAL))
    write_bundle(TWO, out, force=True)
    assert read_bundle(out).files == TWO.files
    assert os.listdir(out.parent) == [out.name]
