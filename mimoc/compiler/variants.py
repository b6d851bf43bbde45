"""The infants of a spec at all ages and in all scenes, as an environment is handed them."""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, TypeVar

from mimoc.bundle.io import Bundle, LaterFiles
from mimoc.bundle.model import load_model
from mimoc.bundle.variants import Variant
from mimoc.compiler.aged import aged, errors_at, quickly_aged
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.mould import Casting, DifferenceError, Mould
from mimoc.errors import BundleError, MimocError
from mimoc.mjcf.scene import SceneTree
from mimoc.schema import source
from mimoc.schema.infant import InfantSpec, read_spec

RESOLVED = "resolved.yaml"
"""The file of a bundle that holds its whole spec."""
KEPT = 8
"""Ages whose infants are kept, since environments return to them."""

Value = TypeVar("Value")


class SpecVariants:
    """Builds the infant of a spec at any age and in any scene."""

    has_other_scenes = True

    def __init__(self, spec: InfantSpec, skin: bool = True):
        """Build the infant of the spec.

        Args:
            spec: The spec.
            skin: Whether it has a skin, if the spec does not say.

        Raises:
            SpecError: If it cannot be built.
        """
        self._spec = spec
        self._builders: dict[float, Builder] = {}
        self._made: dict[tuple[float, int], Callable[[], Variant]] = {}
        self._mould: Mould | None = None
        self._own = builder(spec, skin=skin)
        self._own_scene = self._own.furnished(spec.scene.seed)

    def __repr__(self) -> str:
        """Return the name of the infant."""
        return f"SpecVariants({self._spec.name!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle only the spec: copies and other processes build the infant again."""
        return SpecVariants, (self._spec, self._own.has_skin)

    @cached_property
    def own(self) -> Bundle:
        """The infant of the spec itself."""
        return self._own.print(self._spec.scene.seed, self._own_scene)

    def own_like(self, other: "SpecVariants") -> Variant:
        """Return the infant of the spec itself: cast from another infant, if they differ in numbers only.

        Raises:
            ModelError: If MuJoCo rejects it.
        """
        mould, seed = other._usable_mould(), self._spec.scene.seed
        casting = _cast(mould, self._own_scene.scene)
        if casting is None:
            return Variant(self.own, load_model(self.own))
        self._mould = mould
        files = LaterFiles(self._own.arrays, lambda: self.own.files)
        return Variant(
            Bundle(files, self._own.manifest_of(seed, self._own_scene), None), casting.model(), casting.dress
        )

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months as they stand in manifests, in the scene of a seed.

        Raises:
            SpecError: If there is no such infant.
            ModelError: If MuJoCo rejects it.
        """
        with errors_at(self._spec, age_months):
            return _kept(self._made, (age_months, scene_seed), lambda: self._make(age_months, scene_seed))()

    def _make(self, age_months: float, scene_seed: int) -> Callable[[], Variant]:
        """Return what gives out an infant, each time with a model of its own."""
        built = self._builder(age_months)
        furnished = built.furnished(scene_seed)
        files = LaterFiles(built.arrays, lambda: self._files(age_months, scene_seed))
        bundle = Bundle(files, built.manifest_of(scene_seed, furnished), None)
        is_own_scene = scene_seed == self._spec.scene.seed
        casting = _cast(self._usable_mould(), furnished.scene) if is_own_scene else None
        if casting is None:
            return Variant(bundle, load_model(bundle)).again
        return lambda: Variant(bundle, casting.model(), casting.dress)

    def _builder(self, age_months: float) -> Builder:
        return _kept(self._builders, age_months, lambda: self._at(quickly_aged(self._spec, age_months), self._own))

    def _files(self, age_months: float, scene_seed: int) -> Mapping[str, bytes]:
        """Return the files of an infant, among them its spec."""
        return self._at(aged(self._spec, age_months))(scene_seed, check=False).files

    def _at(self, spec: InfantSpec, younger: Builder | None = None) -> Builder:
        return builder(spec, None, younger, self._own.has_skin)

    def _usable_mould(self) -> Mould:
        """Return the mould of this infant, or of another one that it was cast from."""
        if self._mould is None or self._mould.broken:
            self._mould = Mould(self.own.files, self._own_scene.scene)
        return self._mould


def _cast(mould: Mould, scene: SceneTree) -> Casting | None:
    """Return what gives out models of a scene, or nothing if it has to be printed.

    Either more than numbers is different, such as the poses, since some do not suit every age; or MuJoCo rejects it,
    and says more about what is printed.
    """
    try:
        return mould.cast(scene)
    except (DifferenceError, ValueError):
        return None


def _kept(store: dict[Any, Value], key: Any, make: Callable[[], Value]) -> Value:
    """Return what is kept under a key, or make it; what was not asked for lately is forgotten."""
    value = store.pop(key) if key in store else make()
    store[key] = value
    if len(store) > KEPT:
        del store[next(iter(store))]
    return value


class BundleVariants:
    """Builds the infant of a bundle at any age, in the bundle's own scene, from the spec that the bundle contains."""

    has_other_scenes = False

    def __init__(self, bundle: Bundle):
        """Take a bundle; it is built again when an age is first asked for."""
        self._bundle = bundle

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle only the bundle."""
        return BundleVariants, (self._bundle,)

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months as they stand in manifests.

        Raises:
            BundleError: If the bundle cannot be built at this age.
        """
        try:
            return self._of_spec(age_months, scene_seed)
        except MimocError as error:
            name, problems = self._bundle.manifest.name, str(error).replace("\n", "; ")
            raise BundleError(f"the bundle '{name}' cannot be built at {age_months:g} months: {problems}") from None

    @cached_property
    def _of_spec(self) -> SpecVariants:
        return SpecVariants(spec_of(self._bundle), skin=self._bundle.manifest.has_skin)


def spec_of(bundle: Bundle) -> InfantSpec:
    """Return the whole spec of a bundle.

    Raises:
        BundleError: If the bundle does not contain it.
        SpecError: If this version of mimoc does not read it.
    """
    if RESOLVED not in bundle.files:
        raise BundleError(f"there is no {RESOLVED} in it")
    return read_spec(source.parse(bundle.files[RESOLVED], RESOLVED))
