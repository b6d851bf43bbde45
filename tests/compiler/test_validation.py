"""What a spec may ask of a body: each measurement is one that a child of that age can have."""

import json

import mujoco
import pytest
from hypothesis import assume, given, strategies as st
from support.full import full_rows

import mimoc
from mimoc import fits
from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import Problem, SpecError
from mimoc.base.units import DAYS_PER_MONTH
from mimoc.body.grow import grow_tree
from mimoc.body.kinematics import Stature, stature
from mimoc.compiler import child
from mimoc.compiler.child import MAX_RATIO, MIN_RATIO, check_available
from mimoc.compiler.measuring import compile_infant
from mimoc.compiler.variants import at_age
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.names import MEASUREMENTS
from mimoc.studies.growth import GrowthReport, GrowthRow as Row, compare_with_who, grow_against_who, measure_compiled

MITTEN = assemble("mitten", False)
LAW = {"length_cm": 0.8, "weight_kg": 0.8, "head_circumference_cm": 0.8, "arm_circumference_cm": 1.0}
"""How far the average child may be from the mean of WHO's boys and girls, in standard deviations."""

SOME_DAYS = (1, 7, 11, 52, 91, 114, 128, 400, 652, 730)  # Between the months, and where the curves stray furthest.
AGES_MONTHS = sorted({*range(25), *(day / DAYS_PER_MONTH for day in SOME_DAYS)})


@pytest.fixture(scope="module")
def report() -> GrowthReport:
    return grow_against_who(months=AGES_MONTHS)


def infant(age_months: float) -> InfantSpec:
    return InfantSpec(mimoc=1, name="one", age_months=age_months)


def row(z_mean: float, age_months: float = 6, indicator: str = "length_cm") -> Row:
    return Row(age_months, indicator, 65.0, {"male": z_mean - 0.4, "female": z_mean + 0.4, "mean": z_mean})


@pytest.mark.parametrize("indicator", LAW)
def test_the_body_stays_near_who_on_every_day_of_two_years(indicator, daily_rows):
    """|z| against the mean of boys and girls, from birth (arm: from day 91) to day 730."""
    rows = [row for row in daily_rows if row.indicator == indicator]
    assert len(rows) == (640 if indicator == "arm_circumference_cm" else 731)
    assert max(abs(row.z["mean"]) for row in rows) <= LAW[indicator]


@pytest.fixture(scope="module")
def daily_rows() -> list[Row]:
    ages_months = [day / DAYS_PER_MONTH for day in range(731)]
    return [row for age in ages_months for row in compare_with_who(age, stature(grow_tree(fits.measure(age), MITTEN)))]


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_either_kind_of_hands_is_within_one_sd(hands):
    anatomy = assemble(hands, True)
    for age_months in range(25):
        for row in compare_with_who(age_months, stature(grow_tree(fits.measure(age_months), anatomy))):
            assert abs(row.z["mean"]) <= LAW[row.indicator], row


def test_the_compiled_body_stays_near_who_and_has_the_measures_of_the_body_tree(report):
    """To the digits that files hold; boys of four months were 1.15 SD too short by the paper's growth law."""
    for age_months, rows in report.by_age():
        expected = stature(grow_tree(fits.measure(age_months), MITTEN))
        for indicator, row in rows.items():
            assert abs(row.z["mean"]) <= LAW[indicator], row
            assert max(abs(z) for z in row.z.values()) < 1, row
            assert row.value == pytest.approx(expected[indicator], rel=1e-6)


def test_the_average_child_is_measured_at_every_month():
    report = grow_against_who()
    assert [age_months for age_months, _ in report.by_age()] == list(range(25))
    assert report.passed


def test_arms_are_compared_from_three_months_on(report):
    for age_months, rows in report.by_age():
        assert {"length_cm", "weight_kg", "head_circumference_cm"} <= rows.keys()
        assert ("arm_circumference_cm" in rows) == (age_months >= 91 / DAYS_PER_MONTH)


@pytest.mark.parametrize(("age_months", "measured"), [(9.3, [9, 9.3, 10]), (9, [9, 10])])
def test_an_infant_is_measured_at_its_own_age_too_and_its_spec_stays(age_months, measured):
    spec = infant(age_months)
    assert [age for age, _ in grow_against_who(spec, months=(9, 10)).by_age()] == measured
    assert spec == infant(age_months)


def test_a_spec_that_cannot_be_built_is_refused(monkeypatch):
    """Rather than measured as if it asked for nothing."""

    def refuse(spec: InfantSpec) -> None:
        raise SpecError([Problem("one.yaml", 1, 1, "body", "not today")])

    monkeypatch.setattr(child, "check_available", refuse)
    with pytest.raises(SpecError, match="not today"):
        grow_against_who(infant(9))


def test_progress_is_told_after_each_age():
    told = []
    grow_against_who(months=(0, 1, 2), progress=lambda done, total: told.append((done, total)))
    assert told == [(1, 3), (2, 3), (3, 3)]


def test_z_scores_and_percentiles_are_against_boys_girls_and_their_mean():
    """A boy of WHO's median length is tall among girls."""
    median_cm = fits.load_tables().who["length_cm"].value(0, 12, "male")
    measures = Stature(length_cm=median_cm, weight_kg=9, head_circumference_cm=45, arm_circumference_cm=14)
    length = next(row for row in compare_with_who(12, measures) if row.indicator == "length_cm")
    assert length.z["male"] == pytest.approx(0, abs=1e-9)
    assert length.percentile["male"] == pytest.approx(50)
    assert length.z["female"] > length.z["mean"] > 0
    assert length.percentile["female"] > 70


def test_a_report_marks_where_the_average_child_lies_outside_one_sd_of_the_mean_of_the_sexes():
    """A z of -1.3 among boys and -0.5 among girls is inside."""
    report = GrowthReport((row(-0.99), row(1.01, 7), row(-1.5, 8), row(1.0, 9)))
    assert [row.missed for row in report.rows] == [False, True, True, False]
    assert not report.passed
    assert report.worst["length_cm"].age_months == 8
    assert GrowthReport((row(-0.9),)).passed


def test_a_child_too_small_is_outside():
    newborn_at_six_months = measure_compiled(compile_infant(infant(0)))
    assert all(row.missed for row in compare_with_who(6, newborn_at_six_months))


def test_the_worst_row_is_known_by_indicator(report):
    for indicator, worst in report.worst.items():
        rows = [row for row in report.rows if row.indicator == indicator]
        assert abs(worst.z["mean"]) == max(abs(row.z["mean"]) for row in rows)


def test_a_report_is_the_same_after_a_trip_through_json(report):
    data = report.to_data()
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    assert (data["passed"], data["within_one_sd"], data["reference"]) == (True, True, "mean")
    assert data["worst"].keys() == LAW.keys()
    for told, row in zip(data["rows"], report.rows, strict=True):
        assert (told["age_months"], told["indicator"]) == (pytest.approx(row.age_months), row.indicator)
        assert told["value"] == pytest.approx(row.value, rel=1e-8)
        assert told["z"] == pytest.approx(dict(row.z), rel=1e-8)
        assert told["percentile"] == pytest.approx(dict(row.percentile), rel=1e-8)
        assert (told["missed"], told["is_judged"], told["requested_z"]) == (row.missed, True, None)
        assert told["outside_one_sd"] == row.outside_one_sd


def test_series_hold_every_value_by_indicator(report):
    assert sum(map(len, report.series.values())) == len(report.rows)
    assert report.series["weight_kg"][0] == (0, report.rows[1].value)


DOLL = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <geom name="wall" type="box" size="1 1 5"/>
    <body name="hip" pos="0 0 3">
      <freejoint/>
      <geom {hip} mass="2"/>
      <body pos="0 0 .1">
        <geom name="head" type="sphere" size=".05" mass="1"/>
        <geom name="left_uarm1" type="sphere" size=".02" mass="1"/>
        <geom name="hat" type="sphere" size=".5" mass="0" group="1"/>
      </body>
    </body>
    <body name="toy" pos="0 0 9"><freejoint/><geom type="sphere" size="1" mass="9"/></body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize(
    ("hip", "reach_m"),
    [
        ('type="sphere" size=".06"', 0.06),
        ('type="ellipsoid" size=".01 .02 .06"', 0.06),
        ('type="ellipsoid" size=".01 .06 .02" euler="90 0 0"', 0.06),
        ('type="capsule" size=".02 .04"', 0.06),
        ('type="capsule" size=".06 .04" euler="90 0 0"', 0.06),
        ('type="cylinder" size=".02 .06"', 0.06),
        ('type="cylinder" size=".06 .02" euler="0 90 0"', 0.06),
        ('type="cylinder" size=".06 .02" euler="0 45 0"', 0.08 * 0.5**0.5),
        ('type="box" size=".01 .02 .06"', 0.06),
        ('type="box" size=".03 .02 .03" euler="0 45 0"', 0.06 * 0.5**0.5),
    ],
)
def test_a_model_is_measured_without_its_world(hip, reach_m):
    """From the top of the head to the lowest point of the infant's own solids; hats, walls and toys do not count."""
    measures = measure_compiled(mujoco.MjModel.from_xml_string(DOLL.format(hip=hip)))
    assert measures["length_cm"] == pytest.approx(100 * (0.05 + 0.1 + reach_m))
    assert measures["weight_kg"] == pytest.approx(4)
    assert measures["head_circumference_cm"] == pytest.approx(31.4159, abs=1e-3)
    assert measures["arm_circumference_cm"] == pytest.approx(12.5664, abs=1e-3)


# The child that is asked for.


def asked(**body) -> InfantSpec:
    return InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 7, "body": body})


@pytest.mark.full
@pytest.mark.parametrize(("sex", "wanted"), full_rows([("male", 3), ("female", 97)], [("male", 97), ("female", 3)]))
def test_a_child_is_judged_by_its_sex_and_the_percentile_it_is_asked_for(sex, wanted):
    """Not by the mean of both sexes, beyond one SD of which it is at every age."""
    report = grow_against_who(asked(individual={"sex": sex, "length_percentile": wanted, "weight_percentile": wanted}))
    assert report.passed
    assert (report.reference, report.within_one_sd) == (sex, False)
    for row in report.rows:
        if row.indicator in ("length_cm", "weight_kg"):
            assert row.percentile[sex] == pytest.approx(wanted, abs=0.1)
            assert abs(row.z["mean"]) > 1
        assert row.is_judged == (row.indicator in ("length_cm", "weight_kg"))


def test_a_child_of_no_sex_is_judged_by_the_mean_of_both():
    report = grow_against_who(asked(individual={"length_cm": 63.5}), (0, 12))
    assert (report.reference, report.passed) == ("mean", True)
    assert {row.requested_z is None for row in report.by_indicator["length_cm"]} == {False}


def test_a_child_that_misses_what_is_asked_for_fails():
    """However near to the average it is."""
    wanted = {"length_cm": 70.0, "weight_kg": None, "head_circumference_cm": None, "arm_circumference_cm": None}
    for length_cm, missed in ((70.0, False), (70.02, False), (70.1, True), (69.9, True)):
        measures = Stature(length_cm=length_cm, weight_kg=99, head_circumference_cm=45, arm_circumference_cm=14)
        report = GrowthReport(tuple(compare_with_who(7, measures, "male", wanted)))
        assert [row.indicator for row in report.rows if row.missed] == ["length_cm"] * missed
        assert report.passed is not missed


def test_a_measurement_is_asked_for_and_what_other_keys_change_is_not_judged():
    body = {"measurements": {"head_circumference_cm": 42.0}, "parts": {"left_upper_leg": {"length": 0.9}}}
    report = grow_against_who(asked(**body), (7,))
    assert [row.indicator for row in report.rows if not row.is_judged] == ["weight_kg"]
    (head,) = report.by_indicator["head_circumference_cm"]
    assert (head.value, head.missed) == (pytest.approx(42.0, abs=1e-4), False)
    assert head.requested_z == pytest.approx(head.z["mean"], abs=1e-4)
    assert report.passed


REAL_CM = {
    "a newborn of 22 weeks": (0, {"crown_sole_length": 28, "head_circumference": 20.2, "foot_length": 4.0}),
    "a newborn's thigh and arm at 24 weeks": (0, {"mid_thigh_circumference": 6.5, "upper_arm_circumference": 5.3}),
    "a newborn with hydrocephalus": (0, {"head_circumference": 60}),
    "a very large child": (24, {"crown_sole_length": 110, "foot_length": 18, "waist_circumference": 75}),
    "a very heavy child": (18, {"upper_arm_circumference": 25, "mid_thigh_circumference": 46}),
}


def spec(age_months: float, **measurements_cm: float) -> InfantSpec:
    body = {"hands": "five_finger", "measurements": measurements_cm}
    return InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months, "body": body})


@pytest.mark.parametrize("case", REAL_CM)
def test_what_real_children_measure_is_plausible(case):
    age_months, measured_cm = REAL_CM[case]
    check_available(spec(age_months, **{f"{name}_cm": float(value) for name, value in measured_cm.items()}))


@given(
    age_months=st.floats(0, 24),
    name=st.sampled_from([name for name in MEASUREMENTS if name not in ("rump_sole_length", "maximum_fist_breadth")]),
    factor=st.floats(0.01, 10),
)
def test_plausible_is_what_is_near_the_average_of_that_age(age_months, name, factor):
    value_cm = 100 * measure(age_months)[name] * factor
    assume(0 < value_cm <= 150 and abs(factor / MIN_RATIO - 1) > 1e-9 < abs(factor / MAX_RATIO - 1))
    child = spec(age_months, **{f"{name}_cm": value_cm})
    if MIN_RATIO <= factor <= MAX_RATIO:
        check_available(child)
    else:
        with pytest.raises(SpecError, match="times what the average child of"):
            check_available(child)


def test_the_message_says_which_range_and_why():
    with pytest.raises(SpecError) as refusal:
        mimoc.build(spec(9, foot_length_cm=150, left_forearm_circumference_cm=0.1))
    assert str(refusal.value).splitlines() == [
        "<x>: body.measurements.foot_length_cm: 150 cm is 14 times what the average child of 9 months has (10.4 cm), "
        "and children have 0.4 to 2 times as much; give 4.2 to 20.7 cm",
        "<x>: body.measurements.left_forearm_circumference_cm: 0.1 cm is 0.0072 times what the average child of 9 "
        "months has (14.0 cm), and children have 0.4 to 2 times as much; give 5.6 to 27.9 cm",
    ]


@given(age_months=st.floats(0, 24), later_months=st.floats(0, 24), factor=st.floats(0.41, 1.99))
def test_what_is_plausible_at_one_age_is_so_at_every_other(age_months, later_months, factor):
    """A measurement keeps its ratio to the average child's."""
    child = spec(age_months, foot_length_cm=100 * factor * measure(age_months)["foot_length"])
    check_available(at_age(child, later_months))
