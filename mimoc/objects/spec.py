"""The `objects` of a scene: a list of sections, each of one of the registered kinds."""

from collections.abc import Mapping, Sequence
from functools import reduce
from operator import or_
from typing import Annotated, Any

from pydantic import BeforeValidator, Field
from pydantic.fields import FieldInfo

from mimoc.objects import OBJECTS
from mimoc.objects.spec_base import ObjectSpec
from mimoc.schema.base import KeyedError
from mimoc.schema.composition import described_field

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
