"""mink's inverse kinematics: a hand to a place in front of a sitting infant, within the limits of its joints."""

from pathlib import Path

import mink
import mujoco
import numpy as np

ITERATIONS, STEP_S, WITHIN_M = 200, 0.05, 0.005


def use(bundles: Path) -> str:
    reached = []
    for name in ("nine_months", "muscle"):
        model = mujoco.MjModel.from_xml_path(str(bundles / name / "scene.xml"))
        at_hand = mink.Configuration(model)
        at_hand.update_from_keyframe("sitting")
        hand = mink.FrameTask("left_hand", "body", position_cost=1.0, orientation_cost=0.0)
        posture = mink.PostureTask(model, cost=1e-4)
        posture.set_target_from_configuration(at_hand)
        start = at_hand.get_transform_frame_to_world("left_hand", "body")
        target = start.translation() + np.array((0.02, 0.01, 0.03))
        hand.set_target(mink.SE3.from_rotation_and_translation(start.rotation(), target))
        limits = [mink.ConfigurationLimit(model)]
        for _ in range(ITERATIONS):
            velocity = mink.solve_ik(at_hand, [hand, posture], STEP_S, "daqp", limits=limits)
            at_hand.integrate_inplace(velocity, STEP_S)
        place = at_hand.get_transform_frame_to_world("left_hand", "body").translation()
        reached.append(float(np.linalg.norm(place - target)))
        hinges = model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE
        angles, ranges = at_hand.q[model.jnt_qposadr[hinges]], model.jnt_range[hinges]
        assert (ranges[:, 0] - 1e-6 <= angles).all()
        assert (angles <= ranges[:, 1] + 1e-6).all()
    assert max(reached) < WITHIN_M, reached
    return f"left hands within {1000 * max(reached):.2f} mm"
