"""Classes of a user's own as policies of commands."""

import sys
from pathlib import Path

import pytest
from support.worlds import ANNA, written

import mimoc
from mimoc.policies.class_policy import class_or_text, is_class

MODULE = """
import numpy as np


class Still:
    made = 0

    def __init__(self, env):
        Still.made += 1
        self.size = env.action_space.shape[0]

    def act(self, observation):
        return np.zeros(self.size)


class Least(Still):
    def __init__(self, observation_space, action_space):
        self.low = action_space.low

    def act(self, observation):
        return self.low


class Silent(Still):
    def act(self, observation):
        return None
"""
NAME = "policies_of_a_test"


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """Return the current folder, with a module and a spec in it."""
    monkeypatch.chdir(tmp_path)
    sys.modules.pop(NAME, None)
    (tmp_path / f"{NAME}.py").write_text(MODULE)
    written(tmp_path, "infants: [anna.yaml, {spec: anna.yaml, name: ben}]\n", anna=ANNA)
    return tmp_path


def test_a_run_acts_by_a_class_which_is_recorded_and_replayed(invoke, folder):
    done = invoke("run", "anna.yaml", "--policy", f"{NAME}:Still", "--steps", "4", "--record", "recorded")
    assert done.code == 0, done.err
    actions = mimoc.read_recording(folder / "recorded")[0].actions
    assert actions.shape[0] == 4
    assert not actions.any()
    assert invoke("replay", "recorded").code == 0


def test_each_infant_of_a_world_has_an_object_of_the_class(invoke, folder):
    assert invoke("run", "world.yaml", "--policy", f"{NAME}:Still", "--steps", "2").code == 0
    assert sys.modules[NAME].Still.made == 2


def test_a_class_may_take_spaces(invoke, folder):
    assert invoke("run", "anna.yaml", "--policy", f"{NAME}:Least", "--steps", "2").code == 0


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        (f"{NAME}:Silent", f"'{NAME}:Silent': act must return an array of (44,) finite numbers, not of () object"),
        (f"{NAME}:Nobody", f"'{NAME}:Nobody': the module has no class 'Nobody'"),
        (
            "no_module:Still",
            "'no_module:Still': No module named 'no_module'; run this command in the folder of the module",
        ),
        ("reech_for:toy", "'reech_for' is not a policy; did you mean 'reach_for'?"),
    ],
)
def test_what_is_no_such_class_is_told_in_one_line(invoke, folder, policy, said):
    for file in ("anna.yaml", "world.yaml"):
        done = invoke("run", file, "--policy", policy, "--steps", "2")
        assert (done.code, done.err.splitlines()[-1]) == (2, said)


def test_only_a_command_takes_a_class(folder):
    """What reads policies from files gets texts, which name no class."""
    assert is_class(f"{NAME}:Still")
    assert class_or_text("reach_for:toy") == "reach_for:toy"
    env = mimoc.make("anna.yaml")
    with pytest.raises(mimoc.MimocError, match=f"'{NAME}' is not a policy"):
        mimoc.record(env, f"{NAME}:Still", "film.gif", steps=1)
    env.close()
    assert NAME not in sys.modules
