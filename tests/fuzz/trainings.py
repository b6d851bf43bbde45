"""Folders of training runs that are changed by chance, and used: reported on, resumed, and acted by."""

from collections.abc import Iterable
from pathlib import Path
from shutil import copytree
from typing import Any
from unittest.mock import patch

import numpy as np
from fuzz import cohorts, policies
from fuzz.cohorts import Way
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import pick, spoil

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.studies.reporting import infant
from mimoc.training.run_folder import read_training_run

SETTINGS = {"envs": 2, "checkpoint_every": 64, "hyper": policies.TINY}
STEPS = 64
Prepared = tuple[Path, mimoc.Bundle, Any]


def prepare(folder: Path) -> Prepared:
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(policies.SPEC))
    mimoc.train(bundle, folder / "run", steps=STEPS, **SETTINGS)
    return folder / "run", bundle, mimoc.InfantEnv(bundle)


def attempt(prepared: Prepared, generator: np.random.Generator, folder: Path) -> None:
    run = copied(prepared, folder)
    spoil(generator, run, folder.parent / "outside")
    known = ways(prepared, run)
    use(pick(generator, known) for _ in range(3))


def copied(prepared: Prepared, folder: Path) -> Path:
    return Path(copytree(prepared[0], folder / "run"))


def ways(prepared: Prepared, run: Path) -> tuple[Way, ...]:
    _, bundle, env = prepared
    return (
        lambda: mimoc.report(run, run.parent / "page.html"),
        lambda: read_training_run(run),
        lambda: policies.use(run / "policy.zip", env),
        lambda: mimoc.train(bundle, run, steps=STEPS, **SETTINGS),
        lambda: mimoc.train(bundle, run, steps=2 * STEPS, **SETTINGS),
        lambda: mimoc.train(bundle, run, steps=STEPS, force=True, **SETTINGS),
    )


def use(chosen: Iterable[Way]) -> None:
    with patch.object(infant, "portrait", _no_portrait):
        cohorts.use(chosen)


def _no_portrait(*_: object, **__: object) -> None:
    """Stand for a portrait, which takes most of a report's time and is drawn of many bundles elsewhere."""
    raise RenderingError("no portrait is drawn here")


FUZZER = Fuzzer(prepare, attempt, short=12)
