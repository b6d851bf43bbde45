"""Places that objects are moved to by a reset."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from mimoc.base.errors import check_name
from mimoc.schema.base import Model
from mimoc.schema.object_base import Coordinate, in_words
from mimoc.schema.quantities import Degrees

RELATIONS = "'within reach of left_hand', 'within reach of right_hand' or 'on NAME'"


class NewPlace(Model):
    """A place that an object is moved to, in the world."""

    x_cm: Coordinate
    """Along x."""
    y_cm: Coordinate
    """Along y."""
    z_cm: Coordinate = 0.0
    """Height of its lowest point above the floor."""
    yaw_deg: Annotated[Degrees, Field(ge=-360, le=360)] = 0.0
    """How far it is turned about the vertical."""


_PLACE = TypeAdapter(NewPlace)
Move = NewPlace | tuple[str, str]
"""A place, or a relation in words with the name of what it is to."""


def checked_moves(moves: Any, names: Sequence[str]) -> dict[str, Move]:
    """Return where objects are moved to, by name.

    Args:
        moves: A place for each object that is moved.
        names: Of all objects.

    Raises:
        ValueError: If this is no dictionary of places.
        UnknownNameError: If there is no such object.
    """
    if not isinstance(moves, Mapping):
        raise ValueError(f"expected a dictionary of places by the name of the object, got {moves!r:.60}")
    for name in moves:
        check_name("named object of this scene", name, names)
    return {str(name): _checked(str(name), place) for name, place in moves.items()}


def _checked(name: str, place: Any) -> Move:
    if isinstance(place, str):
        relation, other = in_words(place)
        if relation not in ("within reach of", "on"):
            raise ValueError(f"object '{name}': it cannot be moved to '{place}'; write {RELATIONS}")
        return relation, other
    try:
        return _PLACE.validate_python(place)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key, what = ".".join(map(str, first["loc"])), first["msg"].lower()
        problem = f"{key}: {what}" if key else f"{place!r:.40} is not a place"
        raise ValueError(f"object '{name}': {problem}; give {{'x_cm': 20, 'y_cm': 0}}, or {RELATIONS}") from None
