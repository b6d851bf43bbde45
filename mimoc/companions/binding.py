"""The companions of an environment: those of its bundle, and objects of a script's own."""

from collections.abc import Mapping
from typing import Any

import mujoco

from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object
from mimoc.companions.caregiver.run import NAME, Caregiver
from mimoc.companions.companion import Companion, Companions, channel_of
from mimoc.noise.noise import NoiseStreams


def bind_companions(
    model: mujoco.MjModel, bundle: Any, streams: NoiseStreams, custom: Mapping[str, Companion]
) -> Companions:
    """Return the companions of an infant, bound to its model.

    Args:
        model: The infant and its world.
        bundle: The `mimoc.Bundle` it comes from.
        streams: Random numbers of the environment, by channel.
        custom: Objects of a script's own, by name; one may replace that of the bundle.

    Raises:
        KindError: If one of them is none.
    """
    companions = {NAME: Caregiver()} if bundle.manifest.caregiver and NAME not in custom else {}
    for name, companion in custom.items():
        check_custom_object(f"companion '{name}'", companion, "before_step", "an object such as a mimoc.Companion")
        if not isinstance(companion, Companion):
            raise KindError(f"companion '{name}' is {companion!r:.60}; pass an object of a subclass of mimoc.Companion")
    for name, companion in (companions := {**companions, **custom}).items():
        companion.bind(model, bundle, streams[channel_of(name)])
    bound = Companions(companions, streams)
    for companion in companions.values():
        companion.listen_to(bound)
    return bound
