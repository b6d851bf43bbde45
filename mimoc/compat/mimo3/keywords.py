"""MIMo3's keywords as a spec."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path
from typing import Any

from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import MimocError, check_name
from mimoc.base.units import m_to_cm
from mimoc.compiler.child import child_of
from mimoc.schema.infant import InfantSpec, load_spec

SCENE_DIRECTORY = "mimo3"  # Folder that MIMo3's scenes are in; here, scenes are known by the names of their files.
REACH_XML = f"{SCENE_DIRECTORY}/reach_scene.xml"
STANDUP_XML = f"{SCENE_DIRECTORY}/standup_scene.xml"
SELFBODY_XML = f"{SCENE_DIRECTORY}/selfbody_scene.xml"
CATCH_XML = f"{SCENE_DIRECTORY}/catch_scene.xml"
ROLL_OVER_XML = f"{SCENE_DIRECTORY}/roll_over_scene.xml"
BENCHMARK_XML = f"{SCENE_DIRECTORY}/benchmark_scene.xml"
BENCHMARK_XML_V2 = f"{SCENE_DIRECTORY}/benchmarkv2_scene.xml"

REFERENCE_MONTHS = 18.0  # Age of MIMo's reference body, which `age=None` asks for.
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


EYES = ("eye_left", "eye_right")
VESTIBULAR = {"vestibular_acc": "accelerometer", "vestibular_gyro": "gyro"}
TOUCH_FUNCTIONS = {"force_vector": "force_vector", "force_vector_global": "force_vector_global", "normal": "normal"}
TOUCH_FUNCTIONS |= {"normal_force": "normal"}
RESPONSES = {"spread_linear": "linear", "nearest": "nearest"}
FOVEATION = 10.0  # Strength of `foveation=True` (MIMo).


@dataclass(frozen=True)
class Keywords:
    """What the constructor of one of MIMo3's environments is given, besides what is about pictures and goals."""

    model_path: Any
    age: float | None = None
    custom_measurements: Mapping[Any, float] | None = None
    frame_skip: int = 2
    sensory_delay: int = 0
    motor_delay: int = 0
    proprio_params: Mapping[str, Any] | None = None
    touch_params: Mapping[str, Any] | None = None
    vision_params: Mapping[str, Any] | None = None
    vestibular_params: Mapping[str, Any] | None = None
    actuation: str | None = None  # mimoc's name of the actuation model; None is that of the spec.


def spec_of(keywords: Keywords) -> InfantSpec:
    """Return the spec that keywords ask for; MimocError if one has no counterpart, or there is no such infant."""
    spec = _scene(keywords.model_path)
    if keywords.age is not None:
        spec = spec.with_(age_months=float(keywords.age))
    changes: dict[str, Any] = {"senses": _senses(keywords)} | _timing(keywords, spec)
    if keywords.actuation:
        changes["actuation"] = {"model": keywords.actuation}
    spec = spec.with_(**changes)
    sizes = keywords.custom_measurements or {}
    if measurements := {
        re.sub("(_cm|_mm)?$", "_cm", key, count=1): float(size) / 10 if key.endswith("_mm") else float(size)
        for key, size in sizes.items()
        if isinstance(key, str)
    }:
        spec = spec.with_(body={"measurements": measurements})
    geoms = {key: size for key, size in sizes.items() if not isinstance(key, str)}
    return spec.with_(body={"parts": factors_of_geoms(spec, geoms)}) if geoms else spec


def _scene(source: Any) -> InfantSpec:
    """Return the spec that stands for what MIMo3 calls the path of a model."""
    if isinstance(source, InfantSpec):
        return source
    path = Path(source)
    if path.suffix in (".yaml", ".yml"):
        return load_spec(path)
    if path.name not in SCENES or path.exists():
        raise MimocError(
            f"model_path '{path}' is no spec; for a scene of your own, run `mimoc import mimo {path.name} -o "
            f"{path.stem}.yaml` and give model_path='{path.stem}.yaml'; MIMo3's scenes are {', '.join(sorted(SCENES))}"
        )
    scene = SCENES[path.name]
    body = {"chest_joint": True, **scene.get("body", {})}
    infant = {"mimoc": 1, "name": path.stem, "age_months": REFERENCE_MONTHS, "development": "published"}
    return InfantSpec.model_validate({**infant, **scene, "body": body})


def _timing(keywords: Keywords, spec: InfantSpec) -> dict[str, Any]:
    """Return control step and delays: a delay of N is one of N control steps, as documented."""
    for name in ("frame_skip", "sensory_delay", "motor_delay"):
        value = getattr(keywords, name)
        least = 1 if name == "frame_skip" else 0
        if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
            raise MimocError(f"{name} is {value!r}; give a whole number of steps, {least} or more")
    step_ms = keywords.frame_skip * spec.control.timestep_ms
    delays = {"sensory_ms": keywords.sensory_delay * step_ms, "motor_ms": keywords.motor_delay * step_ms}
    given = {key: delay_ms for key, delay_ms in delays.items() if delay_ms}
    return {"control": {"step_ms": step_ms}} | ({"delays": given} if given else {})


def _senses(keywords: Keywords) -> dict[str, Any]:
    """Return the senses that are asked for; angles of joints always are."""
    senses: dict[str, Any] = {"proprioception": _proprioception(keywords.proprio_params or {})}
    translations: Mapping[str, Callable[[Mapping[str, Any]], dict[str, Any]]] = {
        "touch": _touch,
        "vision": _vision,
        "vestibular": _vestibular,
    }
    for name, translate in translations.items():
        if (given := getattr(keywords, f"{name}_params")) is not None:
            senses[name] = translate(given)
    return senses


def _proprioception(given: Mapping[str, Any]) -> dict[str, Any]:
    _check_keys("proprio_params", given, ("components", "threshold"))
    margin_rad = DEFAULT_PROPRIOCEPTION_PARAMS["threshold"]
    if given.get("threshold", margin_rad) != margin_rad:
        raise MimocError(f"proprio_params: the threshold of limits is {margin_rad} rad here; leave out 'threshold'")
    return {"include": list(given.get("components", ()))}


def _touch(given: Mapping[str, Any]) -> dict[str, Any]:
    _check_keys("touch_params", given, ("scales", "touch_function", "response_function"))
    quantity, response = given.get("touch_function", "force_vector"), given.get("response_function", "spread_linear")
    check_name("touch_function", quantity, TOUCH_FUNCTIONS)
    check_name("response_function", response, RESPONSES)
    spacings_cm = {body: round(m_to_cm(spacing_m), 9) for body, spacing_m in given.get("scales", {}).items()}
    spacing = {"spacing_cm": spacings_cm} if spacings_cm else {}
    return {"quantity": TOUCH_FUNCTIONS[quantity], "response": RESPONSES[response], **spacing}


def _vision(given: Mapping[str, Any]) -> dict[str, Any]:
    _check_keys("vision_params", given, EYES)
    eyes = list(given.values())
    if not eyes or any(eye != eyes[0] for eye in eyes):
        raise MimocError("vision_params: both eyes see alike here; give eye_left and eye_right the same parameters")
    eye = {"fovy": 60, "acuity": False, "foveation": False, "contrast": "linear", **eyes[0]}
    _check_keys("vision_params", eye, ("width", "height", "fovy", "acuity", "foveation", "contrast"))
    acuity, foveation = eye["acuity"], eye["foveation"]
    seen = {"width_px": eye["width"], "height_px": eye["height"]} if {"width", "height"} <= eye.keys() else {}
    return {
        **seen,
        "fovy_deg": float(eye["fovy"]),
        "acuity": {True: "age", False: "off"}[bool(acuity)] if isinstance(acuity, bool | None) else float(acuity),
        "acuity_profile": "mimo_v2" if acuity else "tac2",
        "contrast": eye["contrast"],
        "foveation": FOVEATION if foveation is True else float(foveation or 0),
    }


def _vestibular(given: Mapping[str, Any]) -> dict[str, Any]:
    _check_keys("vestibular_params", given, ("sensors",))
    sensors = list(given.get("sensors", VESTIBULAR))
    _check_keys("vestibular_params", sensors, VESTIBULAR)
    return {"include": [VESTIBULAR[name] for name in sensors]}


def _check_keys(keyword: str, given: Iterable[Any], known: Iterable[str]) -> None:
    for key in given:
        check_name(f"key of {keyword} that is known here", key, list(known))


LIMBS = {
    "left_uarm1": "left_upper_arm",
    "left_larm": "left_lower_arm",
    "geom:left_upper_leg1": "left_upper_leg",
    "geom:left_lower_leg1": "left_lower_leg",
}
"""The capsules of limbs, by MIMo3's names, and the parts that they belong to."""
SIZES = ("girth", "length")
"""What each size of a capsule depends on: its radius, then half of its length without the caps."""
STEP = 0.05  # By how much a factor is changed to see what a size makes of it.


def factors_of_geoms(spec: InfantSpec, sizes: Mapping[Any, float]) -> dict[str, dict[str, float]]:
    """Return factors of both sides' parts that give geoms of the left side sizes in [m], or raise a MimocError."""
    factors: dict[str, dict[str, float]] = {}
    for key in sizes:
        if not isinstance(key, tuple) or len(key) != 2 or key[0] not in LIMBS or key[1] not in (0, 1):
            raise MimocError(
                f"custom_measurements: {key!r} is not translated; give a measurement in cm, such as 'hand_length_cm', "
                f"or (geom, 0) for the radius and (geom, 1) for the half length of {', '.join(LIMBS)}"
            )
    for geom, index in sorted(sizes, key=lambda key: key[1]):  # Lengths depend on girths.
        factors = _with_size(spec, factors, geom, index, float(sizes[geom, index]))
    return factors


def _with_size(
    spec: InfantSpec, factors: dict[str, dict[str, float]], geom: str, index: int, size_m: float
) -> dict[str, dict[str, float]]:
    """Return the factors with the one of a size: sizes are straight lines over their factors."""
    part, key = LIMBS[geom], SIZES[index]

    def with_factor(factor: float) -> dict[str, dict[str, float]]:
        sides = (part, part.replace("left", "right"))
        return {**factors, **{side: {**factors.get(side, {}), key: factor} for side in sides}}

    def size_at(factor: float) -> float:
        tree = child_of(spec.with_(body={"parts": with_factor(factor)})).tree
        name = geom.removeprefix("geom:")
        return next(shape.size_m[index] for body in tree.bodies for shape in body.geoms if shape.name == name)

    now_m = size_at(1.0)
    return with_factor(1 + STEP * (size_m - now_m) / (size_at(1 + STEP) - now_m))
