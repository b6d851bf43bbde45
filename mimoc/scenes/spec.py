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
    """Your own textures, from which scenes with wallpapers draw besides mimoc's own.

    Each is a PNG or a folder of them; paths are relative to the spec's folder.
    """

    floor: PathText | None = None
    """For the floor."""
    ceiling: PathText | None = None
    """For the ceiling."""
    wall: PathText | None = None
    """For the walls."""


def _fields() -> dict[str, FieldInfo]:
    about = " ".join(f"`{kind.name}`: {kind.about}" for kind in SCENES.values())
    return {"kind": choice_field(SCENES, "flat", about), **own_sections(SCENES)}


@composed(_fields)
class SceneSpec(Model):
    """The world an infant is in."""

    kind: str = "flat"
    """The kind of scene."""
    seed: Annotated[Whole, Field(ge=0, le=2**53)] = 0
    """Seed of everything in the scene that is drawn at random."""
    pose: Literal["supine", "prone", "sitting", "standing"] = "supine"
    """How the infant starts; of the tasks, only `rollover` and `free` start from here.

    A bundle has the other poses too, but for those in which held parts or locked joints would be elsewhere.
    """
    held: Annotated[tuple[PartName, ...], Distinct] = ()
    """Parts of the infant that are fixed in the world, such as `chest`, as if it sat in a seat."""
    textures: TexturesSpec = Field(default_factory=TexturesSpec)
    """Your own textures for floor, ceiling and walls."""
    toys: ToysSpec | None = None
    """Toys; left out, there are none."""

    @model_validator(mode="after")
    def _toys_have_a_floor(self) -> Self:
        if self.toys and not SCENES[self.kind].has_floor:
            kinds = " or ".join(kind.name for kind in SCENES.values() if kind.has_floor)
            raise KeyedError(("toys",), f"toys require scene.kind: {kinds}; change it, or leave the toys out")
        return self

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return the section of a kind of scene, such as `room`."""
