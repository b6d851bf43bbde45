"""Meshes processed without coacd, and without a process for each."""

import pytest

from mimoc.components.toys.toys4k import build, meshes, processing, worker


@pytest.fixture
def without_coacd(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (meshes, build):
        monkeypatch.setattr(module, "has_coacd", lambda: False)


@pytest.fixture
def quickly(without_coacd: None, reading_here: None) -> None:
    """Have toys made as fast as can be."""


@pytest.fixture
def reading_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read files here, not in a process of its own, as most of the time goes into starting it."""

    def read(task: str, content: bytes, *arguments: object, limit_s: int) -> worker.Arrays:
        try:
            return worker.TASKS[task](content, *map(str, arguments))
        except worker.RefusedError as error:
            raise worker.WorkerError(str(error)) from None

    monkeypatch.setattr(processing, "run_worker", read)
