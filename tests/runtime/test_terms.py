"""Every term keeps the contract that lets it run on one infant, on many, and on a device."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.terms import check_terms

import mimoc
from mimoc.runtime.contract import TermError, check_term
from mimoc.runtime.term import Concatenated, Field, Term, differing_field, stack_terms
from mimoc.runtime.worlds import worlds_of_one

CONFIGS = Path(mimoc.__file__).parents[1] / "configs"
KINDS = ("nine_months", "muscle", "individual", "newborn", "catch", "reach", "rollover", "selfbody", "standup")
"""Configs that have all tasks and actuation models, with and without `maturing`, noise and delays."""


@pytest.fixture(scope="module")
def env():
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}, "vestibular": {}}}
    with mimoc.make(mimoc.InfantSpec.model_validate(spec)) as opened:
        yield opened.unwrapped


@pytest.mark.extras
@pytest.mark.parametrize("config", KINDS)
def test_every_term_of_every_kind_keeps_the_contract(config):
    spec = mimoc.load_spec(CONFIGS / f"{config}.yaml")
    env = mimoc.InfantEnv(mimoc.build(spec.with_(senses={"vision": None}, body={"skin": False})))
    checked = check_terms(env)
    assert {f"sense {name}" for name in env.senses if name != "touch"} <= set(checked)
    assert ("task" in checked) == (env.manifest.task.kind != "free")
    env.close()


@dataclass(frozen=True)
class Faulty(Term):
    """A term whose expression is given, to be wrong."""

    expression: Any
    head: Any
    most: Any

    def __call__(self, worlds, *args):
        return self.expression(worlds, self.head, self.most)


@pytest.mark.extras
@pytest.mark.parametrize(
    ("text", "expression"),
    [
        ("of one infant is not row 0 of 7", lambda worlds, head, most: worlds.qpos - worlds.qpos.mean()),
        ("does not run with array_api_strict", lambda worlds, head, most: worlds.xpos[:, head, 2] * most),
        ("the result is ndarray, not an array of worlds.xp", lambda worlds, head, most: np.take(worlds.qpos, head, 1)),
        (
            "does not run with torch's FakeTensorMode",
            lambda worlds, head, most: worlds.qpos if bool(worlds.qpos[0, 2] < 99.0) else worlds.qvel,
        ),
        (
            "with torch is not within 1e-05 of NumPy",
            lambda worlds, head, most: (worlds.qpos[:, :3] + 1e6) - 1e6,
        ),
        ("does not run with NumPy: AttributeError: worlds have no array 'efc_force'", lambda w, h, m: w.efc_force),
    ],
)
def test_a_term_that_breaks_it_is_told_how(env, text, expression):
    with pytest.raises(TermError) as raised:
        check_term(Faulty(expression, np.array([3]), np.array([0.5])), env.model)
    assert text in str(raised.value)
    assert "\n" not in str(raised.value)


@dataclass(frozen=True)
class SelfContacts(Term):
    """Which of the groups of geoms press on which."""

    group_of_geom: np.ndarray

    def __call__(self, worlds, *args):
        return worlds.pressing(self.group_of_geom)


@pytest.mark.extras
def test_what_presses_on_what_is_checked_too(env):
    groups = np.arange(env.model.ngeom) % 5
    check_term(SelfContacts(groups), env.model)
    with pytest.raises(TermError, match="does not run with NumPy: IndexError"):
        check_term(SelfContacts(groups[:2]), env.model)


def test_addresses_are_shared_and_amounts_are_rows():
    terms = [Faulty(None, np.array([3]), amount) for amount in (np.array([1.0, 2.0]), np.array([3.0, 4.0]))]
    stacked = stack_terms(terms)
    assert stacked.most.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert stacked.head.tolist() == [3]


def test_terms_whose_addresses_differ_cannot_be_stacked():
    pair = [Concatenated((Field("qpos", np.array([1])), Faulty(None, np.array([n]), 0.5))) for n in (3, 4)]
    assert differing_field([pair[0], pair[0]]) is None
    assert differing_field(pair) == "terms.head"
    assert differing_field([pair[0], pair[0].terms[0]]) == "kind"


def test_worlds_of_one_infant_show_its_later_states(env):
    env.reset(seed=0)
    worlds = worlds_of_one(env.data)
    before = worlds.qpos.copy()
    env.step(env.action_space.high)
    assert (worlds.qpos[0] == env.data.qpos).all()
    assert not (worlds.qpos == before).all()
    assert worlds.xmat.shape == (1, env.model.nbody, 3, 3)
