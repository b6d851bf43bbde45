"""Kinematics of many frames at once are MuJoCo's, and their derivatives those of finite differences."""

import mujoco
import numpy as np
import pytest
from support.retargeting import child, problem_and_state, setting

from mimoc.compiler.measuring import compile_infant
from mimoc.motion.body_points import body_points
from mimoc.movement.retargeting.sizes import SIZES, at_sizes, compile_child, lengths_of, resized
from mimoc.movement.retargeting.skeleton import combined_limits, exponential, hinges_of, rotation_vector

STEP = 1e-6


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_points_are_where_mujoco_has_them(hands):
    problem, state = problem_and_state("pixels", hands, shift=0.5)
    shape = at_sizes(problem.shape, np.zeros_like(state.logs))
    model, points = child(hands).model, problem.skeleton.pose(state.x, shape).points_m[..., 0]
    data, bodies = mujoco.MjData(model), problem.skeleton.point_bodies
    for frame, qpos in enumerate(problem.skeleton.qpos(state.x)):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        turned = np.einsum("kij,kj->ki", data.xmat[bodies].reshape(-1, 3, 3), shape.points_m[..., 0])
        assert pytest.approx(data.xpos[bodies] + turned, abs=1e-9) == points[:, frame].T


def test_derivatives_by_unknowns_are_those_of_differences():
    problem, state = problem_and_state("pixels", shift=0.5)
    skeleton, shape = problem.skeleton, at_sizes(problem.shape, state.logs)
    points = np.arange(len(skeleton.point_bodies))
    jacobian = skeleton.jacobian(skeleton.pose(state.x, shape), points)
    for column in range(skeleton.unknowns):
        step = STEP * np.eye(skeleton.unknowns)[column]
        ends = [skeleton.pose(state.x + sign * step, shape).points_m[..., 0] for sign in (1, -1)]
        assert jacobian[..., column] == pytest.approx((ends[0] - ends[1]) / (2 * STEP), abs=1e-7)


def test_some_points_at_some_frames_have_the_derivatives_of_all():
    problem, state = problem_and_state("pixels")
    pose = problem.skeleton.pose(state.x, at_sizes(problem.shape, state.logs))
    whole = problem.skeleton.jacobian(pose, np.arange(len(problem.skeleton.point_bodies)))
    part = problem.skeleton.jacobian(pose, np.array([9]), np.array([2, 5]))
    assert part[:, :, 0] == pytest.approx(whole[:, [2, 5], 9])


def test_derivatives_by_sizes_are_those_of_differences():
    problem, state = problem_and_state("pixels")
    pose = problem.skeleton.pose(state.x, at_sizes(problem.shape, state.logs))
    for column in range(len(state.logs)):
        ends = []
        for sign in (1, -1):
            logs = state.logs + sign * STEP * np.eye(len(state.logs))[column]
            ends.append(problem.skeleton.pose(state.x, at_sizes(problem.shape, logs)).points_m[..., 0])
        assert pose.points_m[..., 1 + column] == pytest.approx((ends[0] - ends[1]) / (2 * STEP), abs=1e-7)


def test_sizes_move_points_as_in_a_child_that_is_compiled_with_them():
    whole = setting("pixels")
    factors = {size.name: 1.1 + 0.02 * index for index, size in enumerate(whole.sizes)}
    larger = compile_child(resized(whole.child.spec, factors))
    logs = np.array([0.0, *(np.log(factors[size.name]) for size in whole.sizes)])
    bodies = at_sizes(whole.shape, logs).bodies_m[..., 0]
    used = [larger.model.body(name).id for name in ("right_lower_arm", "right_foot", "left_upper_leg", "head")]
    assert bodies[used] == pytest.approx(larger.model.body_pos[used], abs=1e-6)


def test_every_size_changes_the_length_of_its_name():
    before = lengths_of(child().model)
    for size in SIZES:
        after = lengths_of(compile_infant(resized(child().spec, {size.name: 1.1})))
        assert after[size.name] / before[size.name] == pytest.approx(1.1, abs=0.01), size.name


@pytest.mark.parametrize("individual", [None, {"sex": "female", "length_percentile": 30}, {"length_cm": 60.0}])
def test_a_length_replaces_what_the_spec_said_of_it(individual):
    spec = child().spec.with_(body={"individual": individual})
    longer = resized(spec, {}, 61.2).body.individual
    assert (longer.length_cm, longer.length_percentile) == (61.2, None)


def test_a_rotation_vector_and_its_matrix_are_each_others():
    vectors = np.array([[0.3, -1.0, 2.0], [0.0, 0.0, 0.0], [1e-9, 0.0, 0.0]])
    for vector, matrix in zip(vectors, exponential(vectors)[0], strict=True):
        assert matrix @ matrix.T == pytest.approx(np.eye(3))
        assert rotation_vector(matrix) == pytest.approx(vector, abs=1e-7)


def test_lumbar_hinges_turn_together_and_the_head_has_combined_limits():
    model = child().model
    whole = setting("pixels")
    hinges = hinges_of(model, [point for point in body_points(model, whole.recording.names) if point])
    assert not {name for name in hinges.names if name.endswith(("bend2", "lean2", "rot2"))}
    factors, bounds = combined_limits(model, hinges)
    assert factors.shape == (6, len(hinges.names))
    assert bounds == pytest.approx(2.1)
