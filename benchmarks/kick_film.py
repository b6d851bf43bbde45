"""A film of infants that kick by one burst at the hip, before and after joints and tone were those of real infants.

    python benchmarks/kick_film.py --before OLD_0 OLD_3 --after NEW_0 NEW_3 [-o docs/kick.gif]

The four are bundles of `age_months: 0` and `3`, those before written by `mimoc build` of commit 70550b97, the last with
the law before. Each is opened in plain MuJoCo in its pose `supine` and left quiet for two seconds. Then the flexors of
left and right hip take turns with .8 of their strength for .35 s, and all else is quiet. Those before are drawn on the
bodies of those after, which have the same joints. The camera is at a distance in proportion to the infant's size.
Prints by how much each burst bends its hip from where it begins.
"""

import argparse
import os
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mimoc.render.body_camera import BodyCamera
from mimoc.render.camera import FOVY_DEG, Shot, View

SHARE, BURST_S, TURN_S = 0.8, 0.35, 0.9
SIDES = ("left", "right", "left", "right")
QUIET_S = 2.0
FPS, WIDTH, HEIGHT, COLOURS = 15, 320, 210, 160
SIDE: View = (-106.0, -24.0)  # From the left of an infant, a little towards its feet and above it.
AGES, TIMES = ("newborn", "three months"), ("before", "after")


def main() -> None:
    """Write the film."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", nargs=2, type=Path, required=True, metavar="BUNDLE")
    parser.add_argument("--after", nargs=2, type=Path, required=True, metavar="BUNDLE")
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/kick.gif"))
    chosen = parser.parse_args()
    bundles = [*chosen.before, *chosen.after]
    captions = [f"{age}, {time}" for time in TIMES for age in AGES]
    shown = [*chosen.after, *chosen.after]
    panels = [panel(*infant) for infant in zip(bundles, shown, captions, strict=True)]
    write([tiled(pictures) for pictures in zip(*panels, strict=True)], chosen.output)


def panel(bundle: Path, shown: Path, caption: str) -> list[Image.Image]:
    """Return the pictures of one infant, drawn as another, and print how far its hips bend."""
    model, body = (mujoco.MjModel.from_xml_path(str(path / "scene.xml")) for path in (bundle, shown))
    data, drawn = mujoco.MjData(model), mujoco.MjData(body)
    mujoco.mj_resetDataKeyframe(model, data, model.key("supine").id)
    mujoco.mj_step(model, data, round(QUIET_S / model.opt.timestep))
    start_s, angles_deg, pictures = data.time, [[] for _ in SIDES], []
    hips = [model.joint(f"robot:{side}_hip1").qposadr[0] for side in SIDES]
    with closing(BodyCamera(body, ["hip"], WIDTH, HEIGHT)) as camera:
        move(drawn, data)
        shot = side_view(drawn)
        while (time_s := data.time - start_s) < TURN_S * len(SIDES) - 1e-9:
            turn = int((time_s + 1e-9) / TURN_S)
            burst = time_s - turn * TURN_S < BURST_S
            data.ctrl[:] = 0.0
            data.actuator(f"act:{SIDES[turn]}_hip_flex").ctrl[0] = -SHARE * burst
            if len(pictures) <= time_s * FPS + 1e-9:
                move(drawn, data)
                pictures.append(captioned(camera.render(drawn, shot=shot), caption))
            angles_deg[turn].append(float(np.degrees(data.qpos[hips[turn]])))
            mujoco.mj_step(model, data)
    print(f"{caption}: hips bend by", ", ".join(f"{angles[0] - min(angles):.0f}" for angles in angles_deg), "degrees")
    return pictures


def move(drawn: mujoco.MjData, data: mujoco.MjData) -> None:
    """Put an infant where another one is, at each joint that has the same name."""
    for number in range(drawn.model.njnt):
        joint = drawn.joint(number)
        joint.qpos[:] = data.joint(joint.name).qpos
    mujoco.mj_forward(drawn.model, drawn)


def side_view(data: mujoco.MjData) -> Shot:
    """Return a shot of an infant from its left, of a size in proportion to it."""
    trunk_m = float(np.linalg.norm(data.body("head").xpos - data.body("hip").xpos))
    middle_m = data.body("hip").xpos + trunk_m * np.array([-0.1, 0.0, 0.12])
    return Shot(middle_m, 0.0, SIDE, FOVY_DEG).from_distance(4.6 * trunk_m, FOVY_DEG)


def captioned(picture: np.ndarray, caption: str) -> Image.Image:
    """Return a picture, shape (height, width, 3), with its caption at the top left."""
    image = Image.fromarray(picture)
    ImageDraw.Draw(image).text((8, 5), caption, fill=(40, 40, 40), font=ImageFont.load_default(15))
    return image


def tiled(pictures: Sequence[Image.Image]) -> Image.Image:
    """Return four pictures as two rows of two, with a gap between them."""
    sheet = Image.new("RGB", (2 * WIDTH + 4, 2 * HEIGHT + 4), "white")
    for place, picture in enumerate(pictures):
        sheet.paste(picture, (place % 2 * (WIDTH + 4), place // 2 * (HEIGHT + 4)))
    return sheet


def write(sheets: Sequence[Image.Image], path: Path) -> None:
    """Write a film that repeats, with one palette for all its pictures."""
    chosen = sheets[:: len(sheets) // 5]
    stack = Image.fromarray(np.concatenate([np.asarray(sheet) for sheet in chosen]))
    palette = stack.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
    frames = [sheet.quantize(palette=palette, dither=Image.Dither.NONE) for sheet in sheets]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=round(1000 / FPS), loop=0, optimize=True)
    print(f"{path}: {len(frames)} pictures, {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
