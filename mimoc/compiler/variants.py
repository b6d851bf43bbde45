"""The infants of a spec at all ages and in all scenes, as an environment is handed them."""

from functools import cached_property
from typing import Any

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.variants import Variant
from mimoc.compiler.aged import aged
from mimoc.compiler.building import Builder, builder
from mimoc.errors import BundleError, MimocError
from mimoc.schema import source
from mimoc.schema.infant import InfantSpec, read_spec

RESOLVED = "resolved.yaml"
"""The file of a bundle that holds its whole spec."""
KEPT_BUILDERS = 8
"""Ages whose infants are kept, since environments return to them."""


class SpecVariants:
    """Builds the infant of a spec at any age and in any scene."""

    has_other_scenes = True

    def __init__(self, spec: InfantSpec):
        """Build the infant of the spec.

        Raises:
            SpecError: If it cannot be built.
        """
        self._spec = spec
        self._builders: dict[float, Builder] = {spec.age_months: builder(spec)}

    def __repr__(self) -> str:
        """Return the name of the infant."""
        return f"SpecVariants({self._spec.name!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle only the spec: copies and other processes build the infant again."""
        return SpecVariants, (self._spec,)

    @cached_property
    def own(self) -> Bundle:
        """The infant of the spec itself.

        Raises:
            SpecError: If it cannot be built.
        """
        return self._builder(self._spec.age_months)(self._spec.scene.seed, check=False)

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months as they stand in manifests, in the scene of a seed.

        Raises:
            SpecError: If there is no such infant.
            ModelError: If MuJoCo rejects it.
        """
        bundle = self._builder(age_months)(scene_seed, check=False)
        return Variant(bundle, load_model(bundle))

    def _builder(self, age_months: float) -> Builder:
        found = self._builders.pop(age_months, None) or builder(aged(self._spec, age_months))
        self._builders[age_months] = found
        while len(self._builders) > KEPT_BUILDERS:
            del self._builders[next(iter(self._builders))]
        return found


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
        return SpecVariants(spec_of(self._bundle))


def spec_of(bundle: Bundle) -> InfantSpec:
    """Return the whole spec of a bundle.

    Raises:
        BundleError: If the bundle does not contain it.
        SpecError: If this version of mimoc does not read it.
    """
    if RESOLVED not in bundle.files:
        raise BundleError(f"there is no {RESOLVED} in it")
    return read_spec(source.parse(bundle.files[RESOLVED].decode(), RESOLVED))
