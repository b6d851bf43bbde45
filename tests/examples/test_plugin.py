"""The plug-in of `examples/plugin`, installed from its wheel: every command knows its kinds."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from support.full import FULL
from support.installed import Program, build_wheel, install

PLUGIN = Path(__file__).parents[2] / "examples" / "plugin"
SPEC = PLUGIN / "kicking.yaml"
Run = Callable[..., str]


@pytest.fixture(scope="module")
def program(wheel, tmp_path_factory) -> Program:
    """Return what runs a program of an environment with mimoc and the plug-in."""
    nursery = build_wheel(PLUGIN, tmp_path_factory.mktemp("plugin"))
    return install(tmp_path_factory.mktemp("environment"), wheel, nursery)


@pytest.fixture(scope="module")
def run(program) -> Run:
    """Return what runs a program that succeeds, and gives what it prints."""

    def run(*arguments: object) -> str:
        done = program(*arguments)
        assert done.returncode == 0, f"{arguments}: {done.stdout}{done.stderr}"
        return done.stdout

    return run


@pytest.fixture(scope="module")
def built(run, tmp_path_factory) -> Path:
    """Return the bundle of the plug-in's spec."""
    folder = tmp_path_factory.mktemp("bundles") / "kicking"
    run("mimoc", "build", SPEC, "-o", folder)
    return folder


@pytest.mark.full
def test_a_bundle_says_which_kinds_come_from_where(built):
    manifest = json.loads((built / "manifest.json").read_text())
    kinds = ("senses.sound", "tasks.kick", "toys.blocks")
    assert manifest["plugins"] == dict.fromkeys(kinds, "mimoc-nursery")
    assert {toy["category"] for toy in manifest["toys"]} <= {"cube", "slab", "column"}


@pytest.mark.full
def test_the_sense_has_spec_keys_and_a_delay_that_are_explained(run, built):
    explained = run("mimoc", "explain", built, "delays.sound.ms")
    assert "delays.sound.ms = 10 ms" in explained
    assert "spec.delays.preset = physiological" in explained
    assert "sound.level_db = 55 dB" in run("mimoc", "explain", built, "sound.level_db")


@FULL
def test_the_policy_moves_the_mobile_and_is_in_the_help(run, built):
    assert "rhythm" in " ".join(run("mimoc", "run", "--help").split())
    summary = run("mimoc", "run", built, "--policy", "rhythm", "--steps", 200)
    assert float(re.search(r"total reward ([\d.]+)", summary)[1]) > 5
    assert "Distance between the hands [lengths]" in summary


@FULL
def test_the_growth_of_the_spec_is_validated(run):
    assert "length" in run("mimoc", "validate", SPEC, "--against", "who")


@FULL
def test_an_infant_learns_the_task(run, built, tmp_path):
    run("mimoc", "train", built, "--steps", 64, "--envs", 1, "-o", tmp_path / "training")
    assert (tmp_path / "training" / "policy.zip").exists()


CODE = """
import gymnasium, json, mimoc, numpy as np
env = gymnasium.make("mimoc/Kick-v0", age_months=3, foot="left", steps=60)
env.action_space.seed(0)
observation, _ = env.reset(seed=0)
rewards = [env.step(env.action_space.sample())[1:4:2] for _ in range(60)]
heard = mimoc.make({spec!r}).reset(seed=0)[0]["sound"].reshape(3, 5)
print(json.dumps([rewards, heard.tolist()]))
"""


@pytest.mark.full
def test_gymnasium_makes_the_task_and_the_loudest_toys_are_heard_first(run):
    rewards, heard = json.loads(run("python", "-c", CODE.format(spec=str(SPEC))))
    assert [truncated for _, truncated in rewards] == [False] * 59 + [True]
    assert max(reward for reward, _ in rewards) > 0
    loudest = [max(left_db, right_db) for left_db, right_db, *_ in heard]
    assert loudest == sorted(loudest, reverse=True)
    for left_db, right_db, x, y, z in heard:
        assert (left_db > right_db) == (y > 0)
        assert x**2 + y**2 + z**2 == pytest.approx(1, abs=1e-5)


@pytest.mark.full
def test_bad_input_for_a_plug_in_is_a_clear_error(program, tmp_path):
    spec = tmp_path / "wrong.yaml"
    text = SPEC.read_text().replace("sources: 3", "sorces: 3").replace("foot: left", "foot: both")
    spec.write_text(text.replace("source: blocks", "source: blokcs"))
    done = program("mimoc", "build", spec, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "senses.sound.sorces: unknown key; did you mean 'sources'?" in done.stderr
    assert "task.foot: 'both' is not a choice; choose from left, right" in done.stderr
    assert "scene.toys.source: 'blokcs' is not a choice; did you mean 'blocks'?" in done.stderr
    assert not (tmp_path / "out").exists()


@FULL
def test_without_the_plug_in_its_bundle_says_what_is_missing(built, wheel, tmp_path):
    done = install(tmp_path / "bare", wheel)("mimoc", "run", built)
    assert done.returncode == 2
    assert "this bundle needs the sense 'sound' from the plug-in 'mimoc-nursery', which is not here" in done.stderr
    assert "Traceback" not in done.stderr
