"""The `objects` of a scene: a list of sections, each of one of the registered kinds."""

from collections.abc import Mapping, Sequence
from functools import reduce
from operator import or_
from typing import Annotated, Any

from pydantic import BeforeValidator, Field
from pydantic.fields import FieldInfo

from mimoc.base.errors import suggestion
from mimoc.schema.base import KeyedError
from mimoc.schema.components.objects import OBJECTS
from mimoc.schema.composition import described_field
from mimoc.schema.object_base import ObjectSpec, PointSpec

USUAL = "shape"
"""The kind of an object that does not say."""
MOST = 50
"""Objects in a scene."""


def objects_field() -> FieldInfo:
    """Return the field `objects` of a scene."""
    sections: list[Any] = [kind.spec for kind in OBJECTS.values()]
    choice: Any = Annotated[reduce(or_, sections), Field(discriminator="kind")] if len(sections) > 1 else sections[0]
    item = Annotated[choice, BeforeValidator(_with_kind)]
    about = "Objects at places of your choice; by default, none."
    return described_field(Annotated[tuple[item, ...], Field(max_length=MOST)], (), about)


def _with_kind(value: Any) -> Any:
    """Return a section with its kind, the usual one if it does not say."""
    return {"kind": USUAL, **value} if isinstance(value, Mapping) else value


def check_names(objects: Sequence[ObjectSpec]) -> None:
    """Check that each object has a name of its own.

    Raises:
        KeyedError: If two have the same.
    """
    taken = set[str]()
    for number, item in enumerate(objects):
        if item.name in taken:
            message = f"there is another object '{item.name}'; give each a name of its own"
            raise KeyedError(("objects", number, "name"), message)
        taken.add(item.name)


def check_start(objects: Sequence[ObjectSpec], name: str, pose: str) -> None:
    """Check that an infant can start at the object of a name, in a pose.

    Raises:
        KeyedError: If it cannot.
    """
    number = next((number for number, item in enumerate(objects) if item.name == name), None)
    if number is None:
        known = [item.name for item in objects]
        message = f"there is no object '{name}'; {suggestion(name, known) if known else 'add it to the objects'}"
        raise KeyedError(("start_at",), message, against=("objects",))
    item, kind = objects[number], OBJECTS[objects[number].kind]
    if not kind.poses:
        kinds = " or ".join(kind.name for kind in OBJECTS.values() if kind.poses)
        raise KeyedError(("start_at",), f"'{name}' is a {kind.name}; an infant starts at a {kinds}")
    if pose not in kind.poses:
        message = f"at a {kind.name}, an infant starts {' or '.join(kind.poses)}; change it"
        raise KeyedError(("pose",), message, against=("start_at",))
    at = item.at
    if isinstance(at, str) or (isinstance(at, PointSpec) and (at.frame != "world" or at.z_cm is not None)):
        message = "the infant starts at this; give only x_cm and y_cm in the world, or leave it out"
        raise KeyedError(("objects", number, "at"), message, against=("start_at",))
