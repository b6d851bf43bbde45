"""The names of regions and presets of the `impairments`, and what is refused of them."""

import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.anatomy.parts import kinds_of_hands
from mimoc.base.errors import SpecError
from mimoc.schema.impairments import PRESETS, ImpairmentsSpec
from mimoc.schema.infant import healthy
from mimoc.schema.names import BODY, RANGED, REGIONS, contradiction, of_place, place_of

HEAD = {"mimoc": 1, "name": "kim", "age_months": 9}


def spec(**impairments) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({**HEAD, "impairments": impairments})


def complete(**impairments) -> ImpairmentsSpec:
    return ImpairmentsSpec.model_validate(impairments).complete


def joints(hands: str) -> dict[str, str]:
    anatomy = assemble(hands, True)
    return {joint.name.format(side=side): side for side, part in anatomy.parts for joint in part.joints}


@pytest.mark.parametrize("hands", kinds_of_hands())
def test_every_joint_of_a_child_is_at_a_place_of_its_side(hands):
    for joint, side in joints(hands).items():
        place = place_of(joint)
        assert place in REGIONS[BODY] | {"eyes"}, joint
        assert place.startswith(side) or place == "eyes", joint


@pytest.mark.parametrize("hands", kinds_of_hands())
def test_a_contracture_is_of_a_joint_that_there_is(hands):
    assert set(RANGED.values()) <= joints(hands).keys()


@given(st.dictionaries(st.sampled_from(sorted(REGIONS)), st.floats(0, 1), max_size=5))
def test_of_a_joint_the_smallest_region_counts_if_nothing_contradicts(values):
    if contradiction(values):
        return
    for place in REGIONS[BODY]:
        sizes = {name: len(REGIONS[name]) for name in values if place in REGIONS[name]}
        result = of_place(place, values)
        assert (result is None) == (not sizes)
        if result:
            assert sizes[result[0]] == min(sizes.values())
            assert values[result[0]] == result[1]


def test_an_arm_includes_its_hand_and_a_side_its_arm():
    assert REGIONS["right_hand"] < REGIONS["right_arm"] < REGIONS["right_side"] < REGIONS["body"]
    assert REGIONS["legs"] == REGIONS["left_leg"] | REGIONS["right_leg"]


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_says_what_it_is_and_builds(name):
    preset = PRESETS[name]
    side = {"side": "left"} if preset.has_side else {}
    assert preset.about
    assert mimoc.build(spec(preset=name, **side)).manifest.child.length_cm > 40
    assert not any("{" in region for region in complete(preset=name, **side).weakness)


def test_what_is_given_counts_in_place_of_the_preset():
    asked = complete(preset="hemiparesis", side="right", weakness={"right_hand": 0.9})
    assert asked.weakness["right_hand"] == 0.9
    assert asked.weakness["right_arm"] == PRESETS["hemiparesis"].keys["weakness"]["{side}_arm"]


@pytest.mark.parametrize(
    ("impairments", "key"),
    [
        ({"preset": "hemiparesis"}, "impairments.side"),
        ({"side": "left"}, "impairments.side"),
        ({"preset": "hemiparessis", "side": "left"}, "impairments.preset"),
        ({"weakness": {"right_arms": 0.5}}, "impairments.weakness.right_arms"),
        ({"weakness": {"right_arm": 1.5}}, "impairments.weakness.right_arm"),
        ({"weakness": {"right_side": 0.5, "arms": 0.2}}, "impairments.weakness.right_side"),
        ({"preset": "diplegia", "weakness": {"right_side": 0.5}}, "impairments.weakness.right_side"),
        ({"tone": {"legs": {"kind": "stiff"}}}, "impairments.tone.legs.kind"),
        ({"tone": {"legs": {"kind": "hypotonic", "gain": 2}}}, "impairments.tone.legs.gain"),
        ({"range": {"left_elbow": [-20, -90]}}, "impairments.range.left_elbow"),
        ({"range": {"left_thumb": [-20, 0]}}, "impairments.range.left_thumb"),
        ({"delay": {"trunk": 2}}, "impairments.delay.trunk"),
        ({"delay": {"body": 0.5}}, "impairments.delay.body"),
        ({"acuity": {"left": 0.5}}, "impairments.acuity.left"),
        ({"field_deg": {"right": 120}}, "impairments.field_deg.right"),
        ({"gestation_weeks": 20}, "impairments.gestation_weeks"),
    ],
)
def test_what_is_wrong_is_refused_at_its_key(impairments, key):
    with pytest.raises(SpecError) as refusal:
        spec(**impairments)
    (problem,) = refusal.value.problems
    assert problem.key == key
    assert "; " in problem.message


def test_a_child_before_term_is_refused_with_the_age_that_there_is():
    with pytest.raises(SpecError, match=r"age_months.*give 2\.3 or more"):
        mimoc.InfantSpec.model_validate({**HEAD, "age_months": 1, "impairments": {"preset": "preterm"}})


def test_noise_of_servos_is_refused():
    with pytest.raises(SpecError, match=r"impairments\.noise"):
        mimoc.InfantSpec.model_validate(
            {**HEAD, "actuation": {"model": "position"}, "impairments": {"noise": {"arms": 0.2}}}
        )


@given(st.floats(22, 42), st.floats(5, 24))
def test_age_is_corrected_to_40_weeks_of_children_born_before_37(weeks, age):
    infant = mimoc.InfantSpec.model_validate({**HEAD, "age_months": age, "impairments": {"gestation_weeks": weeks}})
    early = (40 - weeks) * 7 / 30.4375 if weeks < 37 else 0
    assert infant.corrected_age_months == pytest.approx(age - early)


def test_the_healthy_child_is_the_same_without_impairments():
    """By percentiles, it is the same child; in cm, one at the same percentiles if it was born before term."""
    child = {"body": {"individual": {"sex": "female", "length_percentile": 25}}}
    infant = mimoc.InfantSpec.model_validate({**HEAD, **child, "impairments": {"preset": "hypotonia"}})
    assert healthy(infant) == mimoc.InfantSpec.model_validate({**HEAD, **child})
    measured = {"body": {"individual": {"sex": "female", "length_cm": 64.0}}}
    preterm = mimoc.InfantSpec.model_validate({**HEAD, **measured, "impairments": {"preset": "preterm"}})
    assert healthy(preterm).body.individual.length_cm > 66


def test_a_measured_child_born_early_keeps_its_corrected_percentiles_as_it_grows():
    child = {"individual": {"sex": "female", "length_cm": 64.0}}
    preterm = mimoc.InfantSpec.model_validate({**HEAD, "body": child, "impairments": {"gestation_weeks": 30}})
    term = mimoc.InfantSpec.model_validate({**HEAD, "age_months": preterm.corrected_age_months, "body": child})
    grown = preterm.with_(age_months=12)
    assert grown.body.individual.length_cm == pytest.approx(
        term.with_(age_months=grown.corrected_age_months).body.individual.length_cm, abs=1e-6
    )
