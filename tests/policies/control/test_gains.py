import numpy as np
import pytest

from mimoc.base.errors import ControlError
from mimoc.policies.control import Gains


def test_a_law_of_the_first_power_is_a_damped_spring():
    gains = Gains(800.0, viscosity_per_s=20.0)
    found = gains.acceleration(np.array([0.01, 0.0, -0.02]), np.array([0.1, 0.0, 0.0]))
    assert found == pytest.approx([8.0 - 2.0, 0.0, -16.0])


def test_strength_is_the_acceleration_at_one_scale():
    for power in (0.5, 1.0, 2.0, 3.0):
        assert Gains(7.0, power, scale=0.3).acceleration(np.array([0.0, 0.3]), np.zeros(2)) == pytest.approx([0.0, 7.0])


def test_a_higher_power_is_gentler_near_the_target():
    near = [np.linalg.norm(Gains(1.0, power).acceleration(np.array([0.1]), np.zeros(1))) for power in (1, 2, 3)]
    assert near == pytest.approx([0.1, 0.01, 0.001])


def test_beyond_the_cap_errors_are_answered_alike():
    gains = Gains(800.0, cap=0.1)
    assert gains.acceleration(np.array([3.0, 4.0, 0.0]), np.zeros(3)) == pytest.approx([48.0, 64.0, 0.0])


def test_at_the_target_there_is_only_viscosity():
    assert Gains(100.0, power=0.5, viscosity_per_s=3.0).acceleration(np.zeros(2), np.ones(2)) == pytest.approx([-3, -3])


def test_joints_are_answered_one_by_one():
    found = Gains(10.0, power=2.0, cap=0.5).accelerations(np.array([0.1, -1.0, 0.0]), np.zeros(3))
    assert found == pytest.approx([0.1, -2.5, 0.0])


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"strength": -1.0}, "the strength of gains is -1; give a number of at least 0"),
        ({"strength": float("nan")}, "the strength of gains is nan"),
        ({"strength": float("inf")}, "the strength of gains is inf"),
        ({"strength": 1.0, "scale": 0.0}, "the scale of gains is 0"),
        ({"strength": 1.0, "viscosity_per_s": -0.1}, "the viscosity_per_s of gains is -0.1"),
    ],
)
def test_gains_that_mean_nothing_are_refused(wrong, complaint):
    with pytest.raises(ControlError, match=complaint):
        Gains(**wrong)
