"""What a caregiver can do, and the script of a spec, which says when."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import Field, StringConstraints, model_validator

from mimoc.schema.base import KeyedError, Model
from mimoc.schema.body import PartName
from mimoc.schema.expressions import AdultExpression
from mimoc.schema.quantities import Identifier, Milliseconds, Real

ActName = Literal[
    "show_face",
    "smile",
    "look_at",
    "look_away",
    "speak",
    "offer",
    "hold",
    "release",
    "still_face",
    "interact",
]
"""Names of acts."""


class Act(NamedTuple):
    """What an act can be told."""

    what: str | None = None
    """The key of what it is about, which it needs."""
    numbers: tuple[str, ...] = ()
    """Keys of its numbers."""


ACTS: Mapping[str, Act] = {
    "show_face": Act("face"),
    "smile": Act(None, ("duration_ms",)),
    "look_at": Act(),
    "look_away": Act(),
    "speak": Act(None, ("pitch_hz", "level_db", "duration_ms")),
    "offer": Act("object"),
    "hold": Act("part", ("weight_share",)),
    "release": Act(),
    "still_face": Act(),
    "interact": Act(),
}


class ActSpec(Model):
    """Something that the caregiver does at a time of each episode."""

    at_s: Annotated[Real, Field(ge=0, le=100_000, json_schema_extra={"unit": "s"})] = 0.0
    """When it begins, from the start of an episode: a whole number of physics steps."""
    do: ActName
    """What it does: `show_face`; `smile`, which passes; `look_at` the infant; `look_away`; `speak`; `offer` an object,
    within the infant's reach; `hold` a part of the infant; `release` what it holds; `still_face`: a neutral face that
    looks at the infant and answers nothing; `interact`: the face of the start, and answers again."""
    face: AdultExpression | None = None
    """The expression of `show_face`."""
    object: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=255)] | None = None
    """The object or toy that is offered: its name, or of a toy that of its kind, such as `ball`."""
    part: PartName | None = None
    """The part of the infant that is held."""
    weight_share: Annotated[Real, Field(ge=0, le=1)] | None = None
    """Of `hold`, the share of the infant's weight that is carried; without it, the part is held where it is."""
    duration_ms: Annotated[Milliseconds, Field(gt=0, le=60_000)] | None = None
    """How long it smiles or speaks; by default, 1500 and 400 ms."""
    pitch_hz: Annotated[Real, Field(ge=50, le=2000, json_schema_extra={"unit": "hz"})] | None = None
    """Fundamental frequency of the voice; by default, 260 Hz."""
    level_db: Annotated[Real, Field(ge=0, le=120, json_schema_extra={"unit": "db"})] | None = None
    """Sound pressure level of the voice 1 m from the mouth; by default, 60 dB."""
    infant: Identifier | None = None
    """In a world with several infants, the one that it attends to from then on."""

    @model_validator(mode="after")
    def _says_what_it_is_about(self) -> Self:
        act, given = ACTS[self.do], self.about
        if act.what and act.what not in given:
            raise KeyedError(("do",), f"'{self.do}' needs '{act.what}'; add it")
        for key in given:
            if key != act.what and key not in act.numbers:
                raise KeyedError((key,), f"'{self.do}' has no '{key}'; leave it out", against=("do",))
        return self

    @property
    def about(self) -> dict[str, Any]:
        """What is said of it besides its name and time, by key."""
        values = {key: getattr(self, key) for key in type(self).model_fields if key not in ("at_s", "do", "infant")}
        return {key: value for key, value in values.items() if value is not None}


def check_acts(script: Sequence[ActSpec]) -> None:
    """Check that a script is in order of time.

    Raises:
        KeyedError: If it is not.
    """
    for number in range(1, len(script)):
        if script[number].at_s < script[number - 1].at_s:
            before = script[number - 1].at_s
            raise KeyedError(("script", number, "at_s"), f"the act before begins at {before:g} s; put them in order")
