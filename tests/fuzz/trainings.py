"""Folders of training runs that are changed by chance, and used: reported on, resumed, and acted by."""

from pathlib import Path
from shutil import copytree
from typing import Any
from unittest.mock import patch

import numpy as np
from fuzz import policies
from fuzz.folder_mutations import spoil
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import pick

import mimoc
from mimoc.errors import MimocError, RenderingError
from mimoc.reporting.infant import portrait
from mimoc.training.run_folder import read_training_run

SETTINGS = {"envs": 2, "checkpoint_every": 64, "hyper": policies.TINY}
STEPS = 64


def prepare(folder: Path) -> tuple[Path, mimoc.Bundle, Any]:
    """Return the folder of a training run that has hardly begun, its infant, and its environment."""
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(policies.SPEC))
    mimoc.train(bundle, folder / "run", steps=STEPS, **SETTINGS)
    return folder / "run", bundle, mimoc.InfantEnv(bundle)


def attempt(prepared: tuple[Path, mimoc.Bundle, Any], generator: np.random.Generator, folder: Path) -> None:
    """Change the folder of a training run, and use it in a few ways."""
    trained, bundle, env = prepared
    run = Path(copytree(trained, folder / "run"))
    spoil(generator, run, folder.parent / "outside")
    ways = (
        lambda: mimoc.report(run, folder / "page.html"),
        lambda: mimoc.report(run, folder / "page.html"),
        lambda: read_training_run(run),
        lambda: policies.use(run / "policy.zip", env),
        lambda: mimoc.train(bundle, run, steps=STEPS, **SETTINGS),
        lambda: mimoc.train(bundle, run, steps=2 * STEPS, **SETTINGS),
        lambda: mimoc.train(bundle, run, steps=STEPS, force=True, **SETTINGS),
    )
    refused = None
    with patch.object(portrait, "portrait", _no_portrait):
        for _ in range(3):
            try:
                pick(generator, ways)()
            except MimocError as error:
                refused = error
    if refused:
        raise refused


def _no_portrait(*_: object, **__: object) -> None:
    """Stand for a portrait, which takes most of a report's time and is drawn of many bundles elsewhere."""
    raise RenderingError("no portrait is drawn here")


FUZZER = Fuzzer(
    name="trainings",
    about="folders of training runs, changed in settings, curves, checkpoints and links, used in every way",
    prepare=prepare,
    attempt=attempt,
    short=6,
)
