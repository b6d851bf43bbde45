"""A browser, pages in it, and a recording to be shown."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright
from support.pages import wait_for

import mimoc
from mimoc.viewer.episode_page import page_of_recording
from mimoc.viewer.page import page_of

CONFIGS = Path(__file__).parents[2] / "configs"
SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]
"""WebGL without a graphics card."""
PATIENCE_MS = 120_000
RECORDED_STEPS = 60


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE)
        yield found
        found.close()


@pytest.fixture(scope="session")
def infant() -> mimoc.Bundle:
    return mimoc.build(CONFIGS / "nine_months.yaml")


@pytest.fixture(scope="session")
def written(infant, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("pages") / "infant.html"
    path.write_text(page_of(infant, physics=True), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def recorded(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("recordings")
    spec = mimoc.load_spec(CONFIGS / "all_senses.yaml").with_(senses={"touch": {"density": 0.3}})
    with mimoc.Recorder(mimoc.make(spec), folder / "senses") as env:
        env.reset(seed=1)
        for step in range(RECORDED_STEPS):
            if step == RECORDED_STEPS // 2:
                env.unwrapped.set_expression("happy")
            env.step(env.action_space.sample())
    path = folder / "recording.html"
    path.write_text(page_of_recording(mimoc.read_recording(folder / "senses"))[0], encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def open_page(browser) -> Iterator[Callable[..., Page]]:
    """Return what opens a page from disk, and fails at whatever it asks of others or complains about."""
    complaints, opened = [], []

    def open_one(path: Path, width: int = 1100, height: int = 720) -> Page:
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda message: message.type == "error" and complaints.append(message.text))
        page.on("request", lambda request: request.url.startswith("http") and complaints.append(request.url))
        page.goto(path.as_uri())
        wait_for(page, "Boolean(window.mimoc)")
        opened.append(page)
        return page

    yield open_one
    for page in opened:
        page.close()
    assert complaints == []


@pytest.fixture(scope="session")
def shown(open_page, written) -> Page:
    return open_page(written)


@pytest.fixture(scope="session")
def replayed(open_page, recorded) -> Page:
    return open_page(recorded)
