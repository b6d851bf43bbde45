"""The terms that an environment is made of, for the contract that all of them keep (`mimoc.runtime.term_contract`)."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.term import Term
from mimoc.runtime.term_contract import INFANTS, check_term


def terms_of(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    """Yield every term that an environment has bound: what it is, the term, and what it is given besides worlds.

    What is given has a leading axis of `term_contract.INFANTS`.
    """
    for name, sense in env.senses.items():
        if (term := getattr(sense, "term", None)) is not None:
            yield f"sense {name}", term, ()
    yield from _terms_of_task(env)


@dataclass(frozen=True)
class Judged(Term):
    """All arrays of a task's judgement, by name, also of what it changes in the model."""

    term: Term

    def __call__(self, worlds, actions, memory):
        """Return them for actions of shape (k, n) and what the task remembers, shape (k, ...) each."""
        judgement = self.term(worlds, actions, memory)
        ends = {"success": judgement.success, "terminated": judgement.terminated}
        return {
            **{f"reward {name}": values for name, values in judgement.reward_terms.items()},
            **{name: values for name, values in ends.items() if values is not False},
            **{f"memory {name}": values for name, values in judgement.memory.items()},
            **{f"change of {name}": (change.where, change.values()) for name, change in judgement.changes.items()},
        }


def _terms_of_task(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    """Yield what judges an infant, with what the task remembers at the starts of some episodes."""
    if env.task.term is not None:
        actions = np.random.default_rng(0).uniform(-2.0, 2.0, (INFANTS, len(env.actuation.low)))
        states = []
        for seed in range(INFANTS):
            env.reset(seed=seed)
            states.append(env.task.state)
        yield (
            "task",
            Judged(env.task.term),
            (actions, {name: np.stack([s[name] for s in states]) for name in states[0]}),
        )


def check_terms(env: InfantEnv) -> list[str]:
    """Check all terms of an environment, and return what they are."""
    checked = []
    for name, term, args in terms_of(env):
        check_term(term, env.model, *args)
        checked.append(name)
    return checked
