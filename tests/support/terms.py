"""The terms that an environment is made of, for the contract that all of them keep (`mimoc.runtime.term_contract`)."""

from collections.abc import Iterator
from typing import Any

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.term import Term
from mimoc.runtime.term_contract import check_term


def terms_of(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    """Yield every term that an environment has bound: what it is, the term, and what it is given besides worlds.

    What is given has a leading axis of `term_contract.INFANTS`.
    """
    for name, sense in env.senses.items():
        if (term := getattr(sense, "term", None)) is not None:
            yield f"sense {name}", term, ()


def check_terms(env: InfantEnv) -> list[str]:
    """Check all terms of an environment, and return what they are."""
    checked = []
    for name, term, args in terms_of(env):
        check_term(term, env.model, *args)
        checked.append(name)
    return checked
