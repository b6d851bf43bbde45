"""How mature eyes are by age: what is entered, where it is monotone, and what an entry says."""

import numpy as np
import pytest

import mimoc
from mimoc.compiler.explain import entries_of
from mimoc.components.senses.vision import VisionEntry, VisionSpec, build_maturity as maturity
from mimoc.components.senses.vision.build_acuity import acuity_at
from mimoc.components.senses.vision.thresholds import sensitivity_at

AGES = np.linspace(0, 36, 73)
ALL_BY_AGE = dict.fromkeys(("contrast", "colour", "field", "focus", "vergence", "fovea", "flicker"), "age")
CURVES = {"sensitivity": maturity.SENSITIVITY, **maturity.CURVES}
FALLING = ("purity_threshold", "unfocused", "focus_depth_dioptres")


def built(age_months: float = 2, **vision) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": {"vision": vision}}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


@pytest.mark.parametrize("name", CURVES)
def test_all_curves_are_monotone_and_end_before_adults(name):
    values = [CURVES[name]("age", age) for age in AGES] + [CURVES[name].adult]
    steps = np.diff(values) * (-1 if name in FALLING else 1)
    assert (steps >= -1e-12).all()
    assert steps.sum() > 0


@pytest.mark.parametrize(
    ("name", "age_months", "value"),
    [
        ("sensitivity", 0, 3.5), ("sensitivity", 6, 28), ("sensitivity", 24, 90),
        ("chroma_gain", 1.5, 0.2), ("chroma_gain", 12, 1.0),
        ("purity_threshold", 0, 0.5), ("purity_threshold", 3, 52 * 0.005), ("purity_threshold", 24, 7.2 * 0.005),
        ("noticed_deg", 1, 28), ("noticed_deg", 4, 47.5), ("unfocused", 1, 1.0), ("unfocused", 4, 0.0),
        ("vergence", 3, 0.0), ("vergence", 4, 0.5), ("flicker_hz", 1, 2), ("flicker_hz", 9, 15),
    ],
)  # fmt: skip
def test_curves_go_through_what_is_entered(name, age_months, value):
    assert CURVES[name]("age", age_months) == pytest.approx(value, rel=0.02)
    assert CURVES[name](age_months, 20) == CURVES[name]("age", age_months)


@pytest.mark.parametrize(
    ("sensitivity", "ratio"), [(5, 4.5), (8, 5.2), (12, 5.8), (28, 7.0), (50, 7.8), (90, 8.6), (250, 10)]
)
def test_a_sensitivity_falls_to_1_at_the_acuity(sensitivity, ratio):
    solution = maturity.cut_off_ratio(sensitivity)
    assert solution == pytest.approx(ratio, abs=0.06)
    assert sensitivity_at(np.array(solution), sensitivity, 1.0) == pytest.approx(1.0)


def test_an_eye_without_these_keys_has_the_entry_that_it_had():
    """And so has one where all are off: no byte of a bundle's manifest is another."""
    plain, off = (built(**keys).manifest.senses.vision for keys in ({}, dict.fromkeys(ALL_BY_AGE, "off")))
    assert plain == off
    written = plain.model_dump(mode="json")
    assert written["contrast"] == "linear"
    assert not {*ALL_BY_AGE, "sensitivity", "sensitivity_peak_cpd", "purity_threshold", "noticed_deg"} & (
        written.keys() - {"contrast"}
    )
    assert "colour" not in built().files["resolved.yaml"].decode()


def test_an_eye_by_age_has_all_and_says_of_each_where_it_is_from():
    bundle = built(2, foveation=5, **ALL_BY_AGE)
    entry, origins = bundle.manifest.senses.vision, entries_of(bundle)
    assert (entry.contrast, entry.sensitivity, entry.unfocused, entry.vergence) == ("threshold", 8, 0.8, 0)
    assert entry.sensitivity_peak_cpd == pytest.approx(acuity_at(2, "tac2") / 5.18, rel=1e-3)
    assert entry.foveation == pytest.approx(5 * (acuity_at(2, "tac2") / 40) ** 0.5)
    names = [*CURVES, "sensitivity_peak_cpd", "foveation"]
    for name in names:
        assert origins[f"vision.{name}"]["value"] == pytest.approx(getattr(entry, name)), name
        assert "spec.age_months" in origins[f"vision.{name}"]["from"]
    assert "guess" in origins["vision.chroma_gain"]["rule"]


def test_an_adult_is_limited_by_little():
    entry = built(9, foveation=5, **dict.fromkeys(ALL_BY_AGE, "adult")).manifest.senses.vision
    assert (entry.sensitivity, entry.purity_threshold, entry.chroma_gain) == (250, 0.005, 1)
    assert (entry.noticed_deg, entry.unfocused, entry.vergence, entry.flicker_hz, entry.foveation) == (
        None, 0, 1, None, 5,
    )  # fmt: skip


def test_the_template_follows_the_acuity_that_is_asked_for():
    """Measured, of another age, or of nobody: then of the age of the contrast sensitivity."""
    ratio = maturity.cut_off_ratio(28)
    peaks = [
        maturity.maturity_of(VisionSpec.model_validate({"contrast": 6, "acuity": acuity}), 1)["sensitivity_peak_cpd"]
        for acuity in ({"cpd": 4.2}, 12, "off")
    ]
    assert peaks == pytest.approx([4.2 / ratio, acuity_at(12, "tac2") / ratio, acuity_at(6, "tac2") / ratio])


@pytest.mark.parametrize(("strength", "seen"), [(0.3, 0.3), (1, 0.5), (1000, 1000 * (0.64 / 40) ** 0.5)])
def test_a_newborns_fovea_is_weaker_but_never_stronger_than_an_adults(strength, seen):
    assert maturity.foveation_at(VisionSpec(foveation=strength, fovea="age"), 0) == pytest.approx(seen)


@pytest.mark.parametrize("law", ["linear", "mimo3"])
def test_the_laws_of_contrast_that_there_were_still_are(law):
    assert built(contrast=law).manifest.senses.vision.contrast == law


def test_a_threshold_without_its_numbers_is_no_entry():
    entry = built().manifest.senses.vision.model_dump()
    with pytest.raises(ValueError, match="they belong to the contrast law 'threshold'"):
        VisionEntry.model_validate({**entry, "contrast": "threshold"})
