"""A small problem of a fit, on a child with every hinge away from rest."""

import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from mimoc.motion.body_points import film, locate
from mimoc.motion.labels import POINTS
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, PointRecording
from mimoc.movement.retargeting.fitting import Problem, State
from mimoc.movement.retargeting.observations import camera_from_world
from mimoc.movement.retargeting.setting import Noise, Setting, first_state, problem_of, setting_of
from mimoc.movement.retargeting.sizes import Child, compile_child, starting_spec
from mimoc.schema.infant import InfantSpec

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import known_motions

NAMES = tuple(name for name in POINTS if not name.endswith(("heel", "small_toe")))
FRAMES, RATE_HZ = 12, 15.0


@cache
def child(hands: str = "mitten") -> Child:
    spec = starting_spec(None, 3.0, "child")
    return compile_child(spec.with_(body={"hands": hands}))


@cache
def setting(kind: str, hands: str = "mitten") -> Setting:
    """Return what a fit is of: `pixels`, `depth` or `space`."""
    model = child(hands).model
    qpos = known_motions.known_motion(model, np.random.default_rng(2), FRAMES, RATE_HZ)
    recording = film(model, qpos, RATE_HZ, NAMES)
    if kind == "pixels":
        recording = replace(recording, depth_m=None)
    if kind == "space":
        places_m = locate(model, qpos, NAMES)
        recording = replace(recording, positions=places_m, camera=None, depth_m=None)
    return setting_of(recording, child(hands), None)


def slanted(
    model: object, qpos: np.ndarray, pitch_deg: float, names: tuple[str, ...] = NAMES, turned_deg: float = 0.0
) -> PointRecording:
    """Return what a camera 1 m from an infant sees that looks down by an angle, with depth."""
    places_m = locate(model, qpos, names)
    turn, (cosine, sine) = (
        camera_from_world(pitch_deg),
        (np.cos(np.radians(turned_deg)), np.sin(np.radians(turned_deg))),
    )
    places_m = (places_m - places_m.mean((0, 1))) @ np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
    seen_m = (places_m + turn[2]) @ turn.T
    seen = np.ones(places_m.shape[:2])
    return PointRecording(
        "slanted", RATE_HZ, names, MINI_RGBD_CAMERA.project(seen_m), seen, MINI_RGBD_CAMERA, seen_m[..., 2]
    )


def problem_and_state(
    kind: str, hands: str = "mitten", shift: float = 0.05, pitch_deg: float | None = None
) -> tuple[Problem, State]:
    draw = np.random.default_rng(4)
    whole = setting(kind, hands)
    if pitch_deg is not None:
        whole = setting_of(whole.recording, child(hands), None, pitch_deg)
    problem = problem_of(whole, whole.recording, Noise(1.0 if kind != "space" else 0.01, 0.01, 0.1))
    state = first_state(whole, problem)
    x = state.x + shift * draw.normal(size=state.x.shape)
    return problem, State(x, state.height_m + 0.02, 0.05 * draw.normal(size=state.logs.shape))


@cache
def known(seed: int, frames: int = 90, **options) -> tuple[InfantSpec, np.ndarray, object, object]:
    draw = np.random.default_rng(seed)
    spec = known_motions.random_child(draw)
    model = known_motions.model_of(spec)
    qpos = known_motions.known_motion(model, draw, frames, 30.0)
    return spec, qpos, model, known_motions.recorded(model, qpos, draw, known_motions.ALL_POINTS, **options)
