"""Random children who lie on their backs and move in a known way, and what a camera above them sees."""

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.signal import butter, sosfiltfilt

from mimoc.bundle.model import load_model
from mimoc.compiler.building import build
from mimoc.motion.body_points import film, locate
from mimoc.motion.labels import MINI_RGBD_POINTS, POINTS
from mimoc.motion.point_recording import PointRecording
from mimoc.schema.infant import InfantSpec

FloatArray = npt.NDArray[np.float64]
SINK_M = 0.003  # Penetration of floor or body that known motions stay below.
MEAN_DEG = {
    "shoulder_horizontal": 15,
    "shoulder_ad_ab": 45,
    "shoulder_rotation": 20,
    "elbow": -60,
    "hip1": -65,
    "hip2": -22,
    "hip3": 20,
    "knee": -75,
}
"""Middle of postures of limbs; other hinges rest."""
SPREAD_DEG = {
    "shoulder_rotation": 35,
    "shoulder": 35,
    "elbow": 35,
    "knee": 30,
    "hip1": 28,
    "hip2": 17,
    "hip3": 22,
    "hand": 15,
    "foot": 12,
    "head_swivel": 30,
    "head": 8,
    "hip_": 4,
}
"""Standard deviation of angles, half of its square over children and half over time."""
SLOW_HZ, FAST_HZ = 0.15, (0.6, 1.6)
"""Cutoffs of the low-pass filters that random numbers go through: of drifting posture, and of movement."""
LIMBS = {
    **{f"{side}_arm": (f"{side}_shoulder", f"{side}_elbow", f"{side}_hand") for side in ("left", "right")},
    **{f"{side}_leg": (f"{side}_hip", f"{side}_knee", f"{side}_foot") for side in ("left", "right")},
    "head": ("head",),
}
BODIES = {
    **{f"{side}_arm": (f"{side}_upper_arm",) for side in ("left", "right")},
    **{f"{side}_leg": (f"{side}_upper_leg",) for side in ("left", "right")},
    "head": ("head",),
}
LIFT_DEG = {"shoulder_horizontal": 20.0, "hip1": -15.0}  # Turns that lift limbs at rest off the floor.
SHARES = (1.0, 1.0, 1.0, 0.85, 0.85, 0.7, 0.7, 0.55, 0.4, 0.25, 0.1, 0.0)
"""Amplitudes of a limb that are tried, away from rest, until it touches nothing."""
ALL_POINTS = tuple(
    name for name in POINTS if name not in ("mid_hip",) and not name.endswith(("_eye", "heel", "big_toe", "small_toe"))
)
"""Those of MINI-RGBD, and nose, ears, wrists and ankles."""


def random_child(draw: np.random.Generator) -> InfantSpec:
    """Return a child of 0-24 months with percentiles, hands and lengths of limbs of its own."""
    percentile = float(draw.uniform(5, 95))
    parts: dict[str, dict[str, float]] = {}
    for name in ("upper_arm", "lower_arm", "hand", "upper_leg", "lower_leg", "foot"):
        factor = float(np.clip(np.exp(0.06 * draw.normal()), 0.85, 1.18))
        parts |= {f"{side}_{name}": {"length": round(factor, 3)} for side in ("left", "right")}
    trunk = round(float(np.clip(np.exp(0.04 * draw.normal()), 0.9, 1.1)), 3)
    parts |= {name: {"length": trunk} for name in ("hip", "lower_body", "upper_body")}
    body: Any = {
        "hands": str(draw.choice(["mitten", "five_finger"])),
        "individual": {"sex": str(draw.choice(["female", "male"])), "length_percentile": round(percentile, 1)},
        "parts": parts,
    }
    senses: Any = {"proprioception": {}}
    scene: Any = {"kind": "flat", "pose": "supine"}
    age_months = round(float(draw.uniform(0, 24)), 1)
    return InfantSpec(mimoc=1, name="child", age_months=age_months, body=body, senses=senses, scene=scene)


def model_of(spec: InfantSpec) -> mujoco.MjModel:
    """Return the compiled child of a spec."""
    return load_model(build(spec))


def known_motion(model: mujoco.MjModel, draw: np.random.Generator, frames: int, rate_hz: float) -> FloatArray:
    """Return a smooth random motion within all limits that touches neither floor nor body, shape (t, nq)."""
    rest = model.key("supine").qpos.copy()
    qpos = np.repeat(rest[None], frames, axis=0)
    qpos[:, :2] += 0.02 * np.stack([_noise(draw, frames, rate_hz, 0.3) for _ in range(2)], axis=-1)
    for angle, axis in ((8.0, (0, 0, 1)), (0.5, (1, 0, 0)), (0.5, (0, 1, 0))):
        _turn(qpos, np.radians(angle) * _noise(draw, frames, rate_hz, 0.3), np.array(axis, float))
    _move_trunk(model, draw, qpos, rate_hz)
    for limb, words in LIMBS.items():
        joints = [j for j in range(1, model.njnt) if model.joint(j).name.removeprefix("robot:").startswith(words)]
        joints = [j for j in joints if not model.joint(j).name.startswith("robot:hip_")]
        for share in SHARES:
            moved = qpos.copy()
            for joint in joints:
                address = model.jnt_qposadr[joint]
                angle = _angle(model, joint, draw, frames, rate_hz, rest[address])
                lifted = rest[address] + _lift(model, joint, rest[address])
                moved[:, address] = lifted + share * (angle - lifted)
            if share == 0.0 or not _touches(model, moved, BODIES[limb]):
                qpos = moved
                break
    return qpos


def recorded(
    model: mujoco.MjModel,
    qpos: FloatArray,
    draw: np.random.Generator,
    names: tuple[str, ...] = MINI_RGBD_POINTS,
    *,
    rate_hz: float = 30.0,
    noise_px: float = 1.0,
    gaps: float = 0.05,
    depth_noise_m: float | None = None,
    height_m: float = 1.08,
) -> PointRecording:
    """Return what a camera sees of a motion, with noise, and gaps of a third of a second on average."""
    recording = film(model, qpos, rate_hz, names, height_m=height_m)
    positions = recording.positions + noise_px * draw.normal(size=recording.positions.shape)
    starts = draw.random(positions.shape[:2]) < gaps / 10
    hidden = np.zeros_like(starts)
    for frame, point in np.argwhere(starts):
        hidden[frame : frame + draw.integers(1, 20), point] = True
    positions[hidden] = np.nan
    depth_m = None
    if depth_noise_m is not None and recording.depth_m is not None:
        depth_m = recording.depth_m + depth_noise_m * draw.normal(size=hidden.shape)
        depth_m[hidden] = np.nan
    return replace(recording, positions=positions, depth_m=depth_m, confidence=np.where(hidden, 0.0, 1.0))


def in_space(model: mujoco.MjModel, qpos: FloatArray, draw: np.random.Generator, **options: Any) -> PointRecording:
    """Return the places of points in space, with noise of 5 mm."""
    recording = recorded(model, qpos, draw, **options)
    places_m = locate(model, qpos, recording.names)
    places_m += 0.005 * draw.normal(size=places_m.shape)
    places_m[recording.confidence == 0] = np.nan
    return replace(recording, positions=places_m, camera=None, depth_m=None)


def _noise(draw: np.random.Generator, frames: int, rate_hz: float, cutoff_hz: float) -> FloatArray:
    """Return random numbers of variance 1 below a frequency."""
    margin = int(2 * rate_hz / cutoff_hz)
    sections: Any = butter(2, cutoff_hz, fs=rate_hz, output="sos")
    values = sosfiltfilt(sections, draw.normal(size=frames + 2 * margin))
    return values[margin:-margin] / values.std()


def _angle(
    model: mujoco.MjModel, joint: int, draw: np.random.Generator, frames: int, rate_hz: float, rest: float
) -> FloatArray:
    """Return the angles of a hinge over time, bent into its range."""
    name = model.joint(joint).name.removeprefix("robot:")
    part = name.partition("_")[2]
    spread = np.radians(next((deg for key, deg in SPREAD_DEG.items() if key in name), 5.0))
    mean = np.radians(MEAN_DEG[part]) if part in MEAN_DEG else rest
    moving = 0.4 * _noise(draw, frames, rate_hz, SLOW_HZ) + 0.58 * _noise(draw, frames, rate_hz, draw.uniform(*FAST_HZ))
    low, high = model.jnt_range[joint]
    middle, half = (low + high) / 2, (high - low) / 2
    centre = np.clip(mean + 0.7 * spread * draw.normal(), low + 0.1 * half, high - 0.1 * half)
    return middle + half * _bent((centre + spread * moving - middle) / half)


def _lift(model: mujoco.MjModel, joint: int, rest: float) -> float:
    """Return by how much a resting hinge is turned, so that its limb is off the floor."""
    name = model.joint(joint).name
    lift = next((np.radians(deg) for part, deg in LIFT_DEG.items() if part in name), 0.0)
    return float(np.clip(rest + lift, *model.jnt_range[joint]) - rest)


def _bent(values: FloatArray) -> FloatArray:
    """Return values within (-1, 1): those within .8 as they are."""
    beyond = np.maximum(np.abs(values) - 0.8, 0.0)
    return np.sign(values) * (np.minimum(np.abs(values), 0.8) + 0.2 * np.tanh(beyond / 0.2))


def _move_trunk(model: mujoco.MjModel, draw: np.random.Generator, qpos: FloatArray, rate_hz: float) -> None:
    """Bend the trunk a little, both lumbar hinges together."""
    for name, factors, degrees in (("lean", (0.5, 1.0), 5.0), ("rot", (1.0, 1.0), 1.0), ("bend", (1.0, 1.0), 0.5)):
        angle = np.radians(degrees) * _noise(draw, len(qpos), rate_hz, 0.4)
        for index, factor in enumerate(factors, start=1):
            joint = model.joint(f"robot:hip_{name}{index}").id
            address = model.jnt_qposadr[joint]
            qpos[:, address] = np.clip(qpos[:, address] + factor * angle, *(factor * model.jnt_range[joint] / factor))


def _turn(qpos: FloatArray, angles: FloatArray, axis: FloatArray) -> None:
    for configuration, angle in zip(qpos, angles, strict=True):
        turn, result = np.zeros(4), np.zeros(4)
        mujoco.mju_axisAngle2Quat(turn, axis, angle)
        mujoco.mju_mulQuat(result, turn, configuration[3:7])
        configuration[3:7] = result


def _touches(model: mujoco.MjModel, qpos: FloatArray, roots: tuple[str, ...]) -> bool:
    """Return whether a limb sinks into floor or body at any second frame."""
    data = mujoco.MjData(model)
    bodies = {model.body(name).id for name in roots}
    for body in range(model.nbody):
        if int(model.body_parentid[body]) in bodies:
            bodies.add(body)
    for configuration in qpos[::2]:
        data.qpos[:] = configuration
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        for contact in data.contact[: data.ncon]:
            limb = {int(model.geom_bodyid[geom]) in bodies for geom in contact.geom}
            if contact.dist < -SINK_M and True in limb:
                return True
    return False
