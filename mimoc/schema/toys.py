"""The `toys` of a spec's scene."""

from typing import Annotated, Self

from pydantic import Field, StringConstraints, model_validator
from pydantic.fields import FieldInfo

from mimoc.schema.base import KeyedError, Model, choice_field, composed, own_sections
from mimoc.schema.kinds import TOY_SOURCES
from mimoc.schema.quantities import Centimetres, Distinct, Identifier, PathText, Rising, Whole

ToyCount = Annotated[Whole, Field(ge=0, le=50)]
ToySize = Annotated[Centimetres, Field(ge=0.5, le=100)]
ToyName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=255)]


def _fields() -> dict[str, FieldInfo]:
    about = " ".join(f"`{source.name}`: {source.about}" for source in TOY_SOURCES.values())
    return {"source": choice_field(TOY_SOURCES, "builtin", about), **own_sections(TOY_SOURCES)}


@composed(_fields)
class ToysSpec(Model):
    """The toys around the infant."""

    source: str = "builtin"
    """Where the toys come from."""
    root: PathText | None = None
    """Folder with the data of a source such as `toys4k`, relative to the spec's folder; `~` and environment variables
    are expanded."""
    subset: Annotated[tuple[ToyName, ...], *Distinct] = ()
    """Categories, such as `ball`, and single objects, such as `truck_003`, to choose from; by default, all. In a folder
    of your own meshes, the file names without their extensions."""
    count: Annotated[tuple[ToyCount, ToyCount], Rising] = (3, 6)
    """Range of the number of toys."""
    size_cm: Annotated[tuple[ToySize, ToySize], Rising] = (4.0, 12.0)
    """Range of the length of a toy's longest side."""
    infant: Identifier | None = None
    """In a world with several infants, the one that they are around; by default, the first."""

    @model_validator(mode="after")
    def _has_a_root(self) -> Self:
        if TOY_SOURCES[self.source].needs_root and self.root is None:
            advice = "add the folder you unpacked it to"
            raise KeyedError(("root",), f"is missing, and 'source: {self.source}' needs it; {advice}")
        return self
