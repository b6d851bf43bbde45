"""Refusal of keys of a spec that say something of what the infant does not have: removed parts, senses that are off."""

from collections.abc import Iterable, Mapping
from typing import Any

from mimoc.body.anatomy import Anatomy, assemble
from mimoc.schema.base import KeyedError
from mimoc.schema.body import BodySpec
from mimoc.schema.key_paths import KeyPath
from mimoc.schema.names import SIDES, single_groups, unsided

REMOVED = ("body", "remove")


def check_parts(body: BodySpec, groups: Mapping[KeyPath, Iterable[str]]) -> None:
    """Check that an infant has the parts that keys of its spec are about.

    Args:
        body: The body.
        groups: Names of muscle groups, by the path of the section that names them.

    Raises:
        KeyedError: If the infant has none of the parts that a key is about.
    """
    if not body.remove:
        return
    anatomy = assemble(body.hands, body.chest_joint, "published", body.extra or ())
    gone = removed(anatomy, body.remove)
    for name in body.parts:
        if name in gone:
            _refuse(("body", "parts", name), f"'{name}' is removed, so it has no size")
    for key in body.measurements:
        if unsided(key) in anatomy.follows and unsided(key) not in _followed(anatomy, gone, _side(key)):
            _refuse(("body", "measurements", key), "all that follows this is removed")
    left = _groups(anatomy, gone)
    for path, names in groups.items():
        for index, name in enumerate(names):
            if single_groups([name]) and not single_groups([name]) & left:
                key = name if path[-1] == "strength" else index
                _refuse((*path, key), f"all of '{name}' is removed")


def check_delays(delays: Mapping[str, Any], senses: Mapping[str, Any]) -> None:
    """Check that senses with a delay of their own are on.

    Args:
        delays: The section `delays`, by key.
        senses: The section of each sense, or None if it is off.

    Raises:
        KeyedError: If one is off.
    """
    for name, section in senses.items():
        if section is None and delays.get(f"{name}_ms"):
            message = f"'{name}' is off, so it has no delay; add '{name}: {{}}' to the senses, or remove this"
            raise KeyedError(("delays", f"{name}_ms"), message, against=("senses", name))


def removed(anatomy: Anatomy, names: Iterable[str]) -> set[str]:
    """Return the parts that are missing if some are removed: these, and all that is attached to them."""
    gone = set(names)
    for side, part in anatomy.parts:  # Parents come first.
        if (part.parent or "").format(side=side) in gone:
            gone.add(part.name.format(side=side))
    return gone


def _side(key: str) -> str:
    return next((side for side in SIDES if key.startswith(f"{side}_")), "")


def _followed(anatomy: Anatomy, gone: set[str], only: str) -> set[str]:
    """Return the measurements that the remaining parts follow: those of one side, or all."""
    parts = [part for side, part in anatomy.parts if part.name.format(side=side) not in gone and only in ("", side)]
    of_geoms = (names for part in parts for geom in part.geoms for names in (geom.size_from, geom.position_from))
    return {name for part in parts for name in part.position_from}.union(*of_geoms)


def _groups(anatomy: Anatomy, gone: set[str]) -> set[str]:
    """Return the muscle groups that the remaining parts belong to."""
    groups: dict[str, str] = {}
    for side, part in anatomy.parts:
        name, parent = part.name.format(side=side), (part.parent or "").format(side=side)
        groups[name] = part.group.format(side=side) or groups.get(parent, "")
    return {group for name, group in groups.items() if name not in gone}


def _refuse(key: KeyPath, what: str) -> None:
    raise KeyedError(key, f"{what}; leave this out, or keep the part", against=REMOVED)
