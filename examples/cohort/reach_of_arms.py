"""A measure of one's own: how far the arms of an infant reach."""

import mujoco

from mimoc.bundle.model import load_model


def probe(work):
    """Return the distance from shoulder to hand of the stretched arms, in [m]."""
    model = load_model(work.bundle)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return {
        f"{side}_arm_m": float(
            sum(
                abs(data.body(f"{side}_{end}").xpos - data.body(f"{side}_{start}").xpos).max()
                for start, end in (("upper_arm", "lower_arm"), ("lower_arm", "hand"))
            )
        )
        for side in ("left", "right")
    }
