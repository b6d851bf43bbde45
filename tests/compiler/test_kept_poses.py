"""Every keyframe of a bundle satisfies the constraints that hold and lock parts; there are no others."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

from mimoc.base.errors import UnknownNameError
from mimoc.compiler import building, model_check
from mimoc.render.portrait import portrait
from mimoc.runtime.env import InfantEnv
from mimoc.schema import InfantSpec

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))
BASE = {"mimoc": 1, "name": "x", "age_months": 9}
ALL = ("supine", "prone", "sitting", "standing")
VARIANTS = {
    "held hip": ({"scene": {"pose": "sitting", "held": ["hip"]}}, ("sitting",)),
    "held foot in a room": ({"scene": {"kind": "room", "pose": "prone", "held": ["left_foot"]}}, ("prone",)),
    "locked legs": ({"actuation": {"locked": ["legs"]}}, ("supine",)),
    "locked eyes, straight in all poses": ({"actuation": {"locked": ["eyes"]}}, ALL),
    "locked neck, bent when prone": ({"actuation": {"locked": ["neck"]}}, ("supine", "sitting", "standing")),
    "servos": ({"actuation": {"model": "position", "locked": ["arms"]}, "scene": {"pose": "standing"}}, ("standing",)),
    "nothing kept": ({}, ALL),
    "reach, which begins as it stands": ({"task": {"kind": "reach"}}, ("standing", "reach")),
    "standup": ({"task": {"kind": "standup"}, "age_months": 18}, ("standup",)),
    "selfbody": ({"task": {"kind": "selfbody"}}, ("selfbody",)),
    "catch": ({"task": {"kind": "catch"}, "age_months": 18}, ("catch",)),
    "rollover": ({"task": {"kind": "rollover"}}, ALL),
}


def residual(model: mujoco.MjModel, key: int) -> float:
    """Return by how much a keyframe violates the active equality constraints, in [m] and [rad]."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, key)
    mujoco.mj_forward(model, data)
    of_equalities = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    return float(np.abs(data.efc_pos[of_equalities]).max(initial=0.0))


def variant(name: str) -> InfantSpec:
    return InfantSpec.model_validate({**BASE, **VARIANTS[name][0]})


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_every_pose_of_a_config_satisfies_its_constraints(path):
    bundle = building.build(InfantSpec.model_validate(yaml.safe_load(path.read_text())))
    model = model_check.compile_model(bundle.files)
    assert bundle.manifest.pose in bundle.manifest.poses
    assert [model.key(key).name for key in range(model.nkey)] == list(bundle.manifest.poses)
    assert max(residual(model, key) for key in range(model.nkey)) < 1e-5


@pytest.mark.parametrize("name", VARIANTS)
def test_poses_in_which_what_is_kept_would_be_elsewhere_are_left_out(name):
    bundle = building.build(variant(name))
    model = model_check.compile_model(bundle.files)
    assert bundle.manifest.poses == VARIANTS[name][1]
    assert max(residual(model, key) for key in range(model.nkey)) < 1e-5


def test_a_pose_that_is_left_out_is_refused_in_a_line():
    bundle = building.build(variant("held hip"))
    message = "'prone' is not a pose for an infant with held bodies or locked joints; choose from sitting"
    with pytest.raises(UnknownNameError) as refused:
        InfantEnv(bundle).reset(options={"pose": "prone"})
    assert str(refused.value) == message
    with pytest.raises(UnknownNameError) as refused:
        portrait(bundle, "prone")
    assert str(refused.value) == message
