"""The `impairments` of a spec: what differs from a healthy child, by side and part of the body."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from mimoc.base.errors import suggestion
from mimoc.schema.base import KeyedError, Model, given
from mimoc.schema.names import RANGED, REGIONS, SIDES, contradiction, known_movement, known_region
from mimoc.schema.quantities import Degrees, Direction, Real, keys_among

TERM_WEEKS, WEEKS_IN_A_MONTH = 40.0, 30.4375 / 7
"""Weeks of gestation from which ages are corrected (Engle 2004, Pediatrics 114: 1362), and weeks in a month."""

RegionName = Annotated[str, AfterValidator(known_region), Field(json_schema_extra={"enum": [*sorted(REGIONS)]})]
MovementName = Annotated[str, AfterValidator(known_movement), Field(json_schema_extra={"enum": [*sorted(RANGED)]})]
Share = Annotated[Real, Field(ge=0, le=1)]

PRETERM_WEEKS = 37.0  # Weeks of gestation from which on a birth is at term (WHO).

LIMBS = ("arm", "hand", "leg", "foot")
DELAYED = (
    *("body", "arms", "hands", "legs", "feet"),
    *(f"{side}_{part}" for side in SIDES for part in (*LIMBS, "side")),
)
"""Regions to and from which signals can be delayed."""


def _delayed(name: str) -> str:
    if name not in DELAYED:
        raise ValueError(f"signals cannot be delayed there; {suggestion(name, DELAYED)}")
    return name


DelayedRegion = Annotated[str, AfterValidator(_delayed), Field(json_schema_extra={"enum": list(DELAYED)})]
Eye = Literal["eyes", "left_eye", "right_eye"]


class ToneSpec(Model):
    """Muscle tone of a region that is not a healthy child's."""

    kind: Literal["spastic", "hypotonic"]
    """Too much, as a stretch reflex that answers speed (`spastic`), or too little (`hypotonic`)."""
    gain: Annotated[Real, Field(ge=0, le=10)] | None = None
    """Of spastic muscles, the reflex relative to a marked one (by default 1). Of hypotonic ones, what is left of muscle
    tone and of the joints' passive stiffness (by default 0.5)."""

    @property
    def amount(self) -> float:
        """The gain, or the default of its kind."""
        return {"spastic": 1.0, "hypotonic": 0.5}[self.kind] if self.gain is None else self.gain

    @model_validator(mode="after")
    def _leaves_a_share(self) -> Self:
        if self.kind == "hypotonic" and self.amount > 1:
            raise KeyedError(("gain",), f"{self.amount:g} is more tone than healthy; give 0 to 1, or kind: spastic")
        return self


@dataclass(frozen=True, slots=True)
class Preset:
    """A disorder."""

    about: str  # What it is, and where its figures are from.
    has_side: bool  # Whether it is of one side, `{side}` in the names of its regions.
    keys: Mapping[str, Any]  # Keys of the spec.


PRESETS: Mapping[str, Preset] = {
    "hemiparesis": Preset(
        "spastic weakness of one side, of the arm more than of the leg, and more further from the trunk (directions: "
        "Wiley & Damiano 1998; grip: Tomhave et al. 2015; sizes are assumptions)",
        True,
        {
            "weakness": {"{side}_arm": 0.4, "{side}_hand": 0.3, "{side}_leg": 0.7, "{side}_foot": 0.5},
            "tone": {"{side}_arm": {"kind": "spastic", "gain": 0.7}, "{side}_leg": {"kind": "spastic", "gain": 0.5}},
        },
    ),
    "diplegia": Preset(
        "spastic weakness of both legs, more further from the trunk, and a little of the trunk (directions: Wiley & "
        "Damiano 1998; sizes are assumptions)",
        False,
        {
            "weakness": {"legs": 0.6, "feet": 0.4, "trunk": 0.8},
            "tone": {"legs": {"kind": "spastic", "gain": 1.0}},
        },
    ),
    "brachial_plexus_palsy": Preset(
        "injury of C5 and C6 at birth: of the other side's strength, the shoulder has 28 %, the elbow 43 % and the "
        "hand 68 % (medians of external rotation, flexion and grip, and 25 degrees that the elbow lacks of straight, "
        "of 107 patients 12 years after surgery, Kirjavainen et al. 2011, Acta Orthop 82: 69-75)",
        True,
        {
            "weakness": {"{side}_shoulder": 0.28, "{side}_elbow": 0.43, "{side}_hand": 0.68},
            "range": {"{side}_elbow": [-150.0, -25.0]},
        },
    ),
    "hypotonia": Preset(
        "little tone and strength of all of the body (sizes are assumptions)",
        False,
        {"weakness": {"body": 0.6}, "tone": {"body": {"kind": "hypotonic", "gain": 0.4}}},
    ),
    "preterm": Preset("born at 30 weeks of gestation, otherwise healthy", False, {"gestation_weeks": 30.0}),
}
"""Disorders by name. Wiley & Damiano, Dev Med Child Neurol 40: 100-107; Tomhave et al., J Hand Surg 40: 900-907."""
PresetName = Literal["none", "hemiparesis", "diplegia", "brachial_plexus_palsy", "hypotonia", "preterm"]


class ImpairmentsSpec(Model):
    """What differs from a healthy child of the same age and size, by side and part of the body.

    A region means all that it contains: `right_arm` is shoulder, elbow, wrist and fingers. Of two regions that contain
    a joint, the smaller counts: `{right_side: 0.5, right_hand: 0.2}`.
    """

    preset: PresetName = "none"
    """A disorder; keys that are given beside it count in place of its own, region by region."""
    side: Literal["left", "right"] | None = None
    """Side of a preset that has one: `hemiparesis` and `brachial_plexus_palsy`."""
    weakness: Mapping[RegionName, Share] = Field(default_factory=dict, json_schema_extra=keys_among(sorted(REGIONS)))
    """Share of a healthy child's strength that is left, by region."""
    tone: Mapping[RegionName, ToneSpec] = Field(default_factory=dict, json_schema_extra=keys_among(sorted(REGIONS)))
    """Muscle tone that is not a healthy child's, by region."""
    range: Mapping[MovementName, tuple[Degrees, Degrees]] = Field(
        default_factory=dict, json_schema_extra=keys_among(sorted(RANGED))
    )
    """Contractures: the range that is left of a joint, lowest and highest angle in the model, by movement."""
    delay: Mapping[DelayedRegion, Annotated[Real, Field(ge=1, le=10)]] = Field(
        default_factory=dict, json_schema_extra=keys_among(DELAYED)
    )
    """Factor on the delays of commands to a region and of what is sensed there; `body` is everywhere."""
    noise: Mapping[RegionName, Share] = Field(default_factory=dict, json_schema_extra=keys_among(sorted(REGIONS)))
    """Noise of the commands to a region in place of `noise.motor`: standard deviation, as a share of the command."""
    acuity: Mapping[Eye, Annotated[Real, Field(ge=0.01, le=1)]] = Field(default_factory=dict)
    """Share of the visual acuity that is left, by eye."""
    field_deg: Mapping[Direction, Annotated[Degrees, Field(ge=0, le=90)]] = Field(
        default_factory=dict, json_schema_extra={"unit": "deg"}
    )
    """How far both eyes see to a side of their line of sight; where nothing is said, as far as their pictures reach."""
    gestation_weeks: Annotated[Real, Field(ge=22, le=42, json_schema_extra={"unit": "weeks"})] | None = None
    """Weeks of gestation at birth. Strength, joints and senses of a child who was born before 37 weeks are those of its
    corrected age, from 40 weeks on. At term it is smaller, fatter and less flexed than others; it catches up to 24
    months, unless `individual` gives its size."""

    @property
    def complete(self) -> "ImpairmentsSpec":
        """What is given, and what the preset adds where nothing is."""
        return ImpairmentsSpec.model_validate(self._completed()) if self.preset != "none" else self

    def _completed(self) -> dict[str, Any]:
        """Return the same as plain data, without the preset."""
        data = {key: value for key, value in given(self).items() if key not in ("preset", "side")}
        for key, value in PRESETS[self.preset].keys.items() if self.preset != "none" else ():
            if isinstance(value, Mapping):
                data[key] = {name.format(side=self.side): item for name, item in value.items()} | data.get(key, {})
            else:
                data.setdefault(key, value)
        return data

    @property
    def birth_key(self) -> str:
        """The key that says at how many weeks the child was born, if any does."""
        return "gestation_weeks" if self.gestation_weeks is not None else "preset"

    @property
    def months_early(self) -> float:
        """How many months before term the child was born, by which its age is corrected; 0 from term on."""
        weeks = self._completed().get("gestation_weeks", TERM_WEEKS)
        return (TERM_WEEKS - weeks) / WEEKS_IN_A_MONTH if weeks < PRETERM_WEEKS else 0.0

    @model_validator(mode="after")
    def _has_a_side_where_it_needs_one(self) -> Self:
        sided = self.preset != "none" and PRESETS[self.preset].has_side
        if sided and self.side is None:
            message = f"is missing, and '{self.preset}' has one; add 'side: left' or 'side: right'"
            raise KeyedError(("side",), message, against=("preset",))
        if not sided and self.side is not None:
            names = " and ".join(repr(name) for name, preset in PRESETS.items() if preset.has_side)
            raise KeyedError(("side",), f"only the presets {names} have one; leave it out", against=("preset",))
        return self

    @model_validator(mode="after")
    def _says_one_thing_of_each_part(self) -> Self:
        data = self._completed()
        for key in ("weakness", "tone", "delay", "noise"):
            if (pair := contradiction(data.get(key, {}))) is not None:
                first, second = sorted(pair[:2], key=lambda name: name in getattr(self, key))
                advice = f"name smaller regions, such as '{pair[2]}'"
                message = f"'{first}' and '{second}' differ on the {pair[2].replace('_', ' ')}; {advice}"
                raise KeyedError((key, second), message, against=(key, first))
        return self

    @model_validator(mode="after")
    def _leaves_ranges(self) -> Self:
        for name, (low, high) in self.range.items():
            if not -180 <= low < high <= 180:
                message = f"[{low:g}, {high:g}] is no range of angles; write [lowest, highest], from -180 to 180"
                raise KeyedError(("range", name), message)
        return self
