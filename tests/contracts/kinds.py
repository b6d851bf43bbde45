"""The kinds of environments: how each is made of the same infants, and driven in the same way."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from support.devices import DEVICE
from support.store import made_once
from support.worlds import plan_of

import mimoc

KIM: dict[str, Any] = {
    "mimoc": 1,
    "name": "kim",
    "age_months": 9,
    "senses": {"proprioception": {"include": ["velocity"]}, "vestibular": {}},
}
NAMES = "anna", "ben"  # The infants of a world.
FAR = {"y_cm": 0}, {"y_cm": 480}  # Their places, at which neither touches the other.
NOTHING: Mapping[str, Any] = {}
Rows = list[dict[str, Any]]  # What each infant observes.


class Driven:
    """The environment of one infant, which is driven like those of several: all that is its infants' has a row each."""

    def __init__(self, env: Any):
        self.env = env
        self.infos: list[dict[str, Any]] = []
        """The infos of the last reset or step."""
        self.rewards: list[float] = []

    @property
    def infants(self) -> list[Any]:
        return [self.env.unwrapped]

    @property
    def action_space(self) -> Any:
        return self.env.action_space

    def rows(self, of_all: Any) -> list[Any]:
        return [of_all]

    def joined(self, rows: Sequence[Any]) -> Any:
        return rows[0]

    def options(self, given: dict[str, Any]) -> Any:
        return given

    def reset(self, seed: int | None = None, **given: Any) -> Rows:
        observation, info = self.env.reset(seed=seed, options=self.options(given) if given else None)
        self.infos = self.rows(info)
        return self.rows(observation)

    def step(self, actions: np.ndarray) -> Rows:
        """Take a control step; shape (rows, n)."""
        observation, reward, _, _, info = self.env.step(self.joined(actions))
        self.rewards, self.infos = self.rows(reward), self.rows(info)
        return self.rows(observation)

    def flail(self, steps: int, seed: int = 5) -> Rows:
        """Take control steps with random actions; return what is observed at the end."""
        generator, rows = np.random.default_rng(seed), self.count
        low, high = self.action_space.low, self.action_space.high
        observed: Rows = []
        for _ in range(steps):
            actions = generator.uniform(low, high, (rows, len(low))) * 0.5
            observed = self.step(actions.astype(np.float32))
        return observed

    def rest(self, steps: int) -> Rows:
        """Take control steps without commands; return what is observed at the end."""
        observed: Rows = []
        for _ in range(steps):
            observed = self.step(np.zeros((self.count, *self.action_space.shape), np.float32))
        return observed

    @property
    def count(self) -> int:
        return len(self.infants)

    def grow(self, age_months: float) -> Rows:
        return self.rows(self.env.unwrapped.grow(age_months))

    def restore(self, state: Any) -> Rows:
        return self.rows(self.env.unwrapped.set_state(state))


class DrivenWorld(Driven):
    @property
    def infants(self) -> list[Any]:
        return list(self.env.infants.values())

    @property
    def action_space(self) -> Any:
        return self.env.action_space(NAMES[0])

    def rows(self, of_all: Any) -> list[Any]:
        return [of_all[name] for name in NAMES]

    def joined(self, rows: Sequence[Any]) -> Any:
        return dict(zip(NAMES, rows, strict=True))

    def options(self, given: dict[str, Any]) -> Any:
        of_world = {name: given.pop(name) for name in ("scene_seed", "objects") if name in given}
        return {**dict.fromkeys(NAMES, given), **of_world}

    def grow(self, age_months: float) -> Rows:
        return self.rows(self.env.grow(dict.fromkeys(NAMES, age_months)))


class DrivenMany(Driven):
    @property
    def infants(self) -> list[Any]:
        return list(self.env.unwrapped.infants)

    @property
    def action_space(self) -> Any:
        return self.env.single_action_space

    @property
    def count(self) -> int:
        return self.env.num_envs

    def rows(self, of_all: Any) -> list[Any]:
        if isinstance(of_all, Mapping):
            shown = {name: self.rows(values) for name, values in of_all.items() if not name.startswith("_")}
            return [{name: values[row] for name, values in shown.items()} for row in range(self.env.num_envs)]
        return list(of_all)

    def joined(self, rows: Sequence[Any]) -> Any:
        if isinstance(rows[0], Mapping):
            return {name: np.stack([row[name] for row in rows]) for name in rows[0]}
        return np.stack(rows) if isinstance(rows[0], np.ndarray) else list(rows)


@dataclass(frozen=True, eq=False)
class Kind:
    name: str
    title: str  # Above its column of the table.
    made_by: str  # How it is made.
    driven: type[Driven]
    source: Callable[..., Any]  # From the data of a spec, a scene, and what an infant starts at, to what it is made of.
    make: Callable[..., Any]
    by_infant: bool = False  # Whether tasks, senses and companions are given by the name of an infant.
    tolerance: float = 0.0  # By which readings may differ from those of an infant that is alone.
    options: Mapping[str, Any] = field(default_factory=dict)

    @contextmanager
    def open(
        self,
        spec: Mapping[str, Any] = KIM,
        scene: Mapping[str, Any] = NOTHING,
        start_at: str | None = None,
        is_of_spec: bool = False,
        **options: Any,
    ) -> Iterator[Driven]:
        """Open one, of a bundle or, on request, a spec.

        Options are those of its maker, of which tasks, senses and companions are those of each infant.
        """
        given: dict[str, Any] = {}
        for name, value in options.items():
            of_each = self.by_infant and name in ("task", "senses", "companions")
            plural = "tasks" if name == "task" and of_each else name
            given[plural] = {infant: deepcopy(value) for infant in NAMES} if of_each else value
        source = self.source(spec, scene, start_at)
        if not is_of_spec:
            build = mimoc.build if isinstance(source, mimoc.InfantSpec) else mimoc.build_world
            source = made_once(f"{build.__name__} of {spec} {scene} {start_at}", lambda: build(source))
        driven = self.driven(self.make(source, **self.options, **given))
        try:
            yield driven
        finally:
            driven.env.close()


def _spec(spec: Mapping[str, Any], scene: Mapping[str, Any] = NOTHING, start_at: str | None = None) -> mimoc.InfantSpec:
    own = {**spec.get("scene", {}), **scene, **({"start_at": start_at} if start_at else {})}
    return mimoc.InfantSpec.model_validate({**spec, "scene": own})


def _world(spec: Mapping[str, Any], scene: Mapping[str, Any] = NOTHING, start_at: str | None = None) -> Any:
    places = ({"start_at": start_at}, {"y_cm": 480}) if start_at else FAR
    return plan_of({name: dict(spec) for name in NAMES}, *places, **({"scene": dict(scene)} if scene else {}))


ONE = Kind("one", "one infant", "`mimoc.make(infant)`", Driven, _spec, mimoc.make)
WORLD = Kind(
    "world", "a world", "`mimoc.make_parallel(world)`", DrivenWorld, _world, mimoc.make_parallel, True, tolerance=1e-5
)
MANY = Kind("many", "many", "`mimoc.make_vec(infant, n)`", DrivenMany, _spec, mimoc.make_vec, options={"num_envs": 2})
WORLDS = Kind(
    "worlds",
    "many worlds",
    "`mimoc.make_vec(world, n)`",
    DrivenMany,
    _world,
    mimoc.make_vec,
    True,
    tolerance=1e-5,
    options={"num_envs": 4},
)
ON_DEVICE = Kind(
    "device",
    "many on a GPU",
    '`mimoc.make_vec(infant, n, device="cuda:0")`',
    DrivenMany,
    _spec,
    mimoc.make_vec,
    tolerance=1e-3,
    options={"num_envs": 2, "device": DEVICE},
)
KINDS = (ONE, WORLD, MANY, WORLDS)  # On the CPU.
