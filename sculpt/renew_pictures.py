"""Draw the pictures of README and docs that show infants again, of today's child, by mimoc's own commands.

    MUJOCO_GL=egl python sculpt/renew_pictures.py [NAME ...] [--but NAME ...] [-o docs] [--before CHECKOUT]

Without names, all of them (`--list`), in some minutes. `--before` is a checkout of an earlier release, which
`before_after.png` is drawn with, too; the page is drawn by Chromium, through Playwright (`mimoc[pages]`).
"""

import argparse
import io
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from picture_recipes import CHECKOUT, FILMS, PICTURES, drawn, in_rows, spec
from PIL import Image

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
