"""Infants at all ages and in all scenes, alone or in one world, as an environment is handed them, and their skins."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from mimoc.base.errors import BundleError, Problem, SpecError, check_name
from mimoc.base.rounding import rounded
from mimoc.bundle.io import Bundle, LazyFiles
from mimoc.bundle.model import prepare, read_model
from mimoc.bundle.variants import Variant, WorldVariant, open_variant
from mimoc.bundle.world import WorldBundle, files_of
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.child import child_of
from mimoc.compiler.looks.skin import skin_of
from mimoc.compiler.mjcf.scene import SkinLayer
from mimoc.compiler.model_template import DifferenceError, ModelTemplate
from mimoc.compiler.world_places import entries_of
from mimoc.compiler.worlds import BuiltWorld, assemble_world
from mimoc.schema import source
from mimoc.schema.base import dotted
from mimoc.schema.infant import InfantSpec, as_written, load_spec, read_spec
from mimoc.schema.reading import read_keys
from mimoc.schema.world import WorldPlan, WorldSpec, checked_plan, in_scene, with_keys


def at_age(spec: InfantSpec, age_months: float, *, checked: bool = True) -> InfantSpec:
    """Return the spec of a spec's child at another age, which is as in manifests (`schema/infant.py`: what changes).

    It keeps its clothes, so that its skin has the same vertices at all ages. If it is not *checked*, and only one
    number changes, it has the same values, but is not written as a file is.

    Raises:
        SpecError: If no spec can say so, such as of a child before its term; the error lists all problems.
    """
    if age_months == rounded(spec.age_months):
        return spec
    if checked or spec.body.measurements or spec.body.individual or age_months < spec.months_early:
        other = spec.with_(age_months=age_months)
        return other if other.clothes == spec.clothes else other.with_(body={"looks": {"clothes": spec.clothes}})
    other = spec.model_copy(update={"age_months": age_months})
    if other.clothes == spec.clothes:
        return other
    looks = spec.body.looks.model_copy(update={"clothes": spec.clothes})
    return other.model_copy(update={"body": spec.body.model_copy(update={"looks": looks})})


@contextmanager
def errors_at(spec: InfantSpec, age_months: float, name: str = "") -> Iterator[None]:
    """Let errors say which age they concern, if it is not the spec's, at the keys that the spec was written with.

    They also say which infant of a world, if that has a *name*.
    """
    try:
        yield
    except SpecError as error:
        if age_months == rounded(spec.age_months):
            raise
        written, who = as_written(spec), f"'{name}' " if name else ""
        paths = {dotted(path): path for path in written.key_places}
        raise SpecError(
            written.problem(paths.get(problem.key, ()), f"{who}at {age_months:g} months: {_advised(problem, spec)}")
            for problem in error.problems
        ) from None


def _advised(problem: Problem, spec: InfantSpec) -> str:
    """Return what is wrong at another age; advice on measures is of that age, so that other advice replaces it."""
    if not problem.key.startswith("body."):
        return problem.message
    what = problem.message.rpartition("; ")[0]
    advice = f"nearer to the average child of {spec.age_months:g} months"
    return f"{what}; leave this age out, or give what is {advice}"


RESOLVED = "resolved.yaml"  # The file of a bundle that holds its whole spec.
KEPT = 8  # Ages of each infant, and worlds or lone infants, that are kept, since environments return to them.
Ages = tuple[float, ...]  # Ages of the infants in their order, in months.
Made = TypeVar("Made", bound=Variant)


class _Variants(ABC, Generic[Made]):
    """Builds infants at any ages and in any scene, either one alone or several in one world."""

    has_other_scenes = True

    def __init__(self, own: Mapping[str, Builder]):
        """Keep what builds the infants at their own ages, by name."""
        self._own = own
        self._builder = lru_cache(KEPT * len(own))(self._build)
        self._maker = lru_cache(KEPT)(self._make)

    def _build(self, name: str, age_months: float) -> Builder:
        """Return what builds an infant at an age, with all that does not depend on age from its own age."""
        own = self._own[name]
        spec = at_age(own.spec, age_months, checked=False)
        return own if spec is own.spec else builder(spec, younger=own, skin=own.has_skin)

    @abstractmethod
    def _make(self, ages_months: Ages, scene_seed: int) -> Callable[[], Made]:
        """Return what gives out the infants in a scene, each time with a model of its own."""


class SpecVariants(_Variants[Variant]):
    """Builds the infant of a spec at any age and in any scene."""

    def __init__(self, spec: InfantSpec, skin: bool = True):
        """Build the infant of a spec; if the spec does not say, *skin* is whether it has one.

        Raises:
            SpecError: If it cannot be built.
        """
        self._spec, self._seed = spec, spec.scene.seed
        self._template: ModelTemplate | None = None
        self._own_builder = builder(spec, skin=skin)
        self._own_scene = self._own_builder.place_scene(self._seed)
        super().__init__({"": self._own_builder})

    def __repr__(self) -> str:
        return f"SpecVariants({self._spec.name!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        return SpecVariants, (self._spec, self._own_builder.has_skin)

    @cached_property
    def original(self) -> Bundle:
        """The infant of the spec itself."""
        return self._own_builder.to_bundle(self._seed, self._own_scene)

    def own_like(self, other: "SpecVariants") -> Variant:
        """Return the infant of the spec itself, from another infant's template if they differ in numbers only."""
        template = other._usable_template()
        if not template.fits(self._own_scene.scene):
            return open_variant(self.original)
        self._template = template
        return self(rounded(self._spec.age_months), self._seed)

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months as they stand in manifests, in the scene of a seed.

        Raises:
            SpecError: If there is no such infant.
            ModelError: If MuJoCo rejects it.
        """
        with errors_at(self._spec, age_months):
            return self._maker((age_months,), scene_seed)()

    def _make(self, ages_months: Ages, scene_seed: int) -> Callable[[], Variant]:
        (age_months,) = ages_months
        built = self._builder("", age_months)
        is_own = built is self._own_builder and scene_seed == self._seed
        furnished = self._own_scene if is_own else built.place_scene(scene_seed)

        def files() -> Mapping[str, bytes]:
            if is_own:
                return self.original.files
            whole = builder(at_age(self._spec, age_months), skin=self._own_builder.has_skin)
            return whole(scene_seed, check=False).files

        bundle = Bundle(LazyFiles(built.arrays, files), built.manifest_of(scene_seed, furnished), None)
        if scene_seed == self._seed:
            # A scene has to be printed if more than numbers is different, such as the poses, since some do not suit
            # every age; or if MuJoCo rejects it, because it then says more about what is printed.
            template = self._usable_template()
            with suppress(DifferenceError, ValueError):
                instance = template.instantiate(furnished.scene)
                return lambda: Variant(bundle, instance.model(), instance.set_textures)
        model = read_model(built.mjcf_of(furnished), bundle.manifest.scene)
        prepare(model)
        return Variant(bundle, model).again

    def _usable_template(self) -> ModelTemplate:
        """Return the template of this infant, or of the other one that it was instantiated from."""
        if self._template is None or self._template.broken:
            self._template = ModelTemplate(self.original.files, self._own_scene.scene)
        return self._template


class WorldVariants(_Variants[WorldVariant]):
    """Builds a world with its infants at any ages and in any scene.

    Infants keep their places, their clothes and their parts. At other ages they may start within each other, which is
    not checked here: an episode that goes on is not in the state that it started from.

    Example:
        >>> import mimoc
        >>> from mimoc.compiler.variants import WorldVariants
        >>> from mimoc.compiler.worlds import plan_world
        >>> anna = mimoc.load_spec("nine_months.yaml")
        >>> variant = WorldVariants(plan_world({"anna": anna, "ben": anna}))({"ben": 10}, scene_seed=0)
        >>> {name: infant.manifest.child.age_months for name, infant in variant.bundle.infants.items()}
        {'anna': 9.0, 'ben': 10.0}
    """

    def __init__(self, plan: WorldPlan):
        """Build the infants of a plan at their own ages; raise a SpecError if they cannot be built."""
        self._plan, self._own_world = plan, assemble_world(plan)
        self._ages = tuple(rounded(spec.age_months) for spec in plan.infants.values())
        super().__init__(self._own_world.builders)

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
        return self._own_world.to_bundle(check=True)

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
        return self._maker(tuple(rounded(float(ages_months.get(name, age))) for name, age in own), scene_seed)()

    def _make(self, ages_months: Ages, scene_seed: int) -> Callable[[], WorldVariant]:
        builders = dict[str, Builder]()
        for (name, spec), age_months in zip(self._plan.infants.items(), ages_months, strict=True):
            with errors_at(spec, age_months, name):
                builders[name] = self._builder(name, age_months)
        # The places of all infants stay, whatever their ages.
        placed = with_keys(in_scene(self._plan, scene_seed), infants=entries_of(self._plan, self._own))
        built = assemble_world(placed, builders)
        model = read_model(built.mjcf, built.manifest.scene)
        prepare(model)

        def files() -> Mapping[str, bytes]:
            if (ages_months, scene_seed) == (self._ages, self._plan.spec.scene.seed):
                return assemble_world(self._plan).to_bundle().files
            infants = zip(self._plan.infants.items(), ages_months, strict=True)
            grown = {name: at_age(spec, age_months) for (name, spec), age_months in infants}
            return assemble_world(WorldPlan(placed.spec, grown)).to_bundle().files

        return WorldVariant(_lazy_bundle(built, files), model).again


def _lazy_bundle(built: BuiltWorld, make: Callable[[], Mapping[str, bytes]]) -> WorldBundle:
    """Return the bundle of a world whose files are made when somebody first reads one of them."""
    files = LazyFiles({}, make)

    def of_infant(name: str) -> Bundle:
        own = LazyFiles(built.builders[name].arrays, lambda: files_of(name, files))
        return Bundle(own, built.manifests[name], None)

    return WorldBundle(
        files, built.manifest, MappingProxyType({name: of_infant(name) for name in built.builders}), None
    )


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
    """Return the world that a bundle was built from, with the specs of its infants; BundleError if it lacks them."""
    spec = read_keys(WorldSpec, _resolved(bundle))
    return checked_plan(spec, [spec_of(infant) for infant in bundle.infants.values()])


def spec_of(bundle: Bundle) -> InfantSpec:
    """Return the whole spec of a bundle; BundleError if it lacks it, SpecError if this version does not read it."""
    return read_spec(_resolved(bundle))


def _resolved(bundle: Bundle | WorldBundle) -> source.Source:
    if RESOLVED not in bundle.files:
        raise BundleError(f"there is no {RESOLVED} in it")
    return source.parse(bundle.files[RESOLVED], RESOLVED)


def skin_at(source: InfantSpec | Bundle | str | Path, age_months: float | None = None) -> tuple[SkinLayer, ...]:
    """Return the layers of the skin of an infant, whether it is built with one or not.

    Layers are the same at all ages but for the places of their vertices and bones: `verts_m`, `origins_m`, `turns`.
    A vertex is at the sum over bones of `weights[:, b] * (world_from_b @ turns[b].T @ (verts_m - origins_m[b]) +
    place of b in the world)`. The textures are those of the bundle, `assets/skin_*.png`.

    Args:
        source: A spec, the path of its file, or a bundle.
        age_months: Another age than its own.

    Raises:
        SpecError: If there is no such child.
        BundleError: If the bundle does not contain its spec.
    """
    if isinstance(source, Bundle):
        spec = spec_of(source)
    else:
        spec = source if isinstance(source, InfantSpec) else load_spec(source)
    age_months = spec.age_months if age_months is None else age_months
    with errors_at(spec, age_months):
        tree = child_of(at_age(spec, age_months)).tree
    return skin_of(tree).layers
