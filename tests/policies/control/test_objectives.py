import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation

from mimoc.base.errors import ControlError
from mimoc.policies.control.dynamics import Motion
from mimoc.policies.control.objectives import (
    Gains,
    GazeTask,
    OrientationTask,
    PositionTask,
    directions_across,
    rotation_vector,
    turn_towards,
)

ALONG_Y = Rotation.from_euler("z", 90, degrees=True)
SPRING = Gains(1.0)


def motion(place_m=(0, 0, 0), turned=ALONG_Y, velocity=(0,) * 6):
    """Return a frame whose x axis points along y."""
    still = np.zeros((6, 1))
    place_m, velocity = np.array(place_m, float), np.array(velocity, float)
    return Motion(place_m, turned.as_matrix(), np.array([1.0, 0.0, 0.0]), velocity, still, np.zeros(6))


def wanted(task, there):
    """Return the linear and angular acceleration that a task wants, shape (6,)."""
    demand = task.desired_acceleration(there)
    return demand.directions.T @ demand.accelerations


def test_reach_accelerates_towards_its_target_and_against_its_velocity():
    task = PositionTask("hand", (1, 2, 3), Gains(10.0, viscosity_per_s=2.0))
    assert wanted(task, motion((1, 1, 1), velocity=(0.5, 0, 0, 9, 9, 9))) == pytest.approx([-1, 10, 20, 0, 0, 0])
    assert task.error(motion((1, 1, 1))) == pytest.approx(np.sqrt(5))


@pytest.mark.parametrize("there", [Rotation.identity(), Rotation.from_euler("xyz", [0.3, -0.2, 0.5])])
def test_align_turns_the_shortest_way(there):
    turn = (there * ALONG_Y.inv()).as_rotvec()
    for orientation in (there.as_matrix(), there.as_quat(scalar_first=True), -3 * there.as_quat(scalar_first=True)):
        task = OrientationTask("hand", orientation, gains=SPRING)
        assert wanted(task, motion()) == pytest.approx([0, 0, 0, *turn])
        assert task.error(motion()) == pytest.approx(np.linalg.norm(turn))


def test_align_with_a_direction_leaves_the_turn_about_it_free():
    task = OrientationTask("hand", (5, 0, 0), gains=Gains(1.0, viscosity_per_s=1.0))
    assert wanted(task, motion(velocity=(0, 0, 0, 0, 7, 0))) == pytest.approx([0, 0, 0, 0, 0, -np.pi / 2])
    assert len(task.desired_acceleration(motion()).accelerations) == 2


def test_another_axis_can_point():
    assert OrientationTask("hand", (0, 0, 1), axis=(0, 0, 2)).error(motion()) == pytest.approx(0)
    assert GazeTask("eye", (-1, 0, 0), axis=(0, 1, 0)).error(motion()) == pytest.approx(0)


def test_look_at_turns_the_line_of_sight_to_its_target():
    task = GazeTask("eye", (0, 0, 5), gains=SPRING)
    assert wanted(task, motion()) == pytest.approx([0, 0, 0, np.pi / 2, 0, 0])
    assert task.error(motion((0, -9, 5))) == pytest.approx(0)


def test_what_is_at_the_eye_is_nowhere():
    task = GazeTask("eye", (0, 0, 0))
    assert task.error(motion()) == 0
    assert not wanted(task, motion()).any()


def test_a_target_cannot_change_behind_a_tasks_back():
    place_m = np.zeros(3)
    task = PositionTask("hand", place_m)
    place_m[:] = 1
    assert not task.target.any()
    with pytest.raises(ValueError, match="read-only"):
        task.target[0] = 1


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: PositionTask("hand", (0, 0)), r"the target is \(0, 0\); give 3 finite numbers"),
        (lambda: PositionTask("hand", (0, 0, np.nan)), "the target is .*nan.*; give 3 finite numbers"),
        (lambda: PositionTask("hand", "up"), "the target is up; give 3 finite numbers"),
        (lambda: GazeTask("eye", (0, np.inf, 0)), "the target is .*inf.*; give 3 finite numbers"),
        (lambda: GazeTask("eye", (0, 0, 0), axis=(0, 0, 0)), "the axis has length zero"),
        (lambda: OrientationTask("hand", (0, 0, 0, 0)), "the quaternion has length zero"),
        (lambda: OrientationTask("hand", np.ones((3, 3))), "the orientation is not a rotation"),
        (lambda: OrientationTask("hand", -np.eye(3)), "the orientation is not a rotation"),
        (lambda: OrientationTask("hand", (1, 2)), r"the orientation is \(1, 2\); give 3 x 3 finite numbers"),
    ],
)
def test_what_cannot_be_aimed_at_is_refused(make, complaint):
    with pytest.raises(ControlError, match=complaint):
        make()


def test_a_target_that_is_set_later_is_checked_as_well():
    task = PositionTask("hand", (0, 0, 0))
    with pytest.raises(ControlError, match="give 3 finite numbers"):
        task.target = (0, 0, float("nan"))
    assert not task.target.any()


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


vectors = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda vector: np.linalg.norm(vector) > 0.1)
unit_vectors = vectors.map(lambda vector: vector / np.linalg.norm(vector))
rotations = st.tuples(unit_vectors, st.floats(-3.1, 3.1)).map(lambda pair: Rotation.from_rotvec(pair[0] * pair[1]))


@given(rotations, rotations)
def test_a_turn_to_an_orientation_leads_there(here, there):
    turn = rotation_vector(here.as_matrix(), there.as_matrix())
    assert (Rotation.from_rotvec(turn) * here).as_matrix() == pytest.approx(there.as_matrix(), abs=1e-7)
    assert np.linalg.norm(turn) <= np.pi + 1e-9


@given(unit_vectors, unit_vectors)
def test_a_turn_to_a_direction_leads_there_about_an_axis_across_both(here, there):
    turn = turn_towards(here, there)
    assert Rotation.from_rotvec(turn).apply(here) == pytest.approx(there, abs=1e-7)
    assert abs(turn @ here) < 1e-9


@given(unit_vectors)
def test_there_is_no_turn_to_the_same_direction_and_half_a_turn_to_the_opposite_one(direction):
    assert not turn_towards(direction, direction).any()
    back = turn_towards(direction, -direction)
    assert np.linalg.norm(back) == pytest.approx(np.pi)
    assert abs(back @ direction) < 1e-9


@given(unit_vectors)
def test_directions_across_are_at_right_angles(direction):
    frame = np.stack([direction, *directions_across(direction)])
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-12)
