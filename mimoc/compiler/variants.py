"""The infants of a spec at all ages and in all scenes, as an environment is handed them."""

from functools import cached_property
from typing import Any

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.variants import Variant
from mimoc.compiler.aged import aged
from mimoc.compiler.building import Builder, builder
from mimoc.schema.infant import InfantSpec

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
