"""The infants of a spec at all ages and in all scenes, as an environment is handed them, and their skins."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from mimoc.base.errors import BundleError, Problem, SpecError
from mimoc.base.rounding import rounded
from mimoc.bundle.io import Bundle, LazyFiles
from mimoc.bundle.model import load_model, prepare, read_model
from mimoc.bundle.variants import Variant
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.child import child_of
from mimoc.compiler.loading import load_spec
from mimoc.compiler.looks.skin.deformation import skin_of
from mimoc.compiler.mjcf.scene import SceneTree
from mimoc.compiler.mjcf.skin import SkinLayer
from mimoc.compiler.model_template import DifferenceError, ModelInstance, ModelTemplate
from mimoc.schema import source
from mimoc.schema.base import dotted
from mimoc.schema.infant import InfantSpec, as_written, read_spec


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
    what, advice = problem.message.rpartition("; ")[0], f"nearer to the average child of {spec.age_months:g} months"
    return f"{what}; leave this age out, or give what is {advice}"


RESOLVED = "resolved.yaml"  # The file of a bundle that holds its whole spec.
KEPT = 8  # Ages whose infants are kept, since environments return to them.


class SpecVariants:
    """Builds the infant of a spec at any age and in any scene."""

    has_other_scenes = True

    def __init__(self, spec: InfantSpec, skin: bool = True):
        """Build the infant of a spec; if the spec does not say, *skin* is whether it has one.

        Raises:
            SpecError: If it cannot be built.
        """
        self._spec = spec
        self._builder = lru_cache(KEPT)(self._build_at)
        self._infant = lru_cache(KEPT)(self._make)
        self._template: ModelTemplate | None = None
        self._own = builder(spec, skin=skin)
        self._own_scene = self._own.furnished(spec.scene.seed)

    def __repr__(self) -> str:
        return f"SpecVariants({self._spec.name!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        return SpecVariants, (self._spec, self._own.has_skin)

    @cached_property
    def original(self) -> Bundle:
        """The infant of the spec itself."""
        return self._own.to_bundle(self._spec.scene.seed, self._own_scene)

    def own_like(self, other: "SpecVariants") -> Variant:
        """Return the infant of the spec itself: cast from another infant, if they differ in numbers only.

        Raises:
            ModelError: If MuJoCo rejects it.
        """
        template, seed = other._usable_template(), self._spec.scene.seed
        instance = _instantiate(template, self._own_scene.scene)
        if instance is None:
            return Variant(self.original, load_model(self.original))
        self._template = template
        files = LazyFiles(self._own.arrays, lambda: self.original.files)
        return Variant(
            Bundle(files, self._own.manifest_of(seed, self._own_scene), None), instance.model(), instance.set_textures
        )

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months as they stand in manifests, in the scene of a seed.

        Raises:
            SpecError: If there is no such infant.
            ModelError: If MuJoCo rejects it.
        """
        with errors_at(self._spec, age_months):
            return self._infant(age_months, scene_seed)()

    def _make(self, age_months: float, scene_seed: int) -> Callable[[], Variant]:
        """Return what gives out an infant, each time with a model of its own."""
        built = self._builder(age_months)
        furnished = built.furnished(scene_seed)
        files = LazyFiles(built.arrays, lambda: self._at(at_age(self._spec, age_months))(scene_seed, check=False).files)
        bundle = Bundle(files, built.manifest_of(scene_seed, furnished), None)
        is_own_scene = scene_seed == self._spec.scene.seed
        instance = _instantiate(self._usable_template(), furnished.scene) if is_own_scene else None
        if instance is None:
            model = read_model(built.mjcf_of(furnished), bundle.manifest.scene)
            prepare(model)
            return Variant(bundle, model).again
        return lambda: Variant(bundle, instance.model(), instance.set_textures)

    def _build_at(self, age_months: float) -> Builder:
        if age_months == rounded(self._spec.age_months):
            return self._own
        return self._at(at_age(self._spec, age_months, checked=False), self._own)

    def _at(self, spec: InfantSpec, younger: Builder | None = None) -> Builder:
        return builder(spec, None, younger, self._own.has_skin)

    def _usable_template(self) -> ModelTemplate:
        """Return the template of this infant, or of another one that it was instantiated from."""
        if self._template is None or self._template.broken:
            self._template = ModelTemplate(self.original.files, self._own_scene.scene)
        return self._template


def _instantiate(template: ModelTemplate, scene: SceneTree) -> ModelInstance | None:
    """Return what gives out models of a scene, or nothing if it has to be printed.

    Either more than numbers is different, such as the poses, since some do not suit every age; or MuJoCo rejects it,
    and says more about what is printed.
    """
    try:
        return template.instantiate(scene)
    except (DifferenceError, ValueError):
        return None


def spec_of(bundle: Bundle) -> InfantSpec:
    """Return the whole spec of a bundle.

    Raises:
        BundleError: If the bundle does not contain it.
        SpecError: If this version of mimoc does not read it.
    """
    if RESOLVED not in bundle.files:
        raise BundleError(f"there is no {RESOLVED} in it")
    return read_spec(source.parse(bundle.files[RESOLVED], RESOLVED))


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
