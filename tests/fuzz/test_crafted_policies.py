"""Every policy that was ever made to do harm is refused in one line, and no code of it runs."""

import os

import pytest
from fuzz import policies
from fuzz.crafted_policies import CRAFTED, packed, ran
from fuzz.fuzzing import is_clear

from mimoc.base.errors import PolicyError


@pytest.fixture(scope="session")
def honest(tmp_path_factory):
    """Return the members of an honest policy, and the environment of its infant."""
    return policies.prepare(tmp_path_factory.mktemp("trained"))


def refusal(path, env) -> str:
    with pytest.raises(PolicyError) as error:
        policies.use(path, env)
    assert is_clear(error.value)
    return str(error.value)


@pytest.mark.parametrize("name", CRAFTED)
def test_a_crafted_policy_is_refused_in_one_line(name, honest, tmp_path):
    (members, env), (craft, said) = honest, CRAFTED[name]
    changed = dict(members)
    craft(changed)
    (tmp_path / "policy.zip").write_bytes(packed(changed))
    assert said in refusal(tmp_path / "policy.zip", env)
    assert not ran()


def test_a_policy_that_is_a_pipe_is_not_waited_for(honest, tmp_path):
    os.mkfifo(tmp_path / "policy.zip")
    assert "there is no such file" in refusal(tmp_path / "policy.zip", honest[1])


def test_an_honest_policy_is_used(honest, tmp_path):
    (tmp_path / "policy.zip").write_bytes(packed(honest[0]))
    policies.use(tmp_path / "policy.zip", honest[1])
