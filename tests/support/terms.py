"""The terms that an environment is made of, for the contract that all of them keep (`mimoc.runtime.contract`)."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.kinds import function_of
from mimoc.base.quantities import QUANTITIES
from mimoc.runtime.contract import INFANTS, check_term
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.noise import Draw, Noise, bind_motor_noise, bind_noise
from mimoc.runtime.term import Term
from mimoc.schema.senses import NoiseEntry, noise_keys


def terms_of(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    """Yield every term that an environment has bound: what it is, the term, and what it is given besides worlds.

    What is given has a leading axis of `term_contract.INFANTS`.
    """
    for name, sense in env.senses.items():
        if (term := getattr(sense, "term", None)) is not None:
            yield f"sense {name}", term, ()
    yield from _terms_of_actuation(env)
    yield from _terms_of_noise(env)
    yield from _terms_of_task(env)
    for name, quantity in QUANTITIES.items():
        if quantity.term is not None:
            yield f"quantity {name}", function_of(quantity.term, name)(env.model, env.manifest), ()


@dataclass(frozen=True)
class TwoSamples(Term):
    """Noise as a term of arrays only: of the first sample of an episode, and of one that is taken later."""

    noise: Noise

    def __call__(self, worlds, samples, numbers):
        """Return both samples with noise, from samples of shape (k, 2, n) and random numbers of shape (k, m)."""

        def normals(shape: tuple[int, ...], where: Any = None) -> Any:
            return worlds.xp.reshape(numbers[:, : math.prod(shape[1:])], tuple(shape))

        first, state = self.noise(Draw(worlds.xp, math.inf, normals), samples[:, 0, :], None)
        return first, self.noise(Draw(worlds.xp, 0.03, normals), samples[:, 1, :], state)[0]


def _terms_of_actuation(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    actuation = env.actuation
    yield "effort", actuation.effort, ()
    yield "drive", actuation.drive, ()
    if actuation.command is not None:
        actions = np.random.default_rng(0).uniform(actuation.low, actuation.high, (INFANTS, len(actuation.low)))
        yield "command", actuation.command, (actions,)


def _terms_of_noise(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    entry = NoiseEntry(motor=0.2, **dict.fromkeys(noise_keys().values(), 1.0))
    noises = {name: bind_noise(name, env.senses[name], entry) for name in noise_keys() if name in env.senses}
    sizes = {name: env.senses[name](env.data).size for name in noises} | {"commands": len(env.actuation.low)}
    for name, noise in {**noises, "commands": bind_motor_noise(entry, env.actuation)}.items():
        generator = np.random.default_rng(0)
        samples = generator.normal(size=(INFANTS, 2, sizes[name])) * generator.integers(0, 2, (INFANTS, 2, sizes[name]))
        yield f"noise of {name}", TwoSamples(noise), (samples, generator.normal(size=(INFANTS, 2 * sizes[name])))


def _terms_of_task(env: InfantEnv) -> Iterator[tuple[str, Term, tuple[Any, ...]]]:
    """Yield what judges an infant, with what the task remembers at the starts of some episodes."""
    if env.task.term is not None:
        actions = np.random.default_rng(0).uniform(-2.0, 2.0, (INFANTS, len(env.actuation.low)))
        states = []
        for seed in range(INFANTS):
            env.reset(seed=seed)
            states.append(env.task.state)
        yield "task", env.task.term, (actions, {name: np.stack([s[name] for s in states]) for name in states[0]})


def check_terms(env: InfantEnv) -> list[str]:
    checked = []
    for name, term, args in terms_of(env):
        check_term(term, env.model, *args)
        checked.append(name)
    return checked
