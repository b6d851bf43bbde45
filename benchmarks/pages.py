"""How heavy pages of `mimoc view` are, how soon they show something, and how many pictures a second they draw.

Needs `pip install 'mimoc[pages]'` and Chromium: the system's or Playwright's. It draws without a graphics card, but for
--gpu.
"""

import argparse
import re
import shutil
import tempfile
import time
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

import mimoc
from mimoc.viewer.page import page_of

CONFIG = Path(__file__).parents[1] / "configs" / "nine_months.yaml"
SOFTWARE = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox")
GPU = ("--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--no-sandbox")
SIZES = ((1280, 800), (800, 600), (390, 780))  # Of windows, in pixels: a laptop's, a small one, a phone's.
MOTIONS = {
    "orbiting": "mimoc.stage.turn(0.02, 0)",
    "growing": "mimoc.setAge((mimoc.age + 0.05) % 24)",
    "growing, solids": "mimoc.setAge((mimoc.age + 0.05) % 24)",
    "physics": "0",
}
"""What is done before each picture; physics moves the infant itself."""
COUNT = """([step, seconds]) => new Promise((done) => {
    const act = new Function(step);
    let first = null, start = 0;
    const frame = (now) => {
        if (first === null) [first, start] = [now, mimoc.stage.frames];
        if (now - first > 1000 * seconds) return done((1000 * (mimoc.stage.frames - start)) / (now - first));
        act();
        requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
})"""


DRAWN = """() => {
    const gl = mimoc.stage.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}"""
"""Returns when all that was to be drawn is drawn."""


def wait_for(page: Page, condition: str) -> None:
    """Wait until a condition holds."""
    page.evaluate(f"(async () => {{ while (!({condition})) await new Promise((next) => setTimeout(next, 5)); }})()")


def weigh(page: str) -> str:
    """Return how large a page and its parts are."""
    parts = {name: len(text) for name, text in re.findall(r'id="(\w+)">(.*?)</script>', page, re.DOTALL)}
    told = ", ".join(f"{name} {size / 1e6:.2f}" for name, size in parts.items() if size)
    return f"{len(page.encode()) / 1e6:.2f} MB: {told}"


def opened(browser: Browser, path: Path, size: tuple[int, int]) -> tuple[Page, float]:
    """Return a page from disk and after how many seconds it had drawn its first picture."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    start = time.perf_counter()
    page.goto(path.as_uri())
    wait_for(page, "window.mimoc?.stage.frames")
    page.evaluate(DRAWN)
    return page, time.perf_counter() - start


def rate(page: Page, motion: str, seconds: float) -> float:
    """Return the pictures per second while something moves."""
    page.evaluate(f"mimoc.enter('{'physics' if motion == 'physics' else 'pose'}')")
    page.evaluate(f"mimoc.infant.showSkin({str('solids' not in motion).lower()})")
    if motion == "physics":
        wait_for(page, "mimoc.physics.data")
    page.evaluate(COUNT, [MOTIONS[motion], seconds / 2])  # Until it has found its resolution.
    return page.evaluate(COUNT, [MOTIONS[motion], seconds])


def main() -> None:
    """Print weights, times and rates."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gpu", action="store_true", help="draw with the graphics card")
    parser.add_argument("--seconds", type=float, default=4, help="how long each rate is measured")
    arguments = parser.parse_args()
    infant = mimoc.build(CONFIG)
    pages = {"infant": page_of(infant), "with physics": page_of(infant, physics=True)}
    for name, page in pages.items():
        print(f"{name}: {weigh(page)}")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(folder, "page.html")
        flags = [*(GPU if arguments.gpu else SOFTWARE)]
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=flags)
        for name, page in pages.items():
            path.write_text(page, encoding="utf-8")
            times = [opened(browser, path, SIZES[0]) for _ in range(3)]
            for shown, _ in times:
                shown.close()
            print(f"{name}: first picture after {sorted(seconds for _, seconds in times)[1]:.1f} s")
        for size in SIZES:
            page, _ = opened(browser, path, size)
            for motion in MOTIONS:
                found = rate(page, motion, arguments.seconds)
                print(f"{size[0]} x {size[1]}, {motion}: {found:.1f} pictures a second", flush=True)
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
