"""The `body` of a spec: its size, its hands, its looks, and deviations from the average child."""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticKnownError

from mimoc.anatomy.parts import PARTS, extra_kinds, kinds_of_hands
from mimoc.base.errors import suggestion
from mimoc.schema.base import KeyedError, Model, omitting
from mimoc.schema.names import (
    MEASUREMENT_KEYS,
    SIDED_MEASUREMENT_KEYS,
    SIDES,
    all_limb_bodies,
    bodies_of,
    limb_bodies,
    trunk_bodies,
)
from mimoc.schema.quantities import Centimetres, Distinct, Kilograms, Percentile, Real, among, keys_among

AdultExpression = Literal["neutral", "happy", "sad", "surprised", "angry", "disgusted", "scared"]
"""Facial expressions of a caregiver."""
Expression = Literal["neutral", "happy", "sad", "surprised", "angry", "disgusted", "scared", "sleepy", "crying"]
"""Facial expressions of an infant."""
ADULT_EXPRESSIONS: tuple[AdultExpression, ...] = get_args(AdultExpression)
EXPRESSIONS: tuple[Expression, ...] = get_args(Expression)


SkinTone = Literal["light", "fair", "medium", "tan", "brown", "dark"]
HairColour = Literal["black", "dark", "brown", "light_brown", "blond", "red"]
EyeColour = Literal["dark", "brown", "hazel", "green", "blue", "grey"]
Clothes = Literal["bodysuit", "shirt_and_trousers", "trousers", "nappy"]

BODYSUIT_UNTIL_MONTHS = 6.0
"""Age from which a shirt and trousers are put on by default (D): children begin to sit and to creep."""


class LooksSpec(Model):
    """What the infant looks like; of its numbers, only those of pictures and skin depend on it."""

    skin: SkinTone = "fair"
    """Tone of the skin, from light to dark; lips, cheeks, ears and folds follow it."""
    hair: HairColour = "brown"
    """Colour of hair and brows."""
    eyes: EyeColour = "blue"
    """Colour of the irises."""
    clothes: Clothes | None = None
    """What the infant wears: a bodysuit, a shirt and trousers, trousers alone or a nappy; by default a bodysuit below 6
    months of corrected age, and a shirt and trousers from then on. A growing infant keeps what it began with."""

    def clothes_at(self, corrected_age_months: float) -> Clothes:
        """Return what an infant of an age wears, counted from term if it was born before.

        Example:
            >>> from mimoc.schema.body import LooksSpec
            >>> LooksSpec().clothes_at(3), LooksSpec().clothes_at(9), LooksSpec(clothes="nappy").clothes_at(9)
            ('bodysuit', 'shirt_and_trousers', 'nappy')
        """
        by_age: Clothes = "bodysuit" if corrected_age_months < BODYSUIT_UNTIL_MONTHS else "shirt_and_trousers"
        return self.clothes or by_age


def _known_measurement(key: str) -> str:
    if key in MEASUREMENT_KEYS or key in SIDED_MEASUREMENT_KEYS:
        return key
    metric = re.sub("(_mm|_m)?$", "_cm", key, count=1)
    if metric in MEASUREMENT_KEYS or metric in SIDED_MEASUREMENT_KEYS:
        raise ValueError(f"unknown measurement; write '{metric}', in cm")
    side, _, unsided = key.partition("_")
    if side in SIDES and unsided in MEASUREMENT_KEYS:
        raise ValueError(f"this measurement has no sides; write '{unsided}'")
    known = SIDED_MEASUREMENT_KEYS if side in SIDES else MEASUREMENT_KEYS
    raise ValueError(f"unknown measurement; {suggestion(key, known)}")


def _known_part(name: str) -> str:
    if name in trunk_bodies() or name in all_limb_bodies():
        return name
    raise ValueError(f"unknown part of the body; {suggestion(name, trunk_bodies() + all_limb_bodies())}")


def _removable(name: str) -> str:
    if name in trunk_bodies():
        raise ValueError(f"'{name}' cannot be removed; remove only limbs and eyes")
    if name not in all_limb_bodies():
        raise ValueError(f"'{name}' is not a limb; {suggestion(name, all_limb_bodies())}")
    return name


def _choice(names: Callable[[], Sequence[str]]) -> tuple[BeforeValidator, FieldInfo]:
    """Return what marks a name that is one of those of registered kinds, whichever these are by then."""

    def known(name: Any) -> Any:
        if name in (known := names()):
            return name
        if not known:
            raise ValueError("no script or plug-in has added any; register or install it first (docs/own_part.md)")
        raise PydanticKnownError("literal_error", {"expected": " or ".join(map(repr, known))})

    return BeforeValidator(known), among(names)


HandsName = Annotated[str, *_choice(kinds_of_hands)]
ExtraName = Annotated[str, *_choice(extra_kinds)]
MeasurementKey = Annotated[str, AfterValidator(_known_measurement)]
PartName = Annotated[str, AfterValidator(_known_part), among(lambda: trunk_bodies() + all_limb_bodies())]
LimbName = Annotated[str, AfterValidator(_removable), among(all_limb_bodies)]
Factor = Annotated[Real, Field(ge=0.5, le=2)]
"""Scale factor of a part, or of a child's pace, within the range that is plausible."""


LENGTHS_CM, WEIGHTS_KG, HEADS_CM = (35.0, 110.0), (1.0, 25.0), (25.0, 60.0)
"""Smallest and largest value of any child up to two years of age."""

INDICATORS: Mapping[str, str] = {
    "length_cm": "length_percentile",
    "weight_kg": "weight_percentile",
    "head_circumference_cm": "head_percentile",
}
"""What can be measured of an individual, by the names of WHO's standards, and the key of its percentile."""

LENGTHS = ("length_cm", "length_percentile")  # What says how long an individual is.
FAT = ("fat_percentile", "fat_percent")  # Keys of an individual's fat, of which one may be given.


class IndividualSpec(Model):
    """An individual child, by its size, its fat and the rate at which it matures, in place of the average child.

    At another age it is the same child, with the same z-scores and the same rate. A measure and its percentile may both
    be given if they agree on WHO's charts, to 0.05 cm or kg; the measure counts.
    """

    sex: Literal["male", "female"] | None = None
    """Sex of the child, which selects the WHO tables; required if a percentile is given."""
    length_percentile: Percentile | None = None
    """Recumbent length, as WHO percentile for sex and age."""
    length_cm: Annotated[Centimetres, Field(ge=LENGTHS_CM[0], le=LENGTHS_CM[1])] | None = None
    """Recumbent length, measured."""
    weight_percentile: Percentile | None = None
    """Weight, as WHO percentile for sex and age."""
    weight_kg: Annotated[Kilograms, Field(ge=WEIGHTS_KG[0], le=WEIGHTS_KG[1])] | None = None
    """Weight, measured."""
    head_percentile: Percentile | None = None
    """Head circumference, as WHO percentile for sex and age."""
    head_circumference_cm: Annotated[Centimetres, Field(ge=HEADS_CM[0], le=HEADS_CM[1])] | None = None
    """Head circumference, measured."""
    fat_percentile: Percentile | None = None
    """Share of fat, as percentile among healthy infants of the age; by default it follows from length and weight."""
    fat_percent: Annotated[Real, Field(ge=1, le=60, json_schema_extra={"unit": "percent"})] | None = None
    """Share of fat in the weight, measured."""
    maturation_rate: Factor | None = None
    """How fast it matures; 1 is average. Strength, muscle tone and ranges of joints are those of the average child at
    this many times its age."""

    @model_validator(mode="after")
    def _is_one_child(self) -> Self:
        given = [key for pair in INDICATORS.items() for key in pair if getattr(self, key) is not None]
        if not given and all(getattr(self, key) is None for key in (*FAT, "maturation_rate")):
            message = (
                "gives no length, weight or head circumference, no fat and no rate of maturation; add one, such as "
                "'length_percentile: 50', or omit it"
            )
            raise KeyedError((), message)
        if all(getattr(self, key) is not None for key in FAT):
            raise KeyedError((FAT[0],), f"says the same as '{FAT[1]}'; leave one of the two out", against=(FAT[1],))
        percentiles = [key for key in given if key.endswith("_percentile")]
        if percentiles and self.sex is None:
            raise KeyedError(("sex",), f"is missing, and '{percentiles[0]}' needs it; add 'sex: female' or 'sex: male'")
        return self


class PartSpec(Model):
    """Scale factors of one part of the body, relative to its size at the infant's age."""

    length: Factor = 1.0
    """Factor on the length of the part, which also moves everything attached to it."""
    girth: Factor = 1.0
    """Factor on the thickness of the part."""


class BodySpec(Model):
    """The body of the infant."""

    hands: HandsName = "mitten"
    """Hands whose fingers move together (`mitten`, 44 actuators) or independently (`five_finger`, 88)."""
    extra: Annotated[tuple[ExtraName, ...], *Distinct] | None = None
    """Parts that the infant has besides a child's, such as a tail: those that plug-ins or scripts add."""
    chest_joint: Annotated[bool, Field(strict=True)] = False
    """Whether the chest can bend and twist relative to the upper body, which adds two actuators."""
    individual: IndividualSpec | None = None
    """An individual child; by default, the average child of the AnthroKids tables. It sets size and maturity of the
    whole body; `measurements` then replace single sizes, and `parts` scale single parts. Two values of one size are an
    error."""
    size_is_known: Annotated[bool, Field(strict=True)] = True
    """Whether the child's overall size is known. It is not if a child was fitted to a film without a scale
    (`mimoc retarget`): its proportions are its own, but it is of the average child's size, so that it is compared
    with no growth standard."""
    measurements: Mapping[MeasurementKey, Annotated[Centimetres, Field(le=150)]] = Field(
        default_factory=dict, json_schema_extra=keys_among(MEASUREMENT_KEYS + SIDED_MEASUREMENT_KEYS)
    )
    """Measurements that replace those predicted from age and individual, by AnthroKids name; the prefix `left_` or
    `right_` selects one side, on which it counts. At another age, each keeps its ratio to the average child's."""
    parts: Mapping[PartName, PartSpec] = Field(
        default_factory=dict,
        json_schema_extra=lambda schema: schema.update(keys_among(trunk_bodies() + all_limb_bodies())),
    )
    """Scale factors of single parts, by name of the body, on what they would be otherwise."""
    remove: Annotated[tuple[LimbName, ...], *Distinct] = ()
    """Limbs or eyes to remove, together with everything attached to them."""
    expression: Expression = "neutral"
    """Facial expression."""
    looks: LooksSpec = Field(default_factory=LooksSpec)
    """Colours of skin, hair and eyes, and clothes."""
    skin: Annotated[bool, Field(strict=True)] | None = None
    """Whether a smooth skin with clothes is drawn over the solids; by default, of a single infant it is, and of many
    infants (cohorts and batches) only if they see it."""

    @model_validator(mode="after")
    def _has_a_skin_that_fits(self) -> Self:
        if self.skin and PARTS.distribution(self.hands) != "mimoc":
            raise KeyedError(
                ("skin",), f"there is no skin for '{self.hands}' hands; leave this out", against=("hands",)
            )
        return self

    @model_validator(mode="after")
    def _knows_its_size_or_not(self) -> Self:
        length = self.individual and next((key for key in LENGTHS if getattr(self.individual, key) is not None), None)
        if length and not self.size_is_known:
            message = f"contradicts '{length}' of 'individual', which says how long the child is; leave one of them out"
            raise KeyedError(("size_is_known",), message, against=("individual", length))
        return self

    @model_validator(mode="after")
    def _names_parts_it_has(self) -> Self:
        named = [*(("parts", name) for name in self.parts), *(("remove", index) for index in range(len(self.remove)))]
        limbs = limb_bodies(self.hands, self.extra or ()) if named else ()
        for key in named:
            name = self.remove[key[1]] if isinstance(key[1], int) else key[1]
            if name not in limbs and name not in trunk_bodies():
                message = f"a body with {self.hands} hands has no '{name}'; {suggestion(name, limbs)}"
                if kind := next((kind for kind in extra_kinds() if name in bodies_of(kind)), None):
                    message = f"'{name}' belongs to '{kind}'; add 'extra: [{kind}]' to the body, or leave this out"
                raise KeyedError(key, message, against=("hands",))
        return self

    _serialized = omitting("size_is_known")
