"""The paper's experiments, repeated: each leaves tables, pictures and a page that compares."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

from mimoc.errors import UnknownNameError
from mimoc.experiments.notebook import Notebook, Progress, open_notebook
from mimoc.render.plots.figure import require_matplotlib

EXPERIMENTS: Mapping[str, str] = {
    "growth": "mimoc.experiments.growth",
    "strength": "mimoc.experiments.strength",
    "acuity": "mimoc.experiments.acuity",
    "delays": "mimoc.experiments.delays",
    "inverse": "mimoc.experiments.inverse",
    "rooms": "mimoc.experiments.rooms",
}
"""The module of each, whose `run` takes a notebook and returns the page. It is imported when first needed."""


def run_experiment(name: str, folder: str | Path, *, quick: bool = False, progress: Progress | None = None) -> Path:
    """Run one of the paper's experiments; return the page that it leaves, `NAME.md` in the folder.

    Files of the same name that are there are replaced, each when its successor is whole.

    Args:
        name: A key of `EXPERIMENTS`.
        folder: For tables, pictures and page; it is made if need be.
        quick: Whether to run a smaller one, in seconds or a few minutes.
        progress: Told how much is done, and of how much.

    Raises:
        UnknownNameError: If there is no such experiment.
        OutputError: If the folder cannot be written.
        MissingExtraError: If matplotlib is not installed.
        RenderingError: If it draws scenes, and there is no OpenGL here.
    """
    if name not in EXPERIMENTS:
        raise UnknownNameError("known experiment", name, EXPERIMENTS)
    require_matplotlib()
    experiment = import_module(EXPERIMENTS[name])
    return experiment.run(open_notebook(name, folder, quick=quick, progress=progress))


__all__ = ["EXPERIMENTS", "Notebook", "run_experiment"]
