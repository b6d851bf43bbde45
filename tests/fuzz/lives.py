"""Lives of environments, whose methods are called in any order, also after they were closed, by a state machine.

`python tests/fuzz/lives.py --sequences 1000` lives them in processes of their own, where a signal is a fault. A batch
that fails can be lived again: `python tests/fuzz/lives.py many --seed 3 --sequences 25`.
"""

import argparse
import copy
import gc
import json
import os
import pickle
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from gymnasium.error import ClosedEnvironmentError
from hypothesis import HealthCheck, Phase, seed, settings, strategies as some
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)
from stable_baselines3.common.monitor import Monitor
from support.forks import status_of_fork

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.render.renderer import Renderer

TESTS = Path(__file__).parents[1]
CONFIGS = TESTS.parent / "configs"
BATCH, CALLS, LONGEST_S = 25, 12, 600
"""Sequences of a process, calls of a sequence at most, and how long a process may take."""
AGES_MONTHS = (6, 9)
SIZE: dict[str, Any] = {"render_mode": "rgb_array", "width": 64, "height": 64}
NOISY_ROOM = {
    "senses": {
        "proprioception": {},
        "touch": {"density": 0.1},
        "vision": {"width_px": 16, "height_px": 16, "body": "skin"},
    },
    "delays": {"preset": "physiological"},
    "noise": {"motor": 0.2, "proprioception_deg": 1.0, "touch_n": 0.05, "delay_jitter_ms": 10.0},
    "scene": {"kind": "room", "pose": "sitting", "toys": {"source": "builtin", "count": [3, 3]}},
}


@cache
def bundle(name: str) -> mimoc.Bundle:
    """Return an infant of `configs/`, or one in a room."""
    if name == "room":
        spec = {"mimoc": 1, "name": "infant", "age_months": 6, "task": {"kind": "reach"}, **NOISY_ROOM}
        return mimoc.build(mimoc.InfantSpec.model_validate(spec))
    return mimoc.build(mimoc.load_spec(CONFIGS / f"{name}.yaml"))


def alone(name: str) -> Any:
    return mimoc.make(bundle(name), **SIZE).unwrapped


OPENERS: dict[str, Callable[[Path], Any]] = {
    "all_senses": lambda _: alone("all_senses"),
    "room": lambda _: alone("room"),
    "muscle": lambda _: alone("muscle"),
    "growing": lambda _: mimoc.GrowthWrapper(
        mimoc.make(bundle("all_senses"), **SIZE), ages_months=AGES_MONTHS, steps=4
    ),
    "monitor": lambda _: Monitor(mimoc.make(bundle("all_senses"), **SIZE)),
    "recorder": lambda folder: mimoc.Recorder(mimoc.make(bundle("all_senses"), **SIZE), folder),
    "many": lambda _: mimoc.make_vec(bundle("all_senses"), 2, threads=2, **SIZE),
}
"""Environments, by name, and what opens them."""
COPIED = {"all_senses", "room", "muscle"}


class Lives(RuleBasedStateMachine):
    kind: str
    """What is opened."""
    counts: Counter[str]
    """How many sequences and calls there were, and how often a closed environment refused one."""

    def __init__(self) -> None:
        super().__init__()
        self.states: list[Any] = []
        self.folder = tempfile.TemporaryDirectory()

    @initialize()
    def open(self) -> None:
        self.closed: bool | None = False
        """None if only some infants are closed, or a part of one."""
        self.env = OPENERS[self.kind](Path(self.folder.name, str(self.counts.total())))
        self.env.reset(seed=0)

    @property
    def infant(self) -> Any:
        inside = self.env.unwrapped
        return inside.infants[0] if self.kind == "many" else inside

    def call(self, act: Callable[[], Any], *, meanwhile: bool = False) -> None:
        """Call something of the environment, which may only fail if it is closed.

        If it is closed *meanwhile*, any error will do: an environment is for one thread at a time.
        """
        try:
            act()
        except ClosedEnvironmentError:
            assert self.closed is not False, "an open environment says that it is closed"
            self.counts["refused"] += 1
        except Exception:
            if not meanwhile:
                raise
        else:
            assert meanwhile or not self.closed, "a closed environment has done something"

    def act(self, what: str) -> None:
        """Do something that draws, or does not."""
        {
            "reset": lambda: self.env.reset(seed=1),
            "step": lambda: self.env.step(self.env.action_space.sample()),
            "render": lambda: self.env.render(),
            "grow": lambda: (self.env if self.kind == "many" else self.infant).grow(to=AGES_MONTHS[1]),
        }[what]()

    acts = some.sampled_from(["reset", "step", "render", "grow"])

    @rule(what=acts, times=some.integers(1, 3))
    def does(self, what: str, times: int) -> None:
        for _ in range(times):
            self.call(lambda: self.act(what))

    @rule(age_months=some.sampled_from(AGES_MONTHS))
    def is_reset_at_an_age(self, age_months: float) -> None:
        self.call(lambda: self.env.reset(options={"age_months": age_months, "pose": "standing"}))

    @rule()
    def is_looked_at(self) -> None:
        _ = self.infant.skin if "touch" in self.infant.senses else None
        _ = self.env.action_space, self.infant.bundle, self.infant.age_months, self.infant.data.time
        self.call(lambda: (self.infant.keypoints(), self.infant.effort(), self.infant.set_expression("happy")))

    @rule()
    def saves(self) -> None:
        self.states.append(self.env.unwrapped.get_state())

    @precondition(lambda self: self.states)
    @rule(data=some.data())
    def restores(self, data: Any) -> None:
        state = data.draw(some.sampled_from(self.states))
        self.call(lambda: self.env.unwrapped.set_state(state))

    @rule()
    def closes(self) -> None:
        self.env.close()
        self.closed = True
        self.env.close()

    @rule()
    def closes_within(self) -> None:
        self.infant.close()
        self.closed = self.closed or (None if self.kind == "many" else True)

    @precondition(lambda self: self.closed)
    @rule()
    def opens_anew(self) -> None:
        self.open()

    @precondition(lambda self: self.kind in COPIED)
    @rule(by=some.sampled_from([copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))]), stays=some.booleans())
    def is_copied(self, by: Callable[[Any], Any], stays: bool) -> None:
        copied = by(self.env)
        if stays:
            copied.step(copied.action_space.sample())
            copied.close()
        else:
            self.env, self.closed = copied, False

    @rule(what=acts)
    def forks(self, what: str) -> None:
        def live_on() -> None:
            self.call(lambda: self.act(what))
            self.env.unwrapped.close()

        assert (status := status_of_fork(live_on)) == 0, f"a forked process ended with status {status}"

    @rule(what=acts)
    def acts_in_a_thread(self, what: str) -> None:
        with in_a_thread(lambda: self.call(lambda: self.act(what))):
            pass

    @rule(what=acts)
    def closes_meanwhile(self, what: str) -> None:
        before, self.closed = self.closed, None
        with in_a_thread(lambda: self.call(lambda: self.act(what), meanwhile=True)), suppress(RenderingError):
            self.env.unwrapped.close()
        self.closed = before
        self.closes()

    @rule()
    def is_forgotten(self) -> None:
        self.env.unwrapped.itself = self.env.unwrapped
        self.open()
        draw = Renderer.draw
        with mock.patch.object(Renderer, "draw", lambda *drawn: (gc.collect(), draw(*drawn))):
            check_other()

    @invariant()
    def is_counted(self) -> None:
        self.counts["calls"] += 1

    def teardown(self) -> None:
        check_other()
        self.env.close()
        self.folder.cleanup()
        self.counts["sequences"] += 1


@cache
def other() -> tuple[Any, Any]:
    env = alone("all_senses")
    env.reset(seed=0)
    return env, env.render()


def check_other() -> None:
    """Check that an environment that has nothing to do with any of this looks as before."""
    env, picture = other()
    assert np.array_equal(env.render(), picture), "the picture of another environment has changed"


@contextmanager
def in_a_thread(act: Callable[[], Any]) -> Iterator[None]:
    failed: list[BaseException] = []

    def caught() -> None:
        try:
            act()
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=caught)
    thread.start()
    yield
    thread.join()
    if failed:
        raise failed[0]


def live(kind: str, number: int, sequences: int) -> Counter[str]:
    """Live some sequences in this process; return how many calls there were."""
    machine: Any = type("Lives", (Lives,), {"kind": kind, "counts": Counter()})
    run_state_machine_as_test(
        seed(number)(machine),
        settings=settings(
            max_examples=sequences,
            stateful_step_count=CALLS,
            database=None,
            deadline=None,
            phases=[Phase.generate, Phase.shrink],
            suppress_health_check=list(HealthCheck),
        ),
    )
    return machine.counts


def live_apart(kind: str, number: int, sequences: int) -> tuple[Counter[str], str]:
    """Live some sequences in a process of their own; return its counts, and what failed."""
    command = [sys.executable, "-X", "faulthandler", __file__, kind, "--worker"]
    command += ["--seed", str(number), "--sequences", str(sequences)]
    paths = {**os.environ, "PYTHONPATH": str(TESTS)}
    done = subprocess.run(command, env=paths, capture_output=True, text=True, timeout=LONGEST_S, check=False)
    if done.returncode:
        what = f"signal {-done.returncode}" if done.returncode < 0 else "a failure"
        return Counter(), f"{kind} --seed {number} --sequences {sequences}: {what}\n{done.stderr[-6000:]}"
    return Counter(json.loads(done.stdout.splitlines()[-1])), ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", help=f"of {', '.join(OPENERS)}; all by default")
    parser.add_argument("--sequences", type=int, default=1000, help="of all kinds together")
    parser.add_argument("--seed", type=int, default=0, help="of the first process")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.worker:
        print(json.dumps(live(asked.kinds[0], asked.seed, asked.sequences)))
        return 0
    kinds, faults, counts = asked.kinds or list(OPENERS), 0, Counter[str]()
    for number in range(asked.seed, asked.seed + -(-asked.sequences // BATCH)):
        left = asked.sequences - (number - asked.seed) * BATCH
        counted, fault = live_apart(kinds[(number - asked.seed) % len(kinds)], number, min(BATCH, left))
        counts += counted
        faults += bool(fault)
        print(fault or f"{number}: {kinds[(number - asked.seed) % len(kinds)]}: {dict(counted)}", flush=True)
    print(
        f"{counts['sequences']:,} sequences, {counts['calls']:,} calls, {counts['refused']:,} refused, {faults} faults"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
