"""The infants of a world at other ages, and the world in the scene of another seed."""

import copy
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any

import mujoco

from mimoc.base.errors import BundleError, check_name
from mimoc.base.rounding import rounded
from mimoc.bundle.io import Bundle, LazyFiles
from mimoc.bundle.model import prepare, read_model
from mimoc.bundle.variants import WorldVariant
from mimoc.bundle.world import WorldBundle, file_of
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.variants import KEPT, RESOLVED, at_age, errors_at, spec_of
from mimoc.compiler.world_places import entries_of
from mimoc.compiler.worlds import BuiltWorld, assemble_world
from mimoc.schema import source
from mimoc.schema.reading import read_keys
from mimoc.schema.world import WorldPlan, WorldSpec, checked_plan, in_scene, with_keys

Ages = tuple[float, ...]  # Of the infants in their order, in months.


class WorldVariants:
    """Builds a world with its infants at any ages and in any scene.

    Infants keep their places, their clothes and their parts. At other ages they may start within each other, which is
    not checked here: an episode that goes on is not in the state that it started from.

    Example:
        >>> import mimoc
        >>> from mimoc.compiler.world_variants import WorldVariants
        >>> from mimoc.compiler.worlds import plan_world
        >>> anna = mimoc.load_spec("nine_months.yaml")
        >>> variant = WorldVariants(plan_world({"anna": anna, "ben": anna}))({"ben": 10}, scene_seed=0)
        >>> {name: infant.manifest.child.age_months for name, infant in variant.bundle.infants.items()}
        {'anna': 9.0, 'ben': 10.0}
    """

    has_other_scenes = True

    def __init__(self, plan: WorldPlan):
        """Build the infants of a plan at their own ages; raise a SpecError if they cannot be built."""
        self._plan = plan
        self._own = assemble_world(plan)
        self._ages = tuple(rounded(spec.age_months) for spec in plan.infants.values())
        self._infant = lru_cache(KEPT)(self._build_infant)
        self._world = lru_cache(KEPT)(self._build_world)

    def __repr__(self) -> str:
        return f"WorldVariants({self._plan.spec.name!r}, {', '.join(self._plan.infants)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return WorldVariants, (self._plan,)

    @cached_property
    def original(self) -> WorldBundle:
        """The world of the plan itself.

        Raises:
            ModelError: If MuJoCo rejects the model.
            SpecError: If infants would start within each other.
        """
        return self._own.to_bundle(check=True)

    def __call__(self, ages_months: Mapping[str, float], scene_seed: int) -> WorldVariant:
        """Return the world with infants of some ages, in months, in the scene of a seed; see `WorldMaker`.

        Raises:
            UnknownNameError: If there is no such infant.
            SpecError: If there is no infant of that age, or no such scene.
            ModelError: If MuJoCo rejects the model.
        """
        for name in ages_months:
            check_name("name of an infant of this world", name, self._plan.infants)
        own = zip(self._plan.infants, self._ages, strict=True)
        bundle, model = self._world(tuple(rounded(float(ages_months.get(name, age))) for name, age in own), scene_seed)
        return WorldVariant(bundle, copy.copy(model))

    def _build_infant(self, name: str, age_months: float) -> Builder:
        own = self._own.builders[name]
        if age_months == rounded(own.spec.age_months):
            return own
        with errors_at(self._plan.infants[name], age_months, name):
            return builder(at_age(own.spec, age_months, checked=False), None, own, own.has_skin)

    def _build_world(self, ages: Ages, seed: int) -> tuple[WorldBundle, mujoco.MjModel]:
        builders = {name: self._infant(name, age) for name, age in zip(self._plan.infants, ages, strict=True)}
        built = assemble_world(self._placed(seed), builders)
        model = read_model(built.mjcf, built.manifest.scene)
        prepare(model)
        return _lazy_bundle(built, lambda: assemble_world(self._at(ages, seed)).to_bundle()), model

    def _placed(self, seed: int) -> WorldPlan:
        """Return the plan with the places of all infants said, in the scene of a seed."""
        return with_keys(in_scene(self._plan, seed), infants=entries_of(self._plan, self._own.builders))

    def _at(self, ages: Ages, seed: int) -> WorldPlan:
        infants = zip(self._plan.infants.items(), ages, strict=True)
        if (ages, seed) == (self._ages, self._plan.spec.scene.seed):
            return self._plan
        return WorldPlan(self._placed(seed).spec, {name: at_age(spec, age) for (name, spec), age in infants})


class WorldBundleVariants:
    """Builds the world of a bundle at any ages of its infants, in its own scene, from the specs in it."""

    has_other_scenes = False

    def __init__(self, bundle: WorldBundle):
        self._bundle = bundle

    def __reduce__(self) -> tuple[Any, ...]:
        return WorldBundleVariants, (self._bundle,)

    def __call__(self, ages_months: Mapping[str, float], scene_seed: int) -> WorldVariant:
        """Return the world with infants of some ages; see `WorldMaker`.

        Raises:
            UnknownNameError: If there is no such infant.
            SpecError: If there is no infant of that age.
            BundleError: If the bundle does not hold its specs.
        """
        return self._of_plan(ages_months, scene_seed)

    @cached_property
    def _of_plan(self) -> WorldVariants:
        return WorldVariants(plan_of_bundle(self._bundle))


def plan_of_bundle(bundle: WorldBundle) -> WorldPlan:
    """Return the world that a bundle was built from, with the specs of its infants.

    Raises:
        BundleError: If the bundle does not contain them.
        SpecError: If this version of mimoc does not read them.
    """
    if RESOLVED not in bundle.files:
        raise BundleError(f"there is no {RESOLVED} in it")
    spec = read_keys(WorldSpec, source.parse(bundle.files[RESOLVED], RESOLVED))
    return checked_plan(spec, [spec_of(infant) for infant in bundle.infants.values()])


def _lazy_bundle(built: BuiltWorld, make: Callable[[], WorldBundle]) -> WorldBundle:
    files = LazyFiles({}, lambda: make().files)

    def of_infant(name: str) -> Bundle:
        start = file_of(name, "")

        def make_files() -> dict[str, bytes]:
            return {path.removeprefix(start): files[path] for path in files if path.startswith(start)}

        return Bundle(LazyFiles(built.builders[name].arrays, make_files), built.manifests[name], None)

    infants = {name: of_infant(name) for name in built.builders}
    return WorldBundle(files, built.manifest, MappingProxyType(infants), None)
