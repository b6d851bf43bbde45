import pytest

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.compiler.mjcf.sensor_sites import UNSEEN
from mimoc.components.senses.vision import VisionSpec
from mimoc.components.senses.vision.build_acuity import acuity_at
from mimoc.components.senses.vision.build_comparison import DEFAULT_FOVEATION, compare_ages, read_ages


def test_each_age_is_shown_as_seen_and_foveated_beside_what_is_drawn():
    compared = compare_ages(VisionSpec(), "right", (1, 9), 128)
    acuities_cpd = [acuity_at(1, "tac2"), acuity_at(9, "tac2"), None]
    assert [[entry.acuity_cpd for entry in row] for row in compared.entries] == [acuities_cpd, acuities_cpd]
    assert [[entry.foveation for entry in row] for row in compared.entries] == [[0] * 3, [DEFAULT_FOVEATION] * 3]
    assert (len(compared.rows), len(compared.columns)) == (2, 3)
    for entry in (entry for row in compared.entries for entry in row):
        assert (entry.cameras, entry.width_px, entry.height_px) == (("eye_right",), 128, 128)
        assert entry.unseen == UNSEEN


def test_captions_say_age_and_acuity():
    columns = compare_ages(VisionSpec(), "left", (1, 4.5), 64, profile="mimo_v2").columns
    assert columns == ("1 month: 0.85 cycles/degree", "4.5 months: 4.1 cycles/degree", "not blurred")


def test_profile_and_foveation_are_the_specs_unless_others_are_given():
    vision = VisionSpec(acuity_profile="mayer1995", foveation=2, foveation_radius="edge")
    usual = compare_ages(vision, "left", (6,), 64).entries[1][0]
    assert (usual.acuity_cpd, usual.foveation, usual.foveation_radius) == (pytest.approx(5.65), 2, "edge")
    other = compare_ages(vision, "left", (6,), 64, profile="mimo_v2", foveation=0).entries[1][0]
    assert (other.acuity_cpd, other.foveation) == (pytest.approx(5.64), 0)


@pytest.mark.parametrize(("text", "ages"), [("1,2,4", (1, 2, 4)), ("0", (0,)), (" 1.5 , 36", (1.5, 36))])
def test_ages_are_read(text, ages):
    assert read_ages(text) == ages


@pytest.mark.parametrize("text", ["", "one", "1,,2", "1;2", "-1", "37", "nan", "inf", "1,x"])
def test_what_is_no_list_of_ages_is_refused(text):
    with pytest.raises(MimocError, match="is not a list of ages; give months from 0 to 36"):
        read_ages(text)


def test_unknown_sides_and_profiles_are_refused():
    with pytest.raises(UnknownNameError, match="'up' is not a side; choose from left, right"):
        compare_ages(VisionSpec(), "up", (1,), 64)
    with pytest.raises(UnknownNameError, match="'mimo_v1' is not a profile of acuity; did you mean 'mimo_v2'"):
        compare_ages(VisionSpec(), "left", (1,), 64, profile="mimo_v1")


def test_what_matures_has_a_row_of_its_own():
    compared = compare_ages(VisionSpec(contrast="age", colour="age", field=1, flicker="age"), "left", (1, 12), 64)
    assert compared.rows[-1] == "all that matures"
    young, old, sharp = compared.entries[-1]
    assert (young.sensitivity, old.sensitivity) == pytest.approx((5, 50))
    assert sharp.sensitivity is None
    assert young.noticed_deg == old.noticed_deg == 28
    assert young.acuity_cpd == pytest.approx(acuity_at(1, "tac2"))
    assert len(compare_ages(VisionSpec(flicker="age"), "left", (1,), 64).rows) == 2, "flicker is in no still picture"
