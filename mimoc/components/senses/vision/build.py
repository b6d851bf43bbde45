"""Vision on a body: its cameras, and how mature its eyes are in acuity, contrast, colour, field, focus and more.

Most of these laws are derived from several sources, as each table says; none is a table of one study. `docs/vision.md`
says how far each can be trusted.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.vision import CSF_EXPONENT, AcuitySpec, VisionEntry, VisionSpec


def build(spec: VisionSpec, body: BodyTree) -> Placed:
    """Return the entry, and the cameras of the eyes with the field of view that is asked for."""
    cameras = sensor_sites.cameras(body, spec.fovy_deg)
    names = {part.name for part in body.bodies}
    fields = {"contrast": "linear", "foveation": spec.foveation} | maturity_of(spec, body.age_months)
    left = dict(body.acuity)
    entry = VisionEntry(
        cameras=tuple(camera.name for eye in cameras.values() for camera in eye),
        width_px=spec.width_px,
        height_px=spec.height_px,
        supersample=spec.supersample,
        acuity_cpd=resolve_acuity(spec, body.age_months),
        acuity_shares=tuple(left.get(eye, 1.0) for eye in cameras) if left else (),
        field_deg=dict(body.field_deg),
        foveation_radius=spec.foveation_radius,
        unseen=tuple(name for name in sensor_sites.UNSEEN if name in names),
        # By the published law, eyes see solids unless the spec asks for skins.
        body="solids" if spec.body is None and body.development == "published" else spec.body,
        **fields,
    )
    return Placed(entry, cameras=cameras, origins=_origins(spec, entry))


def _origins(spec: VisionSpec, entry: VisionEntry) -> dict[str, dict[str, object]]:
    origins = dict(_impaired(entry)) | dict(_matured(spec, entry))
    if entry.acuity_cpd is None:
        return origins
    if isinstance(spec.acuity, (int, float, str)):
        rule = PROFILES[spec.acuity_profile].rule
        sources = ["spec.senses.vision.acuity", "spec.senses.vision.acuity_profile", "spec.age_months"]
    else:
        rule = "given by the spec"
        sources = ["spec.senses.vision.acuity.cpd"]
    origin = {"value": entry.acuity_cpd, "unit": "cycles/deg", "rule": rule, "from": sources}
    return {"vision.acuity_cpd": origin, **origins}


def _matured(spec: VisionSpec, entry: VisionEntry) -> Iterator[tuple[str, dict[str, object]]]:
    for name, rule, keys in rules_of(spec):
        unit = UNITS.get(name, "1")
        sources = [f"spec.senses.vision.{key}" for key in keys]
        yield (
            f"vision.{name}",
            {"value": getattr(entry, name), "unit": unit, "rule": rule, "from": [*sources, "spec.age_months"]},
        )


def _impaired(entry: VisionEntry) -> Iterator[tuple[str, dict[str, object]]]:
    rule = "given by the spec"
    if entry.acuity_shares:
        yield (
            "vision.acuity_shares",
            {"value": list(entry.acuity_shares), "unit": "1", "rule": f"{rule}: impairments.acuity"},
        )
    for direction, angle_deg in entry.field_deg.items():
        at = [f"spec.impairments.field_deg.{direction}"]
        yield f"vision.field_deg.{direction}", {"value": angle_deg, "unit": "deg", "rule": rule, "from": at}


NEWBORN_CPD = 0.64
"""Acuity at birth on the scale of the TAC II, estimated: the fit of `tac2` begins at one month, with 0.66."""
TAC2_MONTHS = 1.0, 36.0  # Ages that the fit of `tac2` covers.
TAC2_LOG2_CPD = -0.1839, 1.8235, -0.5889
"""Binary logarithm of acuity over the natural logarithm of months, highest power first. It rises until 142 months.

Fitted by weight to the monocular acuities of Mayer et al. 1995 and of Salomão & Ventura 1995, lowered by 0.3 octave to
the scale of the TAC II: what Neijzen et al. 2025, the source of MIMo v2's paper, pools (rms 0.26 octave).
"""
MAYER_1995_CPD: Mapping[float, float] = dict(
    zip(
        (1, 1.5, 2.5, 4, 6, 9, 12, 18, 24, 30, 36, 48),
        (0.94, 1.11, 2.16, 2.68, 5.65, 6.79, 6.42, 8.59, 9.57, 11.52, 21.81, 24.81),
        strict=True,
    )
)
"""Mean monocular acuity by months, Mayer et al. 1995; it falls a little from 9 months to 12."""
MIMO_V2_CPD: Mapping[float, float] = {
    1: 0.85,
    2: 1.74,
    3: 2.67,
    4: 3.63,
    6: 5.64,
    9: 8.29,
    12: 9.38,
    18: 9.89,
    24: 11.6,
}
"""By months, as MIMo v2 has it."""


def resolve_acuity(vision: VisionSpec, age_months: float) -> float | None:
    """Return the finest grating that an infant sees, in cycles per degree; None where nothing is blurred."""
    if isinstance(vision.acuity, AcuitySpec):
        return vision.acuity.cpd
    if vision.acuity == "off":
        return None
    return acuity_at(age_months if vision.acuity == "age" else vision.acuity, vision.acuity_profile)


def acuity_at(age_months: float, profile: str) -> float:
    """Return the finest grating seen at an age, in cycles per degree, by one of `PROFILES`."""
    return PROFILES[profile].acuity_cpd(age_months)


def _tac2(age_months: float) -> float:
    """Return what the fit says; below its first month, acuity rises evenly from a newborn's."""
    first, last = TAC2_MONTHS
    fitted = 2 ** np.polyval(TAC2_LOG2_CPD, np.log(np.clip(age_months, first, last)))
    return float(NEWBORN_CPD + min(age_months / first, 1.0) * (fitted - NEWBORN_CPD))


def _interpolated(table_cpd: Mapping[float, float], age_months: float) -> float:
    """Return a table's acuity, its logarithm interpolated over that of age; before its first age it is the first's."""
    months = np.log(list(table_cpd))
    cpd = np.log(list(table_cpd.values()))
    return float(np.exp(np.interp(np.log(max(age_months, min(table_cpd))), months, cpd)))


@dataclass(frozen=True, slots=True)
class AcuityProfile:
    """Acuity by age, from one set of measurements."""

    acuity_cpd: Callable[[float], float]
    rule: str  # What it goes by, for `mimoc explain`.


PROFILES: Mapping[str, AcuityProfile] = {
    "tac2": AcuityProfile(
        _tac2,
        "log2 of acuity = -.1839 ln²t + 1.8235 ln t - .5889 at t months, fitted to Mayer et al. 1995 and Salomão & "
        "Ventura 1995 on the scale of the TAC II (Neijzen et al. 2025)",
    ),
    "mayer1995": AcuityProfile(
        partial(_interpolated, MAYER_1995_CPD), "Mayer et al. 1995, log acuity interpolated over log age"
    ),
    "mimo_v2": AcuityProfile(
        partial(_interpolated, MIMO_V2_CPD), "the figures of MIMo v2, log acuity interpolated over log age"
    ),
}
"""From birth to 24 months, no profile but Mayer's ever falls."""

ADULT_CPD = 40.0  # Acuity of adults, to whose contrast sensitivity and fovea infants' are compared.


@dataclass(frozen=True, slots=True)
class AgeCurve:
    """A number by age in months, interpolated linearly, or its logarithm; constant before and after."""

    by_month: Mapping[float, float]
    adult: float  # What it comes to in adults; of most, no entry says so, as nothing is limited then.
    source: str  # Where it is from, for `mimoc explain`.
    is_logarithmic: bool = False

    def __call__(self, maturity: float | str, age_months: float) -> float:
        """Return the number at the age that is asked for: `adult`, `age` (the infant's), or some months."""
        if maturity == "adult":
            return self.adult
        months = np.array(list(self.by_month))
        values = np.array(list(self.by_month.values()))
        at = age_months if isinstance(maturity, str) else maturity
        if self.is_logarithmic:
            return float(np.exp(np.interp(at, months, np.log(values))))
        return float(np.interp(at, months, values))


SENSITIVITY = AgeCurve(
    {0: 3.5, 1: 5, 2: 8, 3: 12, 4: 16, 6: 28, 9: 40, 12: 50, 18: 70, 24: 90},
    250.0,
    "largest contrast sensitivity by preferential looking, within a factor of 2: Banks & Salapatek 1981 and Atkinson "
    "1977 at 1 to 6 months (quoted from memory), derived beyond",
    is_logarithmic=True,
)
CHROMA_GAIN = AgeCurve(
    {0: 0.05, 1: 0.1, 2: 0.3, 3: 0.6, 6: 0.8, 12: 1.0},
    1.0,
    "a guess, from which colours infants tell apart: Adams & Courage 1995, 1998",
)
ADULT_PURITY, KNOBLAUCH_MONTHS, KNOBLAUCH_EXPONENT = 0.005, 192.0, 0.95
PURITY = AgeCurve(
    {0.0: 0.5}
    | {
        months: ADULT_PURITY * (KNOBLAUCH_MONTHS / months) ** KNOBLAUCH_EXPONENT
        for months in (3.0, 4.0, 6.0, 9.0, 12.0, 18.0, 24.0, 36.0)
    },
    ADULT_PURITY,
    "half at birth (.41 to .65 by colour, Adams & Courage 1998), from three months on .005 (192 / months)^.95 "
    "(Knoblauch et al. 2001: nearly half with each doubling of age), evenly in between (derived)",
    is_logarithmic=True,
)
NOTICED_DEG = AgeCurve(
    {0: 28, 2: 28, 3: 40, 5: 55, 9: 65, 12: 75, 24: 85},
    90.0,
    "half width of the field, derived from Mohn & van Hof-van Duin 1986 (quoted from memory) and Dobson et al. 1998",
)
UNFOCUSED = AgeCurve(
    {0: 1.0, 1.5: 1.0, 4: 0.0},
    0.0,
    "derived: fixed focus near 25 cm at birth (19 cm in Haynes et al. 1965, 30 in Hainline et al. 1992), near adults' "
    "at four months",
)
FOCUS_DEPTH_DIOPTRES = AgeCurve(
    {1: 1.0, 3: 0.5}, 0.5, "depth of focus (Banks 1980 as quoted from memory): ± 1 dioptre at 1, .5 at 3 months"
)
VERGENCE = AgeCurve(
    {3: 0.0, 5: 1.0}, 1.0, "derived from the onset of stereopsis at four months (Held et al. 1980, Birch et al. 1982)"
)
FLICKER_HZ = AgeCurve(
    {2: 2.0, 3: 5.0, 4: 10.0, 6: 15.0},
    50.0,
    "derived: a low-pass filter whose limit is near the frequency that infants see best (Rasengane et al. 1997, "
    "Hartmann & Banks 1992)",
)
ITERATIONS = 100  # More than enough for all digits that are written of any sensitivity from 3 on.
MIN_FOVEATION, FOVEATION_EXPONENT = 0.5, 0.5
FOVEA_RULE = "foveation of adults x (acuity / 40)^.5, not below .5: a guess"
SENSITIVITY_PEAK_RULE = (
    "acuity over the ratio at which the template S (x e^(1-x))^.82 of contrast sensitivity falls to 1, x = f / peak"
)


def maturity_of(vision: VisionSpec, age_months: float) -> dict[str, Any]:
    """Return the fields of a `VisionEntry` that say how mature eyes are, of those that are not off."""
    fields: dict[str, Any] = {name: curve(maturity, age_months) for name, maturity, curve in _asked(vision)}
    if "sensitivity" in fields:
        fields["contrast"] = "threshold"
        acuity_cpd = resolve_acuity(vision, age_months) or _acuity_of(vision.contrast, vision, age_months)
        fields["sensitivity_peak_cpd"] = acuity_cpd / cut_off_ratio(fields["sensitivity"])
    elif vision.contrast != "off":
        fields["contrast"] = vision.contrast
    if _is_limited(vision.fovea) and vision.foveation:
        fields["foveation"] = foveation_at(vision, age_months)
    return fields


def rules_of(vision: VisionSpec) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Yield the field of the entry, where it comes from, and the keys of the sense that it goes by, of what matures."""
    for name, _, curve in _asked(vision):
        yield name, curve.source, (KEYS[name],)
    if is_threshold(vision):
        yield "sensitivity_peak_cpd", SENSITIVITY_PEAK_RULE, ("contrast", "acuity", "acuity_profile")
    if _is_limited(vision.fovea) and vision.foveation:
        yield "foveation", FOVEA_RULE, ("fovea", "foveation", "acuity_profile")


def is_threshold(vision: VisionSpec) -> bool:
    """Return whether contrast has a threshold."""
    return vision.contrast not in ("linear", "mimo3", "off")


def is_given(vision: VisionSpec, key: str) -> bool:
    """Return whether something matures, or is as in adults, in a sense: it is not off."""
    return is_threshold(vision) if key == "contrast" else getattr(vision, key) not in (None, "off")


def cut_off_ratio(sensitivity: float) -> float:
    """Return at how many times the frequency of its peak a contrast sensitivity falls to 1.

    From S (x e^(1-x))^p = 1 follows x = 1 + ln(S) / p + ln x, which converges for x > 1.
    """
    start = 1 + np.log(sensitivity) / CSF_EXPONENT
    ratio = start
    for _ in range(ITERATIONS):
        ratio = start + np.log(ratio)
    return float(ratio)


def foveation_at(vision: VisionSpec, age_months: float) -> float:
    """Return the strength of foveation of a fovea that is not mature: s (a / 40)^.5, at least .5 or s."""
    share = (_acuity_of(vision.fovea, vision, age_months) / ADULT_CPD) ** FOVEATION_EXPONENT
    return min(vision.foveation, max(MIN_FOVEATION, vision.foveation * share))


def _asked(vision: VisionSpec) -> Iterator[tuple[str, float | str, AgeCurve]]:
    """Yield the field, the maturity that is asked for, and the curve of all that is not off."""
    if is_threshold(vision):
        yield "sensitivity", vision.contrast, SENSITIVITY
    for name, curve in CURVES.items():
        maturity = getattr(vision, KEYS[name])
        if _is_limited(maturity) or (maturity == "adult" and name in LIMITED_IN_ADULTS):
            yield name, maturity, curve


def _is_limited(maturity: float | str | None) -> bool:
    return maturity not in (None, "off", "adult")


def _acuity_of(maturity: Any, vision: VisionSpec, age_months: float) -> float:
    if maturity == "adult":
        return ADULT_CPD
    return acuity_at(age_months if maturity == "age" else float(maturity), vision.acuity_profile)


CURVES: Mapping[str, AgeCurve] = {
    "purity_threshold": PURITY,
    "chroma_gain": CHROMA_GAIN,
    "noticed_deg": NOTICED_DEG,
    "unfocused": UNFOCUSED,
    "focus_depth_dioptres": FOCUS_DEPTH_DIOPTRES,
    "vergence": VERGENCE,
    "flicker_hz": FLICKER_HZ,
}
KEYS: Mapping[str, str] = {
    "sensitivity": "contrast",
    "purity_threshold": "colour",
    "chroma_gain": "colour",
    "noticed_deg": "field",
    "unfocused": "focus",
    "focus_depth_dioptres": "focus",
    "vergence": "vergence",
    "flicker_hz": "flicker",
}
"""The key of the sense that each field goes by."""
UNITS = {
    "sensitivity_peak_cpd": "cycles/deg",
    "noticed_deg": "deg",
    "focus_depth_dioptres": "dioptres",
    "flicker_hz": "Hz",
}
"""Units of those that have one."""
LIMITED_IN_ADULTS = ("purity_threshold", "chroma_gain")
"""What has an entry for adults, too; their flicker fusion, at 50 Hz and more, is beyond what 100 pictures a second
show."""
