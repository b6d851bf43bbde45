"""Cost of vision: both eyes with acuity and foveation, compared with MuJoCo's default rendering.

    python benchmarks/vision.py [--rounds 20]

The usual way draws with `mujoco.Renderer` and its default settings (shadows, reflections, four samples a pixel, the
model's buffer), and works the filters out anew for each picture: a Fourier transform of the picture padded by
reflection, and interpolation at the points that the foveation maps to. Both draw the same postures of one infant,
without its own head in the way. Mesa draws in one thread for both, so that CPU time is what passes. Wanted: at least 8
times faster, filters in less than a quarter of the time that drawing takes, and a control step with eyes in which all
is as in adults within 5 % of one with acuity alone.
"""

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")  # MuJoCo's own renderer looks for a screen otherwise.

import mujoco
import numpy as np
from measuring import cpu_medians_s
from scipy.ndimage import map_coordinates

import mimoc
from mimoc.bundle.model import load_model
from mimoc.components.senses.vision import VisionEntry, eyes as eyes_module
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.components.senses.vision.foveation import to_source
from mimoc.components.senses.vision.run import Vision, bind, perceive

SIZES_PX = (64, 128)
AGE_MONTHS = 4
CONFIG = Path(__file__).parents[1] / "configs" / "all_senses.yaml"
FOVEATION = 5.0
STATES = 10  # Postures that are drawn in each round.
GAZE_RAD = {"robot:head_tilt": 0.6, "robot:left_eye_vertical": -0.5, "robot:right_eye_vertical": -0.5}
HIDDEN_GROUP = 5


def main() -> None:
    """Print what mimoc's way and the usual way cost, then where the time of mimoc's goes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20)
    rounds = parser.parse_args().rounds
    print("both eyes, a picture each [ms]")
    print(f"{'pixels':>9} {'mimoc':>7} {'usual':>7} {'ratio':>6} {'drawing':>8} {'filters':>8} {'share':>6}")
    for size_px in SIZES_PX:
        compare(size_px, rounds)
    print(f"\nwhere the time goes, {SIZES_PX[0]} pixels [ms]")
    dissect(SIZES_PX[0], rounds)
    print(f"\na control step with all senses, {SIZES_PX[0]} pixels [ms], and over one with acuity by age alone")
    maturing(rounds)


def compare(size_px: int, rounds: int) -> None:
    """Print a row of the first table."""
    entry, model, states, vision = infant(size_px)
    of_head = np.isin(model.geom_bodyid, [model.body(name).id for name in entry.unseen])
    model.geom_group[of_head] = HIDDEN_GROUP  # MuJoCo's renderer would look into the head.
    renderer = mujoco.Renderer(model, size_px, size_px)
    drawn = [vision.eyes(data) for data in states]
    candidates = {
        "mimoc": lambda: [vision(data) for data in states],
        "usual": lambda: [usual(renderer, entry, data) for data in states],
        "drawing": lambda: [vision.eyes(data) for data in states],
        "filters": lambda: [perceive(pictures, vision.filters) for pictures in drawn],
    }
    ms = {name: 1e3 * s / STATES for name, s in cpu_medians_s(candidates, rounds).items()}
    print(
        f"{size_px:3} x {size_px:3} {ms['mimoc']:7.2f} {ms['usual']:7.1f} {ms['usual'] / ms['mimoc']:6.1f} "
        f"{ms['drawing']:8.2f} {ms['filters']:8.2f} {ms['filters'] / ms['drawing']:6.2f}",
        flush=True,
    )
    renderer.close()
    vision.close()


def dissect(size_px: int, rounds: int) -> None:
    """Print what each part of mimoc's way costs, and what drawing would with other settings."""
    entry, model, states, vision = infant(size_px)
    drawn = [vision.eyes(data) for data in states]
    stages = [[pictures.astype(np.float32) for pictures in drawn]]
    for each in vision.filters:
        stages.append([each(pictures) for pictures in stages[-1]])
    with as_round_as_the_model_asks_for():
        rounder = Eyes(model, entry.cameras, size_px, size_px, entry.unseen)
    is_floor = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    candidates = {
        "drawing": lambda: [vision.eyes(data) for data in states],
        "- without the floor": lambda: draw_without(is_floor, model, vision.eyes, states),
        "- without anything": lambda: draw_without(is_floor | True, model, vision.eyes, states),
        f"- limbs of {model.vis.quality.numslices} sides": lambda: [rounder(data) for data in states],
    }
    for each, before in zip(vision.filters, stages, strict=False):
        candidates[each.func.__name__] = lambda each=each, before=before: [each(pictures) for pictures in before]
    candidates["clip and round"] = lambda: [perceive(pictures, [lambda same: same]) for pictures in drawn]
    for name, s in cpu_medians_s(candidates, rounds).items():
        print(f"{name:24} {1e3 * s / STATES:7.3f}", flush=True)
    change = np.mean([np.abs(rounder(data).astype(int) - vision.eyes(data)).mean() for data in states])
    print(f"\nlimbs with as many sides as the model asks for change a picture by {change:.2f} grey levels on average")
    rounder.close()
    vision.close()


KEYS = ("contrast", "colour", "field", "focus", "fovea", "flicker")
YOUNG_MONTHS = 1.0
KINDS: dict[str, dict[str, object]] = {
    "acuity by age": {},
    "all as adults": {"acuity": "off", **dict.fromkeys(KEYS, "adult")},
    "all as adults, acuity by age": dict.fromkeys(KEYS, "adult"),
    "all off": {"acuity": "off"},
    **{f"{key} of a month": {key: YOUNG_MONTHS} for key in KEYS},
    "all of a month": dict.fromkeys(KEYS, YOUNG_MONTHS),
    "all by age": dict.fromkeys(KEYS, "age"),
}
STEPS = 50


def maturing(rounds: int) -> None:
    """Print what a control step costs with eyes that are as mature as at some age, side by side."""
    spec, environments = mimoc.load_spec(CONFIG), {}
    for name, keys in KINDS.items():
        environments[name] = mimoc.make(spec.with_(senses={"vision": keys}))
        environments[name].reset(seed=0)
    still = np.zeros(environments["acuity by age"].action_space.shape, np.float32)

    def step(name: str) -> None:
        for _ in range(STEPS):
            environments[name].step(still)

    medians_s = cpu_medians_s({name: partial(step, name) for name in KINDS}, rounds)
    usual_s = medians_s["acuity by age"]
    for name, taken_s in medians_s.items():
        print(f"{name:30} {1e3 * taken_s / STEPS:7.3f} {taken_s / usual_s:6.3f}", flush=True)
        environments[name].close()


def infant(size_px: int) -> tuple[VisionEntry, mujoco.MjModel, list[mujoco.MjData], Vision]:
    """Return an infant that sits and looks at its legs, in several postures, and its sense of vision."""
    vision = {"width_px": size_px, "height_px": size_px, "foveation": FOVEATION}
    spec = {"mimoc": 1, "name": "seeing", "age_months": AGE_MONTHS, "senses": {"vision": vision}}
    scene = {"kind": "flat", "pose": "sitting"}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "scene": scene}))
    model, rng, states = load_model(bundle), np.random.default_rng(0), []
    for _ in range(STATES):
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
        data.qpos[7:] += rng.uniform(-0.2, 0.2, model.nq - 7)
        for joint, angle_rad in GAZE_RAD.items():
            data.joint(joint).qpos = angle_rad
        mujoco.mj_forward(model, data)
        states.append(data)
    entry = bundle.manifest.senses.vision
    return entry, model, states, bind(entry, model, bundle)


def usual(renderer: mujoco.Renderer, entry: VisionEntry, data: mujoco.MjData) -> list[np.ndarray]:
    """Return both pictures, drawn and filtered as one would without thinking of speed."""
    seen = []
    for camera in entry.cameras:
        renderer.update_scene(data, camera)
        blurred = blurred_by_padding(renderer.render(), 60.0, entry.acuity_cpd)
        foveated = foveated_by_interpolation(blurred, entry)
        seen.append(np.rint(foveated.clip(0, 255)).astype(np.uint8))
    return seen


def blurred_by_padding(picture: np.ndarray, fovy_deg: float, acuity_cpd: float) -> np.ndarray:
    """Return a picture through the contrast sensitivity, by Fourier transform of each colour."""
    height, width, _ = picture.shape
    pixels_per_degree = height / 2 / np.tan(np.radians(fovy_deg) / 2) * np.pi / 180
    pad = min(int(np.ceil(4 * pixels_per_degree / acuity_cpd)), height - 1)
    padded = np.pad(picture.astype(float), ((pad, pad), (pad, pad), (0, 0)), mode="reflect")
    rows, columns = (np.fft.fftfreq(size) * pixels_per_degree for size in padded.shape[:2])
    gain = np.maximum(0, 1 - np.hypot(rows[:, None], columns) / acuity_cpd)[..., None]
    whole = np.fft.ifft2(np.fft.fft2(padded, axes=(0, 1)) * gain, axes=(0, 1)).real
    return whole[pad : pad + height, pad : pad + width]


def foveated_by_interpolation(picture: np.ndarray, entry: VisionEntry) -> np.ndarray:
    """Return a picture warped, by looking up where each pixel comes from."""
    height, width, _ = picture.shape
    y, x = np.mgrid[:height, :width] + 0.5
    points = np.stack([x - width / 2, y - height / 2], axis=-1)
    source = to_source(points, (width, height), entry.foveation, entry.foveation_radius)
    places = source[..., 1] + height / 2 - 0.5, source[..., 0] + width / 2 - 0.5
    return np.stack(
        [map_coordinates(colour, places, order=1, mode="nearest") for colour in picture.T.swapaxes(1, 2)], 2
    )


def draw_without(geoms: np.ndarray, model: mujoco.MjModel, eyes: Eyes, states: list[mujoco.MjData]) -> None:
    """Draw with some geoms hidden."""
    groups = model.geom_group.copy()
    model.geom_group[geoms] = HIDDEN_GROUP
    for data in states:
        eyes(data)
    model.geom_group[:] = groups


@contextmanager
def as_round_as_the_model_asks_for() -> Iterator[None]:
    """Let eyes draw limbs with as many sides as anyone else does."""
    usual, eyes_module.SLICES_PER_ROOT_PX = eyes_module.SLICES_PER_ROOT_PX, 1e3
    yield
    eyes_module.SLICES_PER_ROOT_PX = usual


if __name__ == "__main__":
    main()
