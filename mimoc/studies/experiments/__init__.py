"""The paper's experiments, reproduced: each writes tables, figures and a report that compares the results."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

from mimoc.base.errors import UnknownNameError
from mimoc.render.plots.file import require_matplotlib
from mimoc.studies.experiments.notebook import Notebook, Progress, open_notebook

EXPERIMENTS: Mapping[str, str] = {
    name: f"mimoc.studies.experiments.{name}"
    for name in ("growth", "strength", "acuity", "delays", "inverse", "rooms", "development", "growing")
}
"""Module of each experiment, imported when needed; its `run` takes a notebook and returns the path of the report."""


def run_experiment(name: str, folder: str | Path, *, quick: bool = False, progress: Progress | None = None) -> Path:
    """Run one of the paper's experiments; return the path of its report, `NAME.md` in the folder.

    Existing files of the same names are replaced, each of them atomically.

    Args:
        name: A key of `EXPERIMENTS`.
        folder: Folder for tables, figures and report; it is created if necessary.
        quick: Whether to run a smaller version, which takes seconds or a few minutes.
        progress: Called with the number of steps done and their total.

    Raises:
        UnknownNameError: If there is no such experiment.
        OutputError: If the folder cannot be written.
        MissingExtraError: If matplotlib is not installed.
        RenderingError: If the experiment renders scenes and OpenGL is not available.

    Example:
        >>> import mimoc
        >>> mimoc.run_experiment("growth", "out/growth", quick=True).name
        'growth.md'
    """
    if name not in EXPERIMENTS:
        raise UnknownNameError("known experiment", name, EXPERIMENTS)
    require_matplotlib()
    experiment = import_module(EXPERIMENTS[name])
    return experiment.run(open_notebook(name, folder, quick=quick, progress=progress))


__all__ = ["EXPERIMENTS", "Notebook", "run_experiment"]
