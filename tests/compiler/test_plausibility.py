"""A single measurement is one that a child of that age can have."""

import pytest
from hypothesis import assume, given, strategies as st

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.child import LARGEST, LEAST, check_available
from mimoc.compiler.variants import at_age
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.names import MEASUREMENTS

REAL_CM = {
    "a newborn of 22 weeks": (0, {"crown_sole_length": 28, "head_circumference": 20.2, "foot_length": 4.0}),
    "a newborn's thigh and arm at 24 weeks": (0, {"mid_thigh_circumference": 6.5, "upper_arm_circumference": 5.3}),
    "a newborn with hydrocephalus": (0, {"head_circumference": 60}),
    "a very large child": (24, {"crown_sole_length": 110, "foot_length": 18, "waist_circumference": 75}),
    "a very heavy child": (
        18,
        {"upper_arm_circumference": 25, "mid_thigh_circumference": 46},
    ),
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
    assume(0 < value_cm <= 150 and abs(factor / LEAST - 1) > 1e-9 < abs(factor / LARGEST - 1))
    child = spec(age_months, **{f"{name}_cm": value_cm})
    if LEAST <= factor <= LARGEST:
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
