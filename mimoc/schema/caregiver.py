"""What a user can ask of a caregiver, and what the manifest tells the runtime of it."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import Field, StringConstraints, model_validator

from mimoc.base.units import to_steps
from mimoc.schema.base import KeyedError, Model, omitting
from mimoc.schema.body import AdultExpression, PartName
from mimoc.schema.entries import Amount, Body, Duration, Geom, Label, Length, Material, Number, WeldName
from mimoc.schema.quantities import Centimetres, Identifier, Milliseconds, Real

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

    what: str | None = None  # The key of what it is about, which it needs.
    numbers: tuple[str, ...] = ()  # Keys of its numbers.


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


Behaviour = Literal["kick", "gaze", "vocalisation", "touch"]  # What an infant does that can be answered.
Place = Literal["in_front", "beside", "above"]
Side = Literal["left", "right"]
Seconds = Annotated[Real, Field(ge=0, le=100_000, json_schema_extra={"unit": "s"})]
Probability = Annotated[Real, Field(ge=0, le=1)]


class AnswersSpec(Model):
    """How the caregiver answers what the infant does."""

    to: Behaviour = "kick"
    """What is answered: a kick of a leg; gaze at the caregiver's face; the infant's voice; touching the caregiver."""
    by: Annotated[tuple[ActName, ...], Field(min_length=1, max_length=5)] = ("smile", "speak")
    """The acts of an answer, all at once: of `smile`, `speak`, `look_at` and `look_away`."""
    probability: Probability = 1.0
    """Of an answer to each."""
    delay_ms: Annotated[Milliseconds, Field(le=60_000)] = 400.0
    """From what the infant does to the answer, a whole number of physics steps."""
    pause_ms: Annotated[Milliseconds, Field(le=60_000)] = 1000.0
    """After an answer has begun, the time in which nothing is answered; nor is anything while an answer is due."""
    yoked_s: Annotated[tuple[Seconds, ...], Field(max_length=10_000)] = ()
    """Times of an episode at which the caregiver answers whatever the infant does, and then only: those at which the
    caregiver of another infant has answered, as a control for contingency."""

    @model_validator(mode="after")
    def _can_be_done_at_once(self) -> Self:
        for number, act in enumerate(self.by):
            if act not in ANSWERS:
                message = f"'{act}' is no answer; choose from {', '.join(ANSWERS)}"
                raise KeyedError(("by", number), message)
        return self


ANSWERS = ("smile", "speak", "look_at", "look_away")


class CaregiverSpec(Model):
    """A caregiver: a simple adult by the infant."""

    infant: Identifier | None = None
    """In a world with several infants, the one that it is by and attends to. By default, it is by the first, and
    answers whoever does what can be answered."""
    place: Place = "in_front"
    """Where its face is: where the infant's face looks to at the start, level to its side, or over it. By
    default, in a world with several infants, the first of these where it is within none of the others."""
    side: Side = "left"
    """The infant's side that `beside` means."""
    distance_cm: Annotated[Centimetres, Field(ge=20, le=200)] = 40.0
    """Distance between both faces."""
    height_cm: Annotated[Centimetres, Field(ge=15, le=200)] | None = None
    """Height of its face above the floor, in place of what follows from the others."""
    stature_cm: Annotated[Centimetres, Field(ge=140, le=200)] = 163.0
    """Its stature, which all its lengths follow."""
    expression: AdultExpression = "neutral"
    """Its facial expression at the start."""
    script: Annotated[tuple[ActSpec, ...], Field(max_length=1000)] = ()
    """What it does in every episode, in order of time."""
    answers: AnswersSpec | None = None
    """How it answers what the infant does; by default, it does not."""

    @model_validator(mode="after")
    def _script_is_in_order(self) -> Self:
        for number, (before, act) in enumerate(pairwise(self.script), start=1):
            if act.at_s < before.at_s:
                message = f"the act before begins at {before.at_s:g} s; put them in order"
                raise KeyedError(("script", number, "at_s"), message)
        return self


def check_times(spec: CaregiverSpec, timestep_ms: float) -> None:
    """Check that the times of a caregiver are whole physics steps; raise a KeyedError if one is not."""
    times: list[tuple[tuple[str | int, ...], float]] = [
        (("script", number, "at_s"), 1000 * act.at_s) for number, act in enumerate(spec.script)
    ]
    if spec.answers:
        times += [(("answers", key), getattr(spec.answers, key)) for key in ("delay_ms", "pause_ms")]
        times += [(("answers", "yoked_s", number), 1000 * at_s) for number, at_s in enumerate(spec.answers.yoked_s)]
    for key, time_ms in times:
        try:
            to_steps(time_ms, timestep_ms)
        except ValueError as error:
            path = ("scene", "caregiver", *key)
            raise KeyedError(path, str(error), against=("control", "timestep_ms")) from None


class ArmEntry(Model):
    """An arm of the caregiver."""

    bodies: tuple[Body, Body, Body]
    """Upper arm, forearm and hand, which programs move."""
    grip: WeldName
    """The constraint by which the hand holds things."""


class ActEntry(Model):
    """An act of the script."""

    at_ms: Annotated[Amount, Field(le=1e8)]
    """When it begins, from the start of an episode."""
    do: Label
    """The act."""
    what: Label | None = None
    """The face, object or part of the infant that it is about."""
    details: dict[Label, Number] = Field(default_factory=dict)
    """Its numbers, by the keys of the spec."""
    infant: Label | None = None
    """The infant of a world that it attends to from then on."""

    _serialized = omitting("what", "details", "infant")


class AnswersEntry(Model):
    """How the caregiver answers what the infant does."""

    to: Behaviour
    """What is answered."""
    by: tuple[Label, ...]
    """The acts of an answer."""
    probability: Annotated[float, Field(ge=0, le=1)]
    """Of an answer to each."""
    delay_ms: Duration | Annotated[Amount, Field(le=60_000)]
    """From what the infant does to the answer."""
    pause_ms: Annotated[Amount, Field(le=60_000)]
    """After an answer has begun, the time in which nothing is answered."""
    yoked_ms: tuple[Annotated[Amount, Field(le=1e8)], ...] = ()
    """Times at which it answers whatever the infant does; empty unless it is a control."""
    kick_m: Length
    """How far a leg is extended in a kick, from hip to foot."""

    _serialized = omitting("yoked_ms")


class CaregiverEntry(Model):
    """A caregiver."""

    head: Body
    """Its head, about the centre: x towards its face, y to its left."""
    neck: Body
    """Its neck."""
    trunk: Body
    """Its trunk, from the base of the neck."""
    arms: tuple[ArmEntry, ArmEntry]
    """The arms, the left one first."""
    face: Geom
    """The geom whose material is its expression."""
    materials: dict[Label, Material]
    """Material by expression."""
    mouth_m: tuple[Number, Number, Number]
    """The mouth in the frame of the head, from which it speaks."""
    infant_face_m: tuple[Number, Number, Number]
    """A point between the infant's eyes, in the frame of its head."""
    place: Place
    """Where its face is; see the spec."""
    side: Side
    """The infant's side that `beside` means."""
    distance_m: Length
    """Distance between both faces at the start."""
    height_m: Length | None = None
    """Height of its face above the floor."""
    scale: Length
    """Its lengths, by those of an adult of average size."""
    expression: Label
    """Its facial expression at the start."""
    script: tuple[ActEntry, ...] = ()
    """What it does in every episode."""
    answers: AnswersEntry | None = None
    """How it answers what the infant does."""
    infant: Label | None = None
    """The infant of a world that it is by."""
    answers_all: bool = False
    """Whether it answers the other infants of its world as well."""

    _serialized = omitting("height_m", "script", "answers", "infant", "answers_all")
