"""The scenes of MIMo3's environments as specs, and the parameters that they have by default."""

from collections.abc import Mapping
from typing import Any

from mimoc.anatomy.anatomy import assemble

SCENE_DIRECTORY = "mimo3"
"""Folder that MIMo3's scenes are in; here, scenes are known by the names of their files."""
REACH_XML = f"{SCENE_DIRECTORY}/reach_scene.xml"
STANDUP_XML = f"{SCENE_DIRECTORY}/standup_scene.xml"
SELFBODY_XML = f"{SCENE_DIRECTORY}/selfbody_scene.xml"
CATCH_XML = f"{SCENE_DIRECTORY}/catch_scene.xml"
ROLL_OVER_XML = f"{SCENE_DIRECTORY}/roll_over_scene.xml"
BENCHMARK_XML = f"{SCENE_DIRECTORY}/benchmark_scene.xml"
BENCHMARK_XML_V2 = f"{SCENE_DIRECTORY}/benchmarkv2_scene.xml"

REFERENCE_MONTHS = 18.0
"""Age of MIMo's reference body, which `age=None` asks for."""
FIVE_FINGERS: Mapping[str, Any] = {"hands": "five_finger"}
UPRIGHT: Mapping[str, Any] = {"pose": "standing"}
SCENES: Mapping[str, Mapping[str, Any]] = {
    "reach_scene.xml": {"task": {"kind": "reach"}},
    "standup_scene.xml": {"task": {"kind": "standup"}},
    "selfbody_scene.xml": {"task": {"kind": "selfbody"}},
    "catch_scene.xml": {"task": {"kind": "catch"}, "body": FIVE_FINGERS},
    "roll_over_scene.xml": {"task": {"kind": "rollover"}},
    "benchmark_scene.xml": {"scene": UPRIGHT},
    "benchmarkv2_scene.xml": {"scene": UPRIGHT, "body": FIVE_FINGERS},
}
"""What a spec says of each scene, by the name of its file."""


def _spacings_m(hands: str) -> dict[str, float]:
    """Return the distance of skin points of each body, which mimoc has from MIMo; an eye has a single one."""
    parts = assemble(hands, True, "published").parts
    return {part.name.format(side=side): part.skin_spacing_m or 1.0 for side, part in parts}


FORCES = {"touch_function": "force_vector", "response_function": "spread_linear"}
DEFAULT_TOUCH_PARAMS = {"scales": _spacings_m("mitten"), **FORCES}
DEFAULT_TOUCH_PARAMS_V2 = {"scales": _spacings_m("five_finger"), **FORCES}
EYE = {"width": 256, "height": 256, "fovy": 60, "acuity": False, "foveation": False}
DEFAULT_VISION_PARAMS = {"eye_left": {**EYE}, "eye_right": {**EYE}}
DEFAULT_VESTIBULAR_PARAMS = {"sensors": ["vestibular_acc", "vestibular_gyro"]}
DEFAULT_PROPRIOCEPTION_PARAMS = {"components": ["velocity", "torque", "limits", "actuation"], "threshold": 0.035}

_LIMBS = ("foot", "lower_leg", "upper_leg")
SELFBODY_TOUCH_PARAMS = {
    "scales": {
        **{f"{side}_{limb}": 0.05 if limb == "foot" else 0.1 for limb in _LIMBS for side in ("left", "right")},
        **dict.fromkeys(("hip", "lower_body", "upper_body", "head"), 0.1),
        **dict.fromkeys(("left_upper_arm", "left_lower_arm", "right_fingers"), 0.01),
    },
    **FORCES,
}
_ARM = ("upper_arm", "lower_arm", "hand", "ff", "mf", "rf", "lf", "th")
CATCH_TOUCH_PARAMS = {
    "scales": {
        body: spacing_m
        for body, spacing_m in _spacings_m("five_finger").items()
        if body.startswith(tuple(f"right_{name}" for name in _ARM))
    },
    **FORCES,
}
