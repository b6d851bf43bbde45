"""`mimoc.view`: the page of whatever can be shown, as a value that notebooks display, files keep and browsers open."""

import os
import sys
import tempfile
import webbrowser
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard, cast

import gymnasium
import numpy as np

from mimoc.bundle.files import write_file
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.compiler.loading import SPEC_SUFFIXES, load_spec
from mimoc.compiler.pipeline import build
from mimoc.errors import MimocError, OutputError
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.viewer.growth import own_parts
from mimoc.viewer.packing import Packed
from mimoc.viewer.page import describe, fill, page_of
from mimoc.viewer.surroundings import describe_surroundings

if TYPE_CHECKING:  # What reads recordings needs an extra.
    from mimoc.recording.reading import ReadRecording

SUFFIXES = (".html", ".htm")
"""What the name of a page ends in."""
HEIGHT_PX = 620
"""Of a page in a notebook."""
NOW = "now"
"""The pose that an environment is in, on its page."""


class View:
    """A page: notebooks show it, `open` shows it in the browser, and `save` writes it to a file."""

    def __init__(self, html: str, difference: str | None = None):
        """Keep a page.

        Args:
            html: The page.
            difference: What is said of a recording that did not come out again.
        """
        self.html = html
        """The page itself."""
        self.difference = difference
        """The first number of a recording that did not come out again when it was simulated for the page, if any."""
        self.path: Path | None = None
        """Where it was saved, if it was."""

    def __repr__(self) -> str:
        """Return how large it is, and where it was saved."""
        return f"View({len(self.html) / 1e6:.1f} MB{f', saved as {self.path}' if self.path else ''})"

    def _repr_html_(self) -> str:
        """Return what notebooks show: the page in a frame, in which it can reach nothing else."""
        size = f'width="100%" height="{HEIGHT_PX}"'
        return f'<iframe {size} sandbox="allow-scripts" style="border: 0" srcdoc="{escape(self.html)}"></iframe>'

    def save(self, path: str | Path) -> Path:
        """Write the page to a file that ends in .html, and return its path; an existing one is replaced.

        Raises:
            OutputError: If it cannot be written there.
        """
        self.path = write_file(checked_place(Path(path).expanduser()), self.html.encode())
        return self.path

    def open(self) -> bool:
        """Open the page in the browser, in a temporary file if it was not saved; return whether there is a browser."""
        place = self.path or self.save(Path(tempfile.mkdtemp(prefix="mimoc-"), "page.html"))
        return webbrowser.open(place.resolve().as_uri())


def view(
    shown: "Bundle | InfantSpec | ReadRecording | gymnasium.Env | str | Path",
    path: str | Path | None = None,
    *,
    physics: bool = False,
    infant: int | None = None,
    episode: int | None = None,
) -> View:
    """Return a page that shows an infant in 3D in any browser, or replays what was recorded of it.

    It is one file, which needs no server and no network. As the last value of a notebook's cell it is shown there.

    Args:
        shown: A bundle or its folder, a spec or its file (.yaml, .yml); a recording or its folder; or an
            environment, whose infant is shown as it is now.
        path: Also write the page to this file, which ends in .html.
        physics: Whether it contains MuJoCo, so that the infant can fall, be pulled and act: 4 MB more.
        infant: Which of several recorded infants; the first one if it is not said.
        episode: Which recorded episode; the first one if it is not said.

    Raises:
        OutputError: If the page cannot be written there.
        SpecError: If a spec cannot be built, or not at every age from 0 to 24 months.
        BundleError: If a folder is not a whole bundle, or a bundle does not contain its spec.
        RecordingError: If there is no such episode, or it cannot be simulated again.
        RenderingError: If the infant of a recording sees, and there is no OpenGL here.
        MimocError: If the infant has other parts at other ages, or an episode is asked of what is no recording.
    """
    place = path and checked_place(Path(path).expanduser())
    source = _opened(shown)
    if _is_recording(source):
        from mimoc.viewer.replayed import page_of_recording

        page = page_of_recording(source, infant, episode, physics)
        made = View(page.text, page.difference)
    elif (infant, episode) != (None, None):
        raise MimocError("'infant' and 'episode' choose from a recording, and this is none; leave them out")
    else:
        is_live = isinstance(source, InfantEnv)
        made = View(_page_of_env(source, physics) if is_live else page_of(cast(Bundle, source), physics))
    if place:
        made.save(place)
    return made


def checked_place(path: Path) -> Path:
    """Return a path, which a page can have.

    Raises:
        OutputError: If it does not end as one.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise OutputError(f"{path}: no page is written to a file of this name; end it in {' or '.join(SUFFIXES)}")
    return path


def has_display() -> bool:
    """Return whether a browser could show something here."""
    return sys.platform in ("win32", "darwin") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _is_recording(source: object) -> "TypeGuard[ReadRecording]":
    """Return whether this is a recording, which only what has been imported can have read."""
    reading = sys.modules.get("mimoc.recording.reading")
    return reading is not None and isinstance(source, reading.ReadRecording)


def _opened(shown: object) -> "Bundle | ReadRecording | InfantEnv":
    if isinstance(shown, (str, Path)):
        place = Path(shown).expanduser()
        if place.suffix.lower() in SPEC_SUFFIXES:
            return build(load_spec(place))
        if not (place / "recording.json").is_file():
            return read_bundle(place)
        from mimoc.recording.reading import read_recording

        return read_recording(place)
    if isinstance(shown, InfantSpec):
        return build(shown)
    if isinstance(shown, Bundle) or _is_recording(shown):
        return shown
    if isinstance(shown, gymnasium.Env) and isinstance(shown.unwrapped, InfantEnv):
        return shown.unwrapped
    raise MimocError(f"a {type(shown).__name__} cannot be shown; give a bundle, a spec, a recording or an environment")


def _page_of_env(env: InfantEnv, physics: bool) -> str:
    """Return the page of an infant that is as it is now; at other ages the same, as high as it is long."""
    packed = Packed()
    data: dict[str, Any] = describe(packed, env.bundle, physics)
    own = own_parts(env.model, env.manifest)
    lengths_cm = packed.arrays[data["standards"]["measures"]["length_cm"]["child"]["array"]]
    posture = np.tile(env.data.qpos[own.qpos], (len(lengths_cm), 1))
    posture[:, 2] *= lengths_cm / env.manifest.child.length_cm
    data["poses"][NOW] = packed.put(posture)
    around = describe_surroundings(packed, env.model, env.data, own)
    return fill(packed, {**data, "pose": NOW, "surroundings": around})
