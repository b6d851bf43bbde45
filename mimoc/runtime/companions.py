"""The companions of an environment: those of its bundle, and objects of a script's own."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Protocol

import mujoco

from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object, function_of
from mimoc.runtime.companion import Companion, Companions, SoundsOf, channel_of
from mimoc.runtime.noise.noise import NoiseStreams
from mimoc.runtime.sense import Sense
from mimoc.runtime.voice import Voice
from mimoc.schema.components.companions import COMPANIONS
from mimoc.schema.components.objects import OBJECTS


class Infant(Protocol):
    """An infant whose companions are bound."""

    @property
    def companions(self) -> Companions:
        """Its own companions, and if it is the first, those of its world."""
        ...

    @property
    def senses(self) -> Mapping[str, Sense]:
        """Its senses."""
        ...

    @property
    def voice(self) -> Voice | None:
        """Its voice, if it has one."""
        ...


def bind_companions(
    model: mujoco.MjModel,
    bundle: Any,
    streams: NoiseStreams,
    custom: Mapping[str, Companion],
    senses: Mapping[str, Sense] = MappingProxyType({}),
    voice: Voice | None = None,
    world: Any = None,
) -> Companions:
    """Return the companions of an infant, bound to its model.

    What acts on several infants, a caregiver and water, is bound once, with the first of them.
    """
    whole = world if bundle.manifest.prefix else bundle
    present = [name for name in COMPANIONS if whole and getattr(whole.manifest, name)]
    companions: dict[str, Companion] = {name: function_of(COMPANIONS[name], "bind")() for name in present}
    for name, companion in custom.items():
        check_custom_object(f"companion '{name}'", companion, "before_step", "an object such as a mimoc.Companion")
        if not isinstance(companion, Companion):
            raise KindError(f"companion '{name}' is {companion!r:.60}; pass an object of a subclass of mimoc.Companion")
        if not whole and companion.attends_to_all:
            raise KindError(f"companion '{name}': a world has one caregiver; pass it with the first infant")
    own = {name for name, companion in custom.items() if type(companion) is not type(companions.get(name))}
    companions |= custom
    objects = whole.manifest.objects if whole else ()
    kinds = sorted({item.kind for item in objects} & OBJECTS.keys() - custom.keys())
    acting = {name: code for name in kinds if (code := OBJECTS[name].run)}
    companions |= {name: function_of(code, "bind")() for name, code in acting.items()}  # They see what others apply.
    for name, companion in companions.items():
        is_shared = name in acting or companion.attends_to_all
        companion.bind(model, whole if is_shared else bundle, streams[channel_of(name)])
    bound = Companions(
        companions, streams, {name: sense.companion for name, sense in senses.items() if sense.companion}, own
    )
    for listener in (*companions.values(), *senses.values()):
        listener.listen_to(bound, voice)
    return bound


def hear_each_other(infants: Mapping[str, Infant]) -> None:
    """Let several infants of a world, by name, hear each other and all companions, and a caregiver hear all of them."""
    everywhere = SoundsOf([infant.companions for infant in infants.values()])
    for name, infant in infants.items():
        others = [other.voice for key, other in infants.items() if key != name and other.voice]
        for sense in infant.senses.values():
            sense.listen_to(everywhere, infant.voice, others)
        for companion in infant.companions.values():
            if companion.attends_to_all:
                companion.listen_to_infants({key: (one.companions, one.voice) for key, one in infants.items()})
            else:
                companion.listen_to(everywhere, infant.voice, others)
