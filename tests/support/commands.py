"""Commands of mimoc, run in this process or in one of their own."""

import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import pytest

from mimoc import cli


class Outcome(NamedTuple):
    code: int  # The exit code.
    out: str
    err: str


@pytest.fixture
def invoke(monkeypatch, capfd) -> Callable[..., Outcome]:
    """Return what runs a command in this process, given its arguments and what is piped into it."""

    def run(*arguments: object, piped: str | None = None) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["mimoc", *map(str, arguments)])
        if piped is not None:
            monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(piped.encode())))
        capfd.readouterr()
        try:
            cli.main()
            code = 0
        except SystemExit as exit_:
            code = int(exit_.code or 0)
        sys.stdout.flush()
        return Outcome(code, *capfd.readouterr())

    return run


def process(*arguments: object, **options: Any) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "mimoc", *map(str, arguments)]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    heeding = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # What runs the tests may have it ignored.
    return subprocess.Popen(command, **pipes | {"preexec_fn": heeding} | options)


def drained(terminal: int) -> bytes:
    left = b""
    try:
        while some := os.read(terminal, 1024):
            left += some
    except OSError:
        pass  # Linux's way of saying that it is at its end.
    return left


def finished(*arguments: object, **environment: str) -> Outcome:
    """Return what a command in a process of its own did, under some environment variables."""
    running = process(*arguments, env=os.environ | environment)
    out, err = running.communicate()
    return Outcome(running.returncode, out, err)


ONE_AFTER_THE_OTHER = """
import itertools, sys
from mimoc import cli

for is_end, arguments in itertools.groupby(sys.argv[1:], ";".__eq__):
    if is_end:
        continue
    sys.argv = ["mimoc", *arguments]
    try:
        cli.main()
        code = 0
    except SystemExit as exit_:
        code = exit_.code or 0
    print(f"\\f{code}", end="\\f", flush=True)
    print("\\f", end="", file=sys.stderr, flush=True)
"""
"""Runs the commands that semicolons end; form feeds end what each of them says."""


def finished_together(*commands: list[object], **environment: str) -> list[Outcome]:
    """Return what some commands did, one after the other in one process, which takes less time than one for each."""
    told = [str(argument) for command in commands for argument in (*command, ";")]
    command = [sys.executable, "-c", ONE_AFTER_THE_OTHER, *told]
    done = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=True)
    outs, errs = done.stdout.split("\f")[:-1], done.stderr.split("\f")[:-1]
    return [Outcome(int(code), out, err) for out, code, err in zip(outs[::2], outs[1::2], errs, strict=True)]
