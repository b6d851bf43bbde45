"""`mimoc doctor` says what works here, what is not installed, and what is broken."""

import os
import tomllib
from pathlib import Path

import pytest

import mimoc
from mimoc.cli import doctor

ROOT = Path(__file__).parents[2]


@pytest.fixture
def findings(invoke, monkeypatch):
    """Return what runs the command under some variables, and returns its exit code and its lines by their subject."""

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
