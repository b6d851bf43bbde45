"""The companions of an environment: those of its bundle, and objects of a script's own."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import mujoco

from mimoc.actuation.voice import Voice
from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object, function_of
from mimoc.companions.caregiver.run import NAME, Caregiver
from mimoc.companions.companion import Companion, Companions, channel_of
from mimoc.noise.noise import NoiseStreams
from mimoc.objects import OBJECTS
from mimoc.senses.sense import Sense


def bind_companions(
    model: mujoco.MjModel,
    bundle: Any,
    streams: NoiseStreams,
    custom: Mapping[str, Companion],
    senses: Mapping[str, Sense] = MappingProxyType({}),
    voice: Voice | None = None,
) -> Companions:
    """Return the companions of an infant, bound to its model.

    Args:
        model: The infant and its world.
        bundle: The `mimoc.Bundle` it comes from.
        streams: Random numbers of the environment, by channel.
        custom: Objects of a script's own, by name; one may replace that of the bundle.
        senses: The infant's senses, which hear these companions, and some of which have one themselves.
        voice: Its voice, which they hear, too.

    Raises:
        KindError: If one of them is none.
    """
    companions = dict[str, Companion]()
    if bundle.manifest.caregiver:
        companions[NAME] = Caregiver()
    for name, companion in custom.items():
        check_custom_object(f"companion '{name}'", companion, "before_step", "an object such as a mimoc.Companion")
        if not isinstance(companion, Companion):
            raise KindError(f"companion '{name}' is {companion!r:.60}; pass an object of a subclass of mimoc.Companion")
    own = {name for name, companion in custom.items() if type(companion) is not type(companions.get(name))}
    companions |= custom
    kinds = sorted({item.kind for item in bundle.manifest.objects} & OBJECTS.keys() - custom.keys())
    acting = {name: code for name in kinds if (code := OBJECTS[name].run)}
    companions |= {name: function_of(code, "bind")() for name, code in acting.items()}  # They see what others apply.
    for name, companion in companions.items():
        companion.bind(model, bundle, streams[channel_of(name)])
    bound = Companions(
        companions, streams, {name: sense.companion for name, sense in senses.items() if sense.companion}, own
    )
    for listener in (*companions.values(), *senses.values()):
        listener.listen_to(bound, voice)
    return bound
