"""The `scene` of a spec: the world around the infant."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from mimoc.schema.base import ComposedModel, KeyedError, KeyPath, Model, choice_field, composed, omitting, own_sections
from mimoc.schema.body import PartName
from mimoc.schema.caregiver import CaregiverSpec
from mimoc.schema.kinds import SCENES
from mimoc.schema.objects import ObjectSpec, ToysSpec, check_names, check_start, objects_field
from mimoc.schema.quantities import Distinct, Identifier, PathText, Whole


class TexturesSpec(Model):
    """Your own textures, which scenes with wallpaper choose from in addition to mimoc's.

    Each is a PNG file or a folder of PNG files; paths are relative to the spec's folder.
    """

    floor: PathText | None = None
    """Textures for the floor."""
    ceiling: PathText | None = None
    """Textures for the ceiling."""
    wall: PathText | None = None
    """Textures for the walls."""


def infants_named(scene: "SceneSpec") -> Iterator[tuple[KeyPath, str]]:
    """Yield the keys of a scene that name one of several infants, relative to the scene, and the names."""
    sections: list[tuple[KeyPath, Any]] = [(("objects", number), item) for number, item in enumerate(scene.objects)]
    sections += [(("toys",), scene.toys), (("caregiver",), scene.caregiver)]
    acts = scene.caregiver.script if scene.caregiver else ()
    sections += [(("caregiver", "script", number), act) for number, act in enumerate(acts)]
    for path, section in sections:
        if section and section.infant is not None:
            yield (*path, "infant"), section.infant


def _fields() -> dict[str, FieldInfo]:
    about = " ".join(f"`{kind.name}`: {kind.about}" for kind in SCENES.values())
    return {"kind": choice_field(SCENES, "flat", about), **own_sections(SCENES), "objects": objects_field()}


@composed(_fields)
class SceneSpec(ComposedModel):
    """The world around the infant."""

    kind: str = "flat"
    """The kind of scene."""
    seed: Annotated[Whole, Field(ge=0, le=2**53)] = 0
    """Random seed of the scene: of its room, textures and toys."""
    pose: Literal["supine", "prone", "sitting", "standing"] = "supine"
    """Starting pose; of the tasks, only `rollover` and `free` use it.

    A bundle also contains the other poses, except those in which held parts or locked joints would be elsewhere.
    """
    held: Annotated[tuple[PartName, ...], *Distinct] = ()
    """Parts of the infant that are fixed in space, such as `chest` for an infant that is strapped into a seat."""
    textures: TexturesSpec = Field(default_factory=TexturesSpec)
    """Your own textures for floor, ceiling and walls."""
    toys: ToysSpec | None = None
    """The toys; by default, none."""
    objects: tuple[ObjectSpec, ...] = ()
    """Objects at places of your choice; by default, none."""
    caregiver: CaregiverSpec | None = None
    """An adult by the infant, who acts and answers; by default, none."""

    start_at: Identifier | None = None
    """The object that the infant starts on, in or at: on a `mat` or a `slope`, in a `seat`, standing at a `rail` or a
    `table`. With coordinates, it takes the infant there; without a place of its own, it is where the infant is."""

    _serialized = omitting("objects", "start_at", "caregiver")

    @model_validator(mode="after")
    def _objects_have_names_of_their_own(self) -> Self:
        check_names(self.objects)
        return self

    @model_validator(mode="after")
    def _starts_at_furniture(self) -> Self:
        if self.start_at is not None:
            check_start(self.objects, self.start_at, self.pose)
        return self

    @model_validator(mode="after")
    def _caregiver_can_be_there(self) -> Self:
        if self.caregiver and (self.kind == "crib" or not SCENES[self.kind].has_floor):
            reason = "arms would go through the bars" if self.kind == "crib" else "there is no floor"
            raise KeyedError(("caregiver",), f"{reason}; choose another scene.kind, or remove the caregiver")
        return self

    @model_validator(mode="after")
    def _what_is_offered_is_there(self) -> Self:
        names = {item.name for item in self.objects}
        for number, act in enumerate(self.caregiver.script if self.caregiver and not self.toys else ()):
            if act.object is not None and act.object not in names:
                path = "caregiver", "script", number, "object"
                message = f"there is no '{act.object}' in this scene; add it to the scene's objects, or toys"
                raise KeyedError(path, message, against=("objects",))
        return self

    @model_validator(mode="after")
    def _toys_have_a_floor(self) -> Self:
        if self.toys and not SCENES[self.kind].has_floor:
            kinds = " or ".join(kind.name for kind in SCENES.values() if kind.has_floor)
            raise KeyedError(("toys",), f"toys require scene.kind: {kinds}; change it, or remove the toys")
        return self
