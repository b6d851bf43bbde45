"""The world that a bundle was built from."""

from mimoc.base.errors import BundleError
from mimoc.bundle.world import WorldBundle
from mimoc.compiler.variants import RESOLVED, spec_of
from mimoc.schema import source
from mimoc.schema.reading import read_keys
from mimoc.schema.world import WorldPlan, WorldSpec, checked_plan


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
