"""The `objects` and `toys` of a scene: what a user can ask of each, what the manifest tells of objects, and moves."""

import math
import re
from collections.abc import Mapping, Sequence
from functools import reduce
from operator import or_
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    StringConstraints,
    Tag,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo

from mimoc.base.errors import check_name, suggestion
from mimoc.schema.base import KeyedError, Model, choice_field, composed, described_field, omitting, own_sections
from mimoc.schema.entries import Amount, Body, Geom, Joint, Label, Length, Lengths, Tendon
from mimoc.schema.kinds import OBJECTS, TOY_SOURCES
from mimoc.schema.quantities import (
    Centimetres,
    CyclesPerDegree,
    Degrees,
    Distinct,
    Identifier,
    PathText,
    Real,
    Rising,
    Whole,
)

Coordinate = Annotated[Real, Field(ge=-1000, le=1000, json_schema_extra={"unit": "cm"})]
Distance = Annotated[Centimetres, Field(le=1000)]
Material = Literal["wood", "plastic", "metal", "cloth", "rubber"]
Substance = Material | Literal["water"]
Motion = Literal["fixed", "free", "hanging", "sliding"]
WATER_KG_M3 = 1000.0  # Density of water, rounded.

RELATIONS = ("within reach of", "in front of", "beside", "on")  # What a place in words can begin with; a name follows.
WITH_A_GAP = ("in front of", "beside")  # Relations for which `distance_cm` counts.
_WORDS = re.compile(rf"({'|'.join(RELATIONS)}) (?:the )?([a-z][a-z0-9_]*)")


def in_words(text: str) -> tuple[str, str]:
    """Return the relation and the name of a place in words: `within reach of` and `right_hand`.

    Raises:
        ValueError: If it is none.
    """
    match = _WORDS.fullmatch(" ".join(text.split()))
    if match is None:
        choices = ", ".join(f"'{relation} NAME'" for relation in RELATIONS)
        raise ValueError(f"'{text[:40]}' is not a place; write {choices}, or {{x_cm: 20, y_cm: 0}}")
    return match[1], match[2]


def _known(text: str) -> str:
    in_words(text)
    return text


class PointSpec(Model):
    """A place by its coordinates."""

    x_cm: Coordinate = 0.0
    """Along x."""
    y_cm: Coordinate = 0.0
    """Along y."""
    z_cm: Coordinate | None = None
    """Height of its lowest point above the floor; by default, it rests on what is below it."""
    frame: Literal["world", "infant"] = "world"
    """Whose axes these are: the world's, or those with which the infant starts: from the floor below its hip, x
    forwards and y to its left. They differ in rooms, which put the infant somewhere."""


def _form_of_place(value: Any) -> str | None:
    forms = ((str, "words"), (dict, "coordinates"), (PointSpec, "coordinates"))
    return next((form for types, form in forms if isinstance(value, types)), None)


Place: TypeAlias = Annotated[
    Annotated[PointSpec, Tag("coordinates")]
    | Annotated[
        Annotated[
            str,
            StringConstraints(strict=True, max_length=100),
            AfterValidator(_known),
            Field(examples=["within reach of right_hand", "in front of chest", "beside left_hand"]),
        ],
        Tag("words"),
    ],
    Discriminator(_form_of_place),
    Field(json_schema_extra={"wanted": "a place; write 'within reach of right_hand' or {x_cm: 20, y_cm: 0}"}),
]
"""A place in words or by its coordinates."""


class ObjectSpec(Model):
    """An object, and its place; where this names the infant, it means the pose in which it starts."""

    kind: Any
    """Kind of object, as a `Literal`."""
    name: Annotated[Identifier, Field(examples=["my_object"])]
    """Its name, by which tasks, behaviours and recordings know it."""
    at: Place | None = None
    """Its place: coordinates, or words such as `within reach of right_hand`, `in front of chest` or `on table`."""
    above: Identifier | None = None
    """The part of the infant, or the object, above whose highest point it is."""
    height_cm: Distance | None = None
    """With `above`, the height of its lowest point above that; by default, 20 cm."""
    distance_cm: Distance | None = None
    """In front of something or beside it, the gap between the two, or more if there is something else; by default, 10
    cm."""
    yaw_deg: Annotated[Degrees, Field(ge=-360, le=360)] = 0.0
    """How far it is turned about the vertical, counterclockwise seen from above."""
    infant: Identifier | None = None
    """In a world with several infants, the one that its place and its ribbon are about; by default, the first."""

    @property
    def carries(self) -> bool:
        """Whether other things can stand on it."""
        return False

    @model_validator(mode="after")
    def _is_at_one_place(self) -> Self:
        if self.at is not None and self.above is not None:
            raise KeyedError(("above",), "it is at another place already; leave out 'at' or 'above'", against=("at",))
        if self.height_cm is not None and self.above is None:
            raise KeyedError(("height_cm",), "it is above nothing; add 'above', or leave this out", against=("above",))
        if self.distance_cm is not None and not (isinstance(self.at, str) and in_words(self.at)[0] in WITH_A_GAP):
            message = "only what is 'in front of' or 'beside' something has a gap to it; leave this out"
            raise KeyedError(("distance_cm",), message, against=("at",) if self.at is not None else ())
        return self


class WaterEntry(Model):
    """What there is to know of water, besides its place: a box on the origin of its body."""

    half_sides_m: Lengths
    """Half lengths along x and y."""
    depth_m: Length
    """Height of its surface above its bottom."""
    infant_kg_m3: Annotated[Amount, Field(ge=100)]
    """Density of the infant, the same in all its parts."""


class ObjectEntry(Model):
    """An object of the spec's `scene.objects`."""

    name: Label
    """Its name in the spec."""
    kind: Label
    """Its kind."""
    body: Body
    """Its outermost body in the model."""
    joint: Joint | None = None
    """The joint of that body; None if it is fixed to the world."""
    motion: Motion
    """How it moves as a whole."""
    geoms: tuple[Geom, ...]
    """All its geoms that touch."""
    material: Substance
    """What it is made of."""
    size_m: Amount
    """Length of its longest side."""
    mass_kg: Amount
    """Its mass."""
    height_m: Amount
    """From its lowest point, as it stands or hangs, to its highest."""
    origin_m: Amount
    """How far the origin of its body is above its lowest point."""
    surface_m: tuple[Amount, Amount] | None = None
    """Half lengths of the level surface on top of it, on which other objects can lie."""
    where: Label
    """Its place at the start, in words."""
    bells: tuple[Geom, ...] = ()
    """Those of its geoms that ring."""
    ribbon: Tendon | None = None
    """The ribbon that is tied to the infant, if there is one."""
    tied_to: Body | None = None
    """The part of the infant that this is tied to."""
    slack_m: Amount = 0.0
    """By how much the ribbon is longer than its way when it is tied."""
    water: WaterEntry | None = None
    """What there is to know of it if it is water."""

    _serialized = omitting("joint", "surface_m", "bells", "ribbon", "tied_to", "slack_m", "water")


def names_of(entries: Sequence[ObjectEntry]) -> list[str]:
    """Return the names of objects."""
    return [entry.name for entry in entries]


Side = Annotated[Centimetres, Field(ge=1, le=500)]
Share = Annotated[Real, Field(ge=0, le=1)]
Colour: TypeAlias = tuple[Share, Share, Share]
WOOD: Colour = (0.82, 0.66, 0.46)
CLOTH: Colour = (0.36, 0.52, 0.6)


class FurnitureSpec(ObjectSpec):
    """Furniture, which stands on the floor and does not move."""

    @property
    def carries(self) -> bool:
        """Whether other things can stand on it."""
        return True

    @model_validator(mode="after")
    def _stands(self) -> Self:
        if self.above is not None:
            raise KeyedError(("above",), "furniture stands on the floor; give its place with 'at'")
        return self


MAX_CYCLES = 512  # Largest number of cycles of a grating across a picture: each takes at least 8 texels.


class GratingSpec(Model):
    """Stripes whose brightness is a sine wave about the middle between black and white."""

    cpd: Annotated[CyclesPerDegree, Field(le=100)] = 1.0
    """Spatial frequency, in cycles per degree of the visual angle straight ahead, as seen from `from_cm`."""
    contrast: Annotated[Real, Field(ge=0, le=1)] = 1.0
    """Michelson contrast: (brightest - darkest) / (brightest + darkest); 0 is an even grey. Pictures have 256 shades:
    below 0.02, stripes are of two or three shades, and below 0.004 there are none."""
    from_cm: Annotated[Centimetres, Field(ge=5, le=500)] = 60.0
    """Viewing distance at which it has its spatial frequency."""
    stripes: Literal["vertical", "horizontal"] = "vertical"
    """How the stripes run."""

    @property
    def cycle_cm(self) -> float:
        """Length of a cycle: of one degree at the viewing distance, over the spatial frequency."""
        return self.from_cm * math.radians(1.0) / self.cpd


class PicturedSpec(FurnitureSpec):
    """Furniture that shows a picture to an infant before it, which looks along x."""

    width_cm: Side
    """Its width."""
    tall_cm: Side
    """Its height."""
    picture: PathText | None = None
    """A PNG file that it shows, relative to the folder of the spec; it is scaled down to 256 px."""
    grating: GratingSpec | None = None
    """A grating that it shows instead."""

    @model_validator(mode="after")
    def _shows_one_picture(self) -> Self:
        if self.picture is not None and self.grating is not None:
            raise KeyedError(("grating",), "it shows a picture already; leave out one of them", against=("picture",))
        return self

    @model_validator(mode="after")
    def _shows_all_stripes(self) -> Self:
        if self.grating is not None:
            across_cm = self.width_cm if self.grating.stripes == "vertical" else self.tall_cm
            if across_cm > MAX_CYCLES * self.grating.cycle_cm:
                most = MAX_CYCLES * self.grating.cycle_cm
                message = (
                    f"{across_cm:g} cm of it have more than {MAX_CYCLES} stripes; give {most:.3g} cm or less of it"
                )
                raise KeyedError(("grating", "cpd"), f"{message}, or fewer cycles per degree")
        return self


USUAL = "shape"  # The kind of an object that does not say.
MAX_OBJECTS = 50  # Objects in a scene.


def objects_field() -> FieldInfo:
    """Return the field `objects` of a scene."""
    sections: list[Any] = [kind.spec for kind in OBJECTS.values()]
    choice: Any = Annotated[reduce(or_, sections), Field(discriminator="kind")] if len(sections) > 1 else sections[0]
    item = Annotated[choice, BeforeValidator(_with_kind)]
    about = "Objects at places of your choice; by default, none."
    return described_field(Annotated[tuple[item, ...], Field(max_length=MAX_OBJECTS)], (), about)


def _with_kind(value: Any) -> Any:
    """Return a section with its kind, the usual one if it does not say."""
    return {"kind": USUAL, **value} if isinstance(value, Mapping) else value


def check_names(objects: Sequence[ObjectSpec]) -> None:
    """Check that each object has a name of its own; raise a KeyedError if two have the same."""
    taken = set[str]()
    for number, item in enumerate(objects):
        if item.name in taken:
            message = f"there is another object '{item.name}'; give each a name of its own"
            raise KeyedError(("objects", number, "name"), message)
        taken.add(item.name)


def check_start(objects: Sequence[ObjectSpec], name: str, pose: str) -> None:
    """Check that an infant can start at the object of a name, in a pose; raise a KeyedError if it cannot."""
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


MOVABLE_TO = "'within reach of left_hand', 'within reach of right_hand' or 'on NAME'"


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
Move = NewPlace | tuple[str, str]  # A place, or a relation in words with the name of what it is to.


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
            raise ValueError(f"object '{name}': it cannot be moved to '{place}'; write {MOVABLE_TO}")
        return relation, other
    try:
        return _PLACE.validate_python(place)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        what = first["msg"].lower()
        problem = f"{key}: {what}" if key else f"{place!r:.40} is not a place"
        raise ValueError(f"object '{name}': {problem}; give {{'x_cm': 20, 'y_cm': 0}}, or {MOVABLE_TO}") from None


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
