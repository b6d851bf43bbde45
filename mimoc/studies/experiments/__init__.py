"""Experiments of the paper and of others, reproduced: each writes tables, figures and a report that compares them."""

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import get_args

from mimoc.base.classes import takes
from mimoc.base.errors import MimocError, UnknownNameError, check_name
from mimoc.render.plots.file import require_matplotlib
from mimoc.schema.names import Development
from mimoc.studies.bodies import bodies_digest
from mimoc.studies.experiments.notebook import Progress, open_notebook
from mimoc.studies.names import EXPERIMENTS

DEVELOPMENTS: Mapping[str, Development] = {
    "growth": "maturing",
    "strength": "published",
    "acuity": "maturing",
    "delays": "published",
    "inverse": "published",
    "rooms": "maturing",
}
"""Law of development of the infants of each of the paper's experiments, unless another is asked for."""


@takes("the name of an experiment", str)
def run_experiment(
    name: str,
    folder: str | Path,
    *,
    quick: bool = False,
    development: Development | None = None,
    progress: Progress | None = None,
) -> Path:
    """Run an experiment; return the path of its report, `NAME.md` in the folder.

    Existing files of the same names are replaced, each of them atomically.

    Args:
        name: A key of `EXPERIMENTS`.
        folder: Folder for tables, figures and report; it is created if necessary.
        quick: Whether to run a smaller version, which takes seconds or a few minutes.
        development: Law of development of the infants, of experiments in `DEVELOPMENTS`; by default the one there.
            With `published`, the report has the paper's figures beside those measured.
        progress: Called with the number of steps done and their total.

    Raises:
        UnknownNameError: If there is no such experiment or law.
        MimocError: If the experiment has laws of its own.
        OutputError: If the folder cannot be written.
        MissingExtraError: If matplotlib is not installed.
        RenderingError: If the experiment renders scenes and OpenGL is not available.

    Example:
        >>> import mimoc
        >>> mimoc.run_experiment("growth", "out/growth", quick=True).name
        'growth.md'
    """
    law = check_experiment(name, development)
    require_matplotlib()
    experiment = import_module(EXPERIMENTS[name])
    notebook = open_notebook(name, folder, quick=quick, development=law, progress=progress)
    return experiment.run(replace(notebook, bodies=bodies_digest(experiment.infants(law))))


def check_experiment(name: str, development: str | None) -> Development | None:
    """Return the law of development of the infants of an experiment, None if it has its own; or raise a MimocError."""
    if name not in EXPERIMENTS:
        raise UnknownNameError("known experiment", name, EXPERIMENTS)
    if development is None:
        return DEVELOPMENTS.get(name)
    check_name("law of development", development, get_args(Development))
    if name not in DEVELOPMENTS:
        raise MimocError(f"the experiment '{name}' has laws of development of its own; leave out 'development'")
    return "published" if development == "published" else "maturing"
