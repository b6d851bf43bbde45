"""Draw the pictures of README and docs that show infants again, of today's child, by mimoc's own commands.

    MUJOCO_GL=egl python sculpt/renew_pictures.py [NAME ...] [--but NAME ...] [-o docs] [--before CHECKOUT]

Without names, all of them (`--list`), in some minutes. `--before` is a checkout of an earlier release, which
`before_after.png` is drawn with, too; the page is drawn by Chromium, through Playwright (`mimoc[pages]`).
"""

import argparse
import io
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol, cast

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mimoc import InfantEnv, load_spec, make
from mimoc.render.body_camera import BodyCamera
from mimoc.render.soft_light import STILL
from mimoc.schema.body import EXPRESSIONS

CHECKOUT = Path(__file__).resolve().parents[1]
SOFTWARE = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox")
"""WebGL without a graphics card."""
POLLED_MS, SETTLED_MS = 100, 3000
OFFERED_STEPS = 320  # Control steps until the ball is offered.
FLOATING_STEPS = 400  # Control steps until an infant that starts on the bottom of a bath floats.

AGES_MONTHS = (0, 3, 6, 12, 24)
LOOKS = (
    {"skin": "light", "hair": "blond", "eyes": "blue"},
    {"skin": "fair", "hair": "red", "eyes": "green"},
    {"skin": "medium", "hair": "dark", "eyes": "hazel"},
    {"skin": "tan", "hair": "light_brown", "eyes": "brown"},
    {"skin": "brown", "hair": "black", "eyes": "dark"},
    {"skin": "dark", "hair": "black", "eyes": "dark"},
)
"""Of each tone of the skin, one infant."""
TITLE = (
    ("kicking", 3, {"skin": "fair", "hair": "light_brown", "eyes": "blue"}),
    ("looking", 6, {"skin": "brown", "hair": "black", "eyes": "dark"}),
    ("playing", 9, {"skin": "medium", "hair": "dark", "eyes": "brown"}),
    ("crawling", 10, {"skin": "light", "hair": "red", "eyes": "green"}),
    ("standing", 18, {"skin": "tan", "hair": "black", "eyes": "dark"}),
)
"""Pose, age in months and looks of the infants at the top of the README."""
POSES = ("kicking", "looking", "sitting", "playing", "crawling", "standing")
COLUMN_PX, CELL_PX = (320, 360), (240, 240)
HEAD = ("--crop", "head", "--pose", "standing")
WHITE, INK = "white", (60, 56, 50)


class Commands(Protocol):
    """The commands of mimoc, which write into a folder."""

    @property
    def folder(self) -> Path:
        """Where they write."""
        ...

    def __call__(self, *arguments: str | Path) -> None:
        """Run a command; a path that begins with `@` is one of the checkout."""
        ...


@dataclass(frozen=True)
class Recipe:
    """How a picture is drawn."""

    draw: Callable[[Commands], Image.Image]
    most_kb: int  # How large its file may be.


def spec(mimoc: Commands, name: str, age_months: float, **sections: Any) -> Path:
    """Write the spec of an infant, and return where."""
    path = mimoc.folder / f"{name}.yaml"
    path.write_text(json.dumps({"mimoc": 1, "name": name, "age_months": age_months, **sections}), encoding="utf-8")
    return path


Size = tuple[int, int]  # Width and height in pixels.


def drawn(mimoc: Commands, *arguments: str | Path, size: Size | None = (640, 480), by: str = "render") -> Image.Image:
    """Return the picture of a command, of some size if it takes one."""
    shape = () if size is None else ("--width", str(size[0]), "--height", str(size[1]))
    mimoc(by, *arguments, "-o", "drawn.png", *shape)
    return Image.open(mimoc.folder / "drawn.png").convert("RGB").copy()


def in_rows(pictures: Sequence[Image.Image], across: int, captions: Sequence[str] = (), gap: int = 4) -> Image.Image:
    """Return pictures of one size in rows, each below its caption if there are some."""
    width, height = pictures[0].size
    above = 26 if captions else 0
    rows = -(-len(pictures) // across)
    sheet = Image.new("RGB", (across * (width + gap) - gap, rows * (height + above + gap) - gap), WHITE)
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for number, picture in enumerate(pictures):
        left, top = number % across * (width + gap), number // across * (height + above + gap)
        sheet.paste(picture, (left, top + above))
        if captions:
            pen.text((left + width / 2, top + above / 2), captions[number], INK, font, anchor="mm")
    return sheet


def beside(*pictures: Image.Image, gap: int = 4) -> Image.Image:
    """Return pictures side by side, all as high as the first."""
    height = pictures[0].height
    scaled = [picture.resize((round(picture.width * height / picture.height), height)) for picture in pictures]
    sheet = Image.new("RGB", (sum(picture.width + gap for picture in scaled) - gap, height), WHITE)
    left = 0
    for picture in scaled:
        sheet.paste(picture, (left, 0))
        left += picture.width + gap
    return sheet


def title(mimoc: Commands) -> Image.Image:
    """Return infants of five ages in five poses, each of other looks."""
    portraits = []
    for pose, age_months, colours in TITLE:
        infant = spec(mimoc, pose, age_months, body={"looks": colours})
        portraits.append(drawn(mimoc, infant, "--pose", pose, size=COLUMN_PX))
    return in_rows(portraits, len(portraits))


def ages(mimoc: Commands) -> Image.Image:
    """Return an infant at five ages in six poses."""
    at = ",".join(map(str, AGES_MONTHS))
    return drawn(mimoc, spec(mimoc, "child", 9), "--ages", at, "--poses", ",".join(POSES), size=CELL_PX)


def heads(mimoc: Commands) -> Image.Image:
    """Return heads of one size in the order of age."""
    portraits = [drawn(mimoc, spec(mimoc, "child", age), *HEAD, size=(240, 280)) for age in AGES_MONTHS]
    captions = ["newborn", *(f"{age} months" for age in AGES_MONTHS[1:])]
    return in_rows(portraits, len(portraits), captions)


def expressions(mimoc: Commands) -> Image.Image:
    """Return a face with each expression."""
    faces = [
        drawn(mimoc, spec(mimoc, "child", 9, body={"expression": name}), *HEAD, size=(220, 240)) for name in EXPRESSIONS
    ]
    return in_rows(faces, 5, EXPRESSIONS)


def tones(mimoc: Commands) -> Image.Image:
    """Return an infant of each tone of the skin."""
    infants = [spec(mimoc, f"child{number}", 12, body={"looks": looks}) for number, looks in enumerate(LOOKS)]
    faces = [drawn(mimoc, infant, *HEAD, size=(200, 230)) for infant in infants]
    return in_rows(faces, len(faces), [f"{looks['skin']}, {looks['hair'].replace('_', ' ')}" for looks in LOOKS])


def looks(mimoc: Commands) -> Image.Image:
    """Return an infant with its skin, and the solids under it."""
    infant, size = "@configs/nine_months.yaml", (478, 400)
    return in_rows([drawn(mimoc, infant, "--body", shown, size=size) for shown in ("skin", "solids")], 2)


def view(mimoc: Commands) -> Image.Image:
    """Return a page in a browser."""
    from playwright.sync_api import sync_playwright  # Of the extra `pages`, which other pictures do not need.

    mimoc("view", "@configs/nine_months.yaml", "-o", "page.html", "--no-open")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE)
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto((mimoc.folder / "page.html").as_uri())
        while not page.evaluate("Boolean(window.mimoc)"):
            page.wait_for_timeout(POLLED_MS)
        page.wait_for_timeout(SETTLED_MS)
        taken = page.screenshot()
        browser.close()
    return Image.open(io.BytesIO(taken)).convert("RGB")


def caregiver(mimoc: Commands) -> Image.Image:
    """Return an adult who offers a ball to an infant, and four of its faces as the infant sees them."""
    looking = load_spec(CHECKOUT / "configs" / "caregiver.yaml").with_(
        senses={"vision": {"width_px": 240, "height_px": 240, "acuity": "off", "supersample": 2}}
    )
    pictures = []
    with make(looking, render_mode="rgb_array", width=640, height=480) as env:
        env.reset(seed=0)
        for _ in range(OFFERED_STEPS):
            env.step(np.zeros_like(env.action_space.sample()))
        pictures.append(np.asarray(env.render()))
        env.reset(seed=0)
        adult = cast(InfantEnv, env.unwrapped).caregiver
        assert adult is not None, "its spec has one"
        for face in ("happy", "neutral", "sad", "surprised"):
            adult.do("show_face", face)
            observation = env.step(np.zeros_like(env.action_space.sample()))[0]
            pictures.append(observation["eye_left"])
    whole, *faces = map(Image.fromarray, pictures)
    return beside(whole, in_rows(faces, 2, gap=0), gap=0)


def lab_room(mimoc: Commands) -> Image.Image:
    """Return a room from two sides."""
    sides = (("--azimuth=-105", "24", "2.2"), ("--azimuth=150", "24", "2.2"))
    views = [
        drawn(mimoc, "@configs/lab_room.yaml", azimuth, "--elevation", up, "--distance", far, size=(560, 400))
        for azimuth, up, far in sides
    ]
    return in_rows(views, 2)


def water(mimoc: Commands) -> Image.Image:
    """Return an infant that floats in a bath, and the same on its bottom as it starts."""
    bath = {"name": "bath", "kind": "water", "depth_cm": 30, "sides_cm": [120, 80]}
    at = "within reach of right_hand"
    ball = {"name": "ball", "shape": "sphere", "radius_cm": 4, "density_kg_m3": 300, "at": at}
    infant = spec(
        *(mimoc, "bath", 6), senses={"proprioception": {}}, scene={"start_at": "bath", "objects": [bath, ball]}
    )
    pictures = []
    with make(load_spec(infant)) as env:
        env.reset(seed=0)
        bathing = cast(InfantEnv, env.unwrapped)
        camera = BodyCamera(bathing.model, ["object_bath"], 560, 420, (-65.0, -30.0), exposure=STILL, margin=0.8)
        with closing(camera):
            pictures.append(camera.render(bathing.data))
            for _ in range(FLOATING_STEPS):
                env.step(np.zeros_like(env.action_space.sample()))
            pictures.append(camera.render(bathing.data))
    return in_rows([Image.fromarray(picture) for picture in reversed(pictures)], 2, gap=0)


def tasks(mimoc: Commands) -> Image.Image:
    """Return how five tasks begin."""
    names = ("reach", "standup", "selfbody", "catch", "rollover")
    starts = [drawn(mimoc, f"@configs/{name}.yaml", size=(256, 276)) for name in names]
    return in_rows(starts, len(names), names)


def rooms(mimoc: Commands) -> Image.Image:
    """Return rooms of twelve seeds."""
    return drawn(mimoc, "@configs/playroom.yaml", "--seeds", "0:12", "--size", "240", size=None, by="rooms")


MATURING = dict.fromkeys(("contrast", "colour", "field", "focus", "vergence", "fovea", "flicker"), "age")


def seen(*options: str, **sections: Any) -> Callable[[Commands], Image.Image]:
    """Return a recipe of what an infant in a playroom sees; of two months, with sections, as on the page on vision."""

    def draw(mimoc: Commands) -> Image.Image:
        room = {"kind": "room", "pose": "sitting", "toys": {"count": [3, 6]}}
        infant = spec(mimoc, "seeing", 2, scene=room, **sections) if sections else "@configs/playroom.yaml"
        mimoc("build", infant, "-o", "seeing", "--seed", "1", "--force")
        return drawn(mimoc, "seeing", *options, size=None, by="see")

    return draw


def one(source: str, *options: str, size: Size = (640, 480)) -> Callable[[Commands], Image.Image]:
    """Return a recipe of a single call of `mimoc render`."""
    return lambda mimoc: drawn(mimoc, source, *options, size=size)


PICTURES: Mapping[str, Recipe] = {
    "title.png": Recipe(title, 500),
    "ages.png": Recipe(ages, 600),
    "heads.png": Recipe(heads, 250),
    "expressions.png": Recipe(expressions, 400),
    "tones.png": Recipe(tones, 250),
    "caregiver.png": Recipe(caregiver, 200),
    "looks.png": Recipe(looks, 150),
    "view.png": Recipe(view, 460),
    "nine_months.png": Recipe(one("@configs/nine_months.yaml"), 130),
    "skin.png": Recipe(one("@configs/all_senses.yaml", "--skin"), 130),
    "two_infants.png": Recipe(one("@configs/worlds/two_infants.yaml", size=(900, 560)), 200),
    "two_infants_caregiver.png": Recipe(one("@configs/worlds/two_infants_caregiver.yaml", size=(800, 800)), 220),
    "mobile.png": Recipe(one("@configs/mobile.yaml", size=(960, 640)), 350),
    "lab_room.png": Recipe(lab_room, 480),
    "tasks.png": Recipe(tasks, 220),
    "water.png": Recipe(water, 180),
    "rooms.png": Recipe(rooms, 780),
    "see.png": Recipe(seen("--ages", "2,4,6,12", "--size", "200", "--fovy", "14"), 450),
    "newborn.png": Recipe(
        seen(
            *("--ages", "0,1,3,6,12,24", "--size", "128", "--fovy", "14"),
            senses={"vision": {**MATURING, "foveation": 5}},
        ),
        350,
    ),
}
"""All of them, by the names of their files in `docs/`."""

FILMS: Mapping[str, tuple[str, ...]] = {
    "infant.gif": (
        "@docs/infant.yaml",
        "--policy=reach",
        "--steps=600",
        "--seed=2",
        "--eyes",
        "--size=240",
        "--fps=12",
    ),
    "kicking.gif": (
        *("@docs/kicking.yaml", "--policy=general_movements", "--steps=700", "--seed=1", "--size=288", "--fps=12"),
    ),
    "roll.gif": ("@docs/rolling.yaml", "--policy=skill:roll", "--steps=249", "--seed=2", "--size=240", "--fps=10"),
    "sit.gif": ("@docs/sitting.yaml", "--policy=skill:sit", "--steps=524", "--seed=8", "--size=180", "--fps=8"),
}
"""What `mimoc run` records for each film at the top of a page; `benchmarks/behaviours.py` makes those of behaviours."""


BEFORE_AFTER = "before_after.png"
COLOURS = 256


@dataclass(frozen=True)
class Mimoc:
    """The commands of a checkout, which write into a folder."""

    checkout: Path
    folder: Path

    def __call__(self, *arguments: str | Path) -> None:
        """Run a command in the folder; paths to specs of the checkout begin with `@`.

        Raises:
            SystemExit: If it fails.
        """
        words = [str(self.checkout / str(one)[1:]) if str(one).startswith("@") else str(one) for one in arguments]
        paths = os.pathsep.join([str(self.checkout), *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {**os.environ, "PYTHONPATH": paths}
        command = [sys.executable, "-m", "mimoc", *words]
        done = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"mimoc {' '.join(words)}\n{done.stdout}{done.stderr}")


def main() -> None:
    """Draw the pictures that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="file in docs/; by default, all")
    parser.add_argument("--but", nargs="+", default=(), metavar="NAME", help="those that are left as they are")
    parser.add_argument("-o", "--out", type=Path, default=CHECKOUT / "docs", help="folder of the pictures")
    parser.add_argument("--before", type=Path, help="checkout of an earlier release, to be drawn beside this one")
    parser.add_argument("--list", action="store_true", help="print the names")
    options = parser.parse_args()
    if options.list:
        print(*PICTURES, *FILMS, BEFORE_AFTER, sep="\n")
        return
    names = [name for name in options.names or (*PICTURES, *FILMS) if name not in (*options.but, BEFORE_AFTER)]
    if unknown := set(names) - {*PICTURES, *FILMS}:
        parser.error(f"no recipe for {', '.join(sorted(unknown))}; there are {', '.join((*PICTURES, *FILMS))}")
    options.out.mkdir(parents=True, exist_ok=True)
    for name in names:
        with TemporaryDirectory() as folder:
            mimoc = Mimoc(CHECKOUT, Path(folder))
            if name in FILMS:
                mimoc("run", *FILMS[name], "--video", (options.out / name).resolve())
            else:
                write(options.out / name, PICTURES[name].draw(mimoc), PICTURES[name].most_kb)
    if options.before and (BEFORE_AFTER in options.names or not options.names):
        write(options.out / BEFORE_AFTER, before_after(options.before.resolve()), 400)


def before_after(earlier: Path) -> Image.Image:
    """Return infants of three ages by an earlier checkout, each beside the same by this one."""
    shown = []
    for pose, age_months in (("supine", 0), ("sitting", 9), ("standing", 24)):
        for checkout in (earlier, CHECKOUT):
            with TemporaryDirectory() as folder:
                mimoc = Mimoc(checkout, Path(folder))
                shown.append(drawn(mimoc, spec(mimoc, "child", age_months), "--pose", pose, size=(420, 340)))
    return in_rows(shown, 2, ["before", "now"] * 3)


def write(path: Path, picture: Image.Image, most_kb: int) -> None:
    """Write a picture with as many colours as its file may take, and say how large it is.

    Raises:
        SystemExit: If it is too large with few.
    """
    colours = COLOURS
    content = encoded(picture, None)
    while len(content) > 1000 * most_kb and colours >= 32:
        content, colours = encoded(picture, colours), colours // 2
    if len(content) > 1000 * most_kb:
        sys.exit(f"{path.name} takes {len(content) // 1000} kB, more than {most_kb}; draw it smaller")
    path.write_bytes(content)
    print(f"{path.name}: {picture.width} x {picture.height}, {len(content) // 1000} kB", flush=True)


def encoded(picture: Image.Image, colours: int | None) -> bytes:
    """Return a picture as PNG, with at most so many colours, of which near ones are mixed by a pattern."""
    few = picture
    if colours is not None:
        palette = picture.quantize(colours, Image.Quantize.MEDIANCUT, kmeans=1)
        few = picture.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
    file = io.BytesIO()
    few.save(file, "PNG", optimize=True)
    return file.getvalue()


if __name__ == "__main__":
    main()
