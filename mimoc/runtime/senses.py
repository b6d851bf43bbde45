"""Binding senses to a model: names are looked up once, and from then on each sense reads arrays."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import mujoco

from mimoc.base.errors import KindError
from mimoc.base.kinds import function_of
from mimoc.bundle.io import Bundle
from mimoc.runtime.custom_sense import CustomSense, TermSense, Zero
from mimoc.runtime.sense import Sense
from mimoc.schema.components.senses import SENSES

NONE: Mapping[str, Any] = MappingProxyType({})


def bind_senses(
    bundle: Bundle, model: mujoco.MjModel, former: Mapping[str, Sense] = NONE, custom: Mapping[str, Any] = NONE
) -> dict[str, Sense]:
    """Return the senses of an infant by name; one that has none observes nothing."""
    entries = dict(bundle.manifest.senses)
    kept = {name: sense for name, sense in former.items() if sense.rebind(entries.get(name), model)}
    for name in former.keys() - kept.keys():
        former[name].close()
    names = [name for name, entry in entries.items() if entry is not None]
    if taken := sorted(custom.keys() & set(names)):
        raise KindError(f"this infant has a sense '{taken[0]}' already; pass yours under another name")
    senses: dict[str, Sense] = {name: kept.get(name) or bind_sense(name, bundle, model) for name in names}
    senses |= {name: CustomSense(name, sense, model, bundle) for name, sense in custom.items()}
    owners: dict[str, str] = {}
    for name, sense in senses.items():
        for key in sense.spaces:
            if owners.setdefault(key, name) != name:
                raise KindError(f"the senses '{owners[key]}' and '{name}' both observe '{key}'; rename one of the two")
    return senses or {"nothing": TermSense("nothing", Zero(), ("nothing [0]",), low=0.0, high=1.0)}


def bind_sense(name: str, bundle: Bundle, model: mujoco.MjModel) -> Any:
    """Return one of the senses that an infant has; see `bind_senses`."""
    return function_of(SENSES[name].run, "bind")(getattr(bundle.manifest.senses, name), model, bundle)
