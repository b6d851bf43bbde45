"""Two folders change places at once, or by taking turns where the system cannot do that."""

import errno
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.bundles import ONE, TWO

from mimoc.bundle import swap as exchange_module
from mimoc.bundle.folder import (
    read_bundle,
    write_bundle,
)
from mimoc.bundle.swap import exchange


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


def test_folders_change_places(folders):
    exchange(*folders)
    assert names(*folders) == ["second", "first"]


@pytest.mark.parametrize("number", [errno.ENOSYS, errno.EINVAL, errno.ENOTSUP])
def test_folders_change_places_where_the_system_cannot_do_it_at_once(folders, monkeypatch, number):
    monkeypatch.setattr(exchange_module, "_exchange_at_once", refuse(number))
    exchange(*folders)
    assert names(*folders) == ["second", "first"]
    assert len(os.listdir(folders[0].parent)) == 2


def test_a_system_that_is_not_known_takes_turns(folders, monkeypatch):
    monkeypatch.setattr(sys, "platform", "plan9")
    exchange(*folders)
    assert names(*folders) == ["second", "first"]


def test_taking_turns_puts_back_what_was_there_if_it_fails(folders, monkeypatch):
    monkeypatch.setattr(exchange_module, "_exchange_at_once", refuse(errno.EINVAL))
    rename = os.rename
    monkeypatch.setattr(os, "rename", lambda a, b: refuse(errno.EIO)() if a == folders[0] else rename(a, b))
    with pytest.raises(OSError, match=os.strerror(errno.EIO)):
        exchange(*folders)
    assert names(*folders) == ["first", "second"]


def test_other_failures_are_not_worked_around(folders, monkeypatch):
    with pytest.raises(FileNotFoundError):
        exchange(folders[0], folders[1] / "nothing")
    monkeypatch.setattr(exchange_module, "_exchange_at_once", refuse(errno.EACCES))
    with pytest.raises(PermissionError):
        exchange(*folders)
    assert names(*folders) == ["first", "second"]


def test_a_bundle_is_replaced_also_by_taking_turns(out, monkeypatch):
    write_bundle(ONE, out)
    monkeypatch.setattr(exchange_module, "_exchange_at_once", refuse(errno.EINVAL))
    write_bundle(TWO, out, force=True)
    assert read_bundle(out).files == TWO.files
    assert os.listdir(out.parent) == [out.name]
