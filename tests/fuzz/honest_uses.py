"""Everything that an infant is used for: what costs little, always, and `DEAR`, of which one at a time is done."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fuzz.fuzzing import check_clear
from fuzz.honest_cohorts import called
from fuzz.mutations import pick
from support.pages import few_ages
from support.same import assert_same

import mimoc
from mimoc.base.errors import MimocError
from mimoc.bundle.provenance import PROVENANCE, unpacked
from mimoc.compiler.explain import explain
from mimoc.recording.recorder import Recorder
from mimoc.schema.infant import read_spec
from mimoc.schema.source import in_memory

SEED, STEPS = 3, 3


def check(data: Mapping[str, Any], dear: Sequence[str], generator: np.random.Generator, folder: Path) -> None:
    """Build the infant of a spec, explain it, let it live twice, restore its states, and put it to some dear uses.

    Raises:
        Exception: Of any kind, if anything fails.
    """
    bundle = mimoc.build(read_spec(in_memory(dict(data), "<spec>", Path())))
    mimoc.write_bundle(bundle, folder / "bundle")
    opened = mimoc.read_bundle(folder / "bundle")
    explain_some(opened, generator)
    env = mimoc.make(folder / "bundle")
    try:
        first = life(env)
        assert_same(first, life(env), "reset twice")
        states(env)
        poses(env)
    finally:
        env.close()
    for use in dear:
        DEAR[use](folder / "bundle", generator, first)


def explain_some(bundle: mimoc.Bundle, generator: np.random.Generator) -> None:
    """Explain some numbers of a bundle; all of them can be only if none is made from what is not there."""
    keys = sorted(unpacked(json.loads(bundle.files[PROVENANCE])))
    for key in (pick(generator, keys), pick(generator, keys)):
        assert explain(bundle, key).lines


def life(env: Any) -> list[Any]:
    """Return all that comes of a reset and some steps, which must be within the spaces."""
    observation, _ = env.reset(seed=SEED)
    assert env.observation_space.contains(observation), "the first observation is not in its space"
    env.action_space.seed(SEED)
    seen = [observation]
    for _ in range(STEPS):
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        assert env.observation_space.contains(observation), "an observation is not in its space"
        assert np.isfinite(reward), "a reward is no number"
        assert not info["unstable"], "it is unstable"
        seen += [observation, reward, terminated]
        if terminated or truncated:
            break
    return seen


def states(env: Any) -> None:
    env.reset(seed=SEED)
    inside, action = env.unwrapped, env.action_space.sample()
    inside.step(action)
    kept, once = inside.get_state(), inside.step(action)
    inside.step(action)
    inside.set_state(kept)
    assert_same(once[:3], inside.step(action)[:3], "after a state was restored")


def poses(env: Any) -> None:
    for pose in env.unwrapped.manifest.poses:
        observation, _ = env.reset(options={"pose": pose})
        assert env.observation_space.contains(observation), f"{pose}: the first observation is not in its space"


def record(bundle: Path, _: np.random.Generator, __: Any) -> None:
    places = [bundle.parent / "recording", bundle.parent / "again"]
    for place in places:
        with Recorder(mimoc.make(bundle), place) as env:
            life(env)
    files = sorted(path.relative_to(places[0]) for path in places[0].rglob("*") if path.is_file())
    differing = [str(path) for path in files if len({(place / path).read_bytes() for place in places}) > 1]
    assert not differing, f"two recordings with one seed differ: {differing}"
    assert "came out again" in called("replay", places[0])
    with few_ages():
        called("view", places[0], "-o", bundle.parent / "recording.html", "--no-open")


def grow(bundle: Path, generator: np.random.Generator, _: Any) -> None:
    """Grow in an episode, and begin one at another age; where there is no such infant, it says so and stays."""
    with mimoc.make(bundle) as env:
        env.reset(seed=SEED)
        infant: Any = env.unwrapped
        for grown in (lambda age: infant.grow(to=age), lambda age: env.reset(options={"age_months": age})[0]):
            age_months = round(float(generator.uniform(0, 24)), 1)
            try:
                observation = grown(age_months)
            except MimocError as error:
                check_clear(error)
            else:
                assert env.observation_space.contains(observation), "it has grown out of its space"
            env.step(env.action_space.sample())


def batch(bundle: Path, _: np.random.Generator, alone: Any) -> None:
    """Let two live side by side, of which the first does what it does alone."""
    many: Any = mimoc.make_vec(bundle, 2)
    try:
        observation, _ = many.reset(seed=SEED)
        one = many.single_action_space
        one.seed(SEED)
        assert_same(alone[0], _of_first(observation), "the first of two, at the start")
        for expected in alone[1::3]:
            observation = many.step(np.stack([one.sample()] * 2))[0]
            assert_same(expected, _of_first(observation), "the first of two")
    finally:
        many.close()


def _of_first(observation: Any) -> dict[str, Any]:
    return {name: np.array(values[0]) for name, values in observation.items()}


def _command(*words: str) -> Callable[[Path, np.random.Generator, Any], None]:
    def use(bundle: Path, _: np.random.Generator, __: Any) -> None:
        called(*(word.format(bundle=bundle, page=bundle.parent / "page.html") for word in words))

    return use


DEAR: Mapping[str, Callable[[Path, np.random.Generator, Any], None]] = {
    "check": _command("check", "{bundle}"),
    "run": _command("run", "{bundle}", "--steps", "3", "--policy", "random"),
    "record": record,
    "view": _command("view", "{bundle}", "-o", "{page}", "--no-open"),
    "report": _command("report", "{bundle}", "-o", "{page}"),
    "grow": grow,
    "batch": batch,
}
"""Uses that take longer than all others together, by name; they get the folder of a bundle, random numbers, and what
came of an environment of it."""
