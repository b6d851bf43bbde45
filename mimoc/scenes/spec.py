"""The `scene` of a spec: the world an infant is in."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from mimoc.scenes import SCENES
from mimoc.schema.base import KeyedError, Model
from mimoc.schema.body import PartName
from mimoc.schema.composition import choice_field, composed, own_sections
from mimoc.schema.quantities import Distinct, PathText, Whole
from mimoc.toys.spec import ToysSpec


class TexturesSpec(Model):
    """A user's own pictures, drawn from besides mimoc's; each a PNG or a folder of them, seen from the spec's."""

    floor: PathText | None = None
    """For the floor of a room."""
    ceiling: PathText | None = None
    """For its ceiling."""
    wall: PathText | None = None
    """For its walls."""


def _fields() -> dict[str, FieldInfo]:
    about = "Nothing, a floor, a crib, or a furnished room."
    return {"kind": choice_field(SCENES, "flat", about), **own_sections(SCENES)}


@composed(_fields)
class SceneSpec(Model):
    """The world an infant is in."""

    kind: str = "flat"
    """Nothing, a floor, a crib, or a furnished room."""
    seed: Annotated[Whole, Field(ge=0, le=2**53)] = 0
    """Of everything drawn by chance."""
    pose: Literal["supine", "prone", "sitting", "standing"] = "supine"
    """How the infant starts; of the tasks, only `rollover` and `free` start from here.

    A bundle has the other poses too, but for those in which what is held or locked would be elsewhere.
    """
    held: Annotated[tuple[PartName, ...], Distinct] = ()
    """Parts of the infant that stay where they are in the world, such as `chest`, as if in a seat."""
    textures: TexturesSpec = Field(default_factory=TexturesSpec)
    """What else its floor, ceiling and walls may look like."""
    toys: ToysSpec | None = None
    """Toys; left out, there are none."""

    @model_validator(mode="after")
    def _toys_have_a_floor(self) -> Self:
        if self.toys and not SCENES[self.kind].has_floor:
            raise KeyedError(("toys",), "toys need a floor, and an empty world has none; use another kind of scene")
        return self

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return the section of a kind of scene, such as `room`."""
