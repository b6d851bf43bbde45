"""The time base of an environment: its steps, and the delays and noise of its signals."""

from collections.abc import Mapping

from mimoc.bundle.manifest import Manifest
from mimoc.delays.timing import Timing
from mimoc.senses.custom import CustomSense
from mimoc.senses.sense import Sense


def timing_of(manifest: Manifest, senses: Mapping[str, Sense]) -> Timing:
    """Return the time base, the noise, and the delays of an infant's signals and of senses passed as objects."""
    delays = {name: delay for name, delay in manifest.delays if name != "legs"}
    custom = {name: sense.delay for name, sense in senses.items() if isinstance(sense, CustomSense)}
    return Timing(manifest.step_ms, manifest.timestep_ms, delays | custom, manifest.delays.legs, manifest.noise)
