"""`mimoc.view`: the page of whatever can be shown, as a value that notebooks display, files keep and browsers open."""

import sys
import tempfile
import webbrowser
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import gymnasium

from mimoc.base.errors import MimocError
from mimoc.bundle.files import check_page, write_file
from mimoc.bundle.io import Bundle
from mimoc.bundle.world import WorldBundle
from mimoc.compiler.building import compiled
from mimoc.compiler.worlds import world_of
from mimoc.runtime.batch_env import BatchEnv, infants_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.infant import InfantSpec
from mimoc.viewer.appearance import describe_surroundings
from mimoc.viewer.encoding import EncodedArrays
from mimoc.viewer.growth import own_parts
from mimoc.viewer.page import Progress, describe, fill, page_of, page_of_infants, page_of_world, with_posture

if TYPE_CHECKING:  # The reader of recordings needs an extra.
    from mimoc.recording.reading import ReadRecording

HEIGHT_PX = 620  # Height of a page in a notebook.


class View:
    """A page: notebooks show it, `open` shows it in the browser, and `save` writes it to a file.

    Example:
        >>> import mimoc
        >>> page = mimoc.view("out/nine_months")
        >>> page.save("infant.html").name
        'infant.html'
    """

    def __init__(self, html: str, difference: str | None = None):
        """Keep a page, and the `difference` of a recording from its simulation."""
        self.html = html
        """The page itself."""
        self.difference = difference
        """The first number of a recording that differed when it was simulated again for the page, if any."""
        self.path: Path | None = None
        """Where the page was saved; None if it was not."""

    def __repr__(self) -> str:
        """Return how large the page is, and where it was saved."""
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
        self.path = write_file(check_page(path), self.html.encode())
        return self.path

    def open(self) -> bool:
        """Open the page in the browser, in a temporary file if it was not saved; return whether there is a browser."""
        place = self.path or self.save(Path(tempfile.mkdtemp(prefix="mimoc-"), "page.html"))
        return webbrowser.open(place.resolve().as_uri())


def view(
    shown: "Bundle | InfantSpec | WorldBundle | ReadRecording | gymnasium.Env | WorldEnv | Any",
    path: str | Path | None = None,
    *,
    physics: bool = False,
    infant: int | None = None,
    episode: int | None = None,
    progress: Progress = lambda *_: None,
) -> View:
    """Return a page that shows infants in 3D in any browser, or replays what was recorded of one.

    It is one file, which needs no server and no network. As the last value of a notebook's cell it is shown there.

    Args:
        shown: A bundle, a spec or a recording, or its path (a folder, or a .yaml or .yml file of a spec); or an
            environment, whose infant is shown as it is now; or a world of several infants, in any form that
            `mimoc.make_parallel` takes, or its environment. The page of several infants shows one at a time. Of a
            vector environment it shows the first eight.
        path: Also write the page to this file, which ends in .html.
        physics: Whether it contains MuJoCo, so that the infant can fall, be pulled and act: 4 MB more.
        infant: Which of several recorded infants; by default, the first.
        episode: Which recorded episode; by default, the first.
        progress: Called with how much is done, and how much there is to do.

    Raises:
        OutputError: If the page cannot be written there.
        SpecError: If a spec cannot be built.
        BundleError: If a folder is not a whole bundle, or a bundle does not contain its spec.
        RecordingError: If there is no such episode, or it cannot be simulated again.
        RenderingError: If the infant of a recording sees, and there is no OpenGL here.
        MimocError: If the infant has other parts at other ages, or an episode is asked of what is no recording.

    Example:
        >>> import mimoc
        >>> mimoc.view("nine_months.yaml", "nine_months.html").path.name
        'nine_months.html'
    """
    place = path and check_page(path)
    if (recording := _recording_of(shown)) is not None:
        from mimoc.viewer.episode_page import page_of_recording

        made = View(*page_of_recording(recording, infant, episode, physics, progress))
    elif (infant, episode) != (None, None):
        raise MimocError("'infant' and 'episode' choose from a recording, and this is none; leave them out")
    elif isinstance(shown, gymnasium.Env) and isinstance(shown.unwrapped, InfantEnv):
        made = View(_page_of_env(shown.unwrapped, physics))
    elif isinstance(inside := getattr(shown, "unwrapped", shown), (WorldEnv, BatchEnv)):
        _refuse(physics)
        name = inside.bundle.manifest.name if isinstance(inside, WorldEnv) else "infants"
        made = View(page_of_infants(name, infants_of("view", inside), progress))
    elif (world := world_of(shown)) is not None:
        _refuse(physics)
        made = View(page_of_world(world, progress))
    elif isinstance(shown, (Bundle, InfantSpec, str, Path)):
        source = Path(shown).expanduser() if isinstance(shown, (str, Path)) else shown
        made = View(page_of(compiled(source), physics, progress))
    else:
        kind = type(shown).__name__
        raise MimocError(f"a {kind} cannot be shown; give a bundle, a spec, a world, a recording or an environment")
    if place:
        made.save(place)
    return made


def _refuse(physics: bool) -> None:
    if physics:
        raise MimocError("physics on a page is that of a single infant, and here are several")


def is_recording(path: str | Path) -> bool:
    """Return whether this is the folder of a recording."""
    from mimoc.recording.description import RECORDING

    return (Path(path).expanduser() / RECORDING).is_file()


def _recording_of(shown: object) -> "ReadRecording | None":
    """Return the recording that is to be shown, or None; the reader of recordings is imported only if it is one."""
    if isinstance(shown, (str, Path)) and is_recording(shown):
        from mimoc.recording.reading import read_recording

        return read_recording(shown)
    reading = sys.modules.get("mimoc.recording.reading")
    return cast("ReadRecording", shown) if reading and isinstance(shown, reading.ReadRecording) else None


def _page_of_env(env: InfantEnv, physics: bool) -> str:
    """Return the page of an environment's infant in its present state."""
    packed = EncodedArrays()
    infant = own_parts(env.model, env.manifest)
    about: dict[str, Any] = packed.put(describe(env.bundle, physics))
    about = with_posture(about, packed, env.data.qpos[infant.qpos], env.manifest.child.length_cm)
    return fill({**about, "surroundings": describe_surroundings(env.model, env.data, infant)}, packed)
