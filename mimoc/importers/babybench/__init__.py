"""Conversion of BabyBench configurations; BabyBench is a competition based on MIMo, whose body is 18 months old.

The keys are those of the BabyBench 2025 starter kit and likely variants of them.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mimoc.importers.babybench.actuation import read_actuation
from mimoc.importers.babybench.scene import read_body, read_control, read_scene, read_task
from mimoc.importers.babybench.senses import read_senses
from mimoc.importers.babybench.unmatched import note_unmatched
from mimoc.importers.imported import Imported
from mimoc.importers.settings import Settings
from mimoc.schema.source import FileKind, read

CONFIGURATION = FileKind("configuration", "behavior, scene and actuation_model", "scene: base")
MIMO_AGE_MONTHS = 18
"""Age of MIMo's body (Mattern et al. 2024)."""
MAX_AGE_MONTHS = 24
DEFAULT_NAME = "babybench"

SECTIONS: dict[str, Callable[[Settings], dict[str, Any]]] = {
    "body": read_body,
    "actuation": read_actuation,
    "senses": read_senses,
    "scene": read_scene,
    "control": read_control,
    "task": read_task,
}
"""Function that returns each section of the spec; empty sections are left out."""


def import_babybench(path: str | Path) -> Imported:
    """Convert a BabyBench configuration into a spec.

    Missing keys have the defaults of BabyBench's examples: all regions are actuated and have skin, nothing is locked,
    and all senses except proprioception are off.

    Args:
        path: Path of a flat YAML file.

    Raises:
        SpecError: If the file cannot be read or has invalid values; the error lists all problems.
    """
    source = read(path, CONFIGURATION)
    settings = Settings(source)
    age_months = settings.number("age_months", "age", low=0, high=MAX_AGE_MONTHS)
    head = {
        "mimoc": 1,
        "name": _name(Path(path).stem),
        "age_months": MIMO_AGE_MONTHS if age_months is None else age_months,
        "development": "published",
    }
    sections = {name: read_section(settings) for name, read_section in SECTIONS.items()}
    note_unmatched(settings)
    said = {name: section for name, section in sections.items() if section}
    return Imported("BabyBench", source.file, head | said, settings.notes())


def _name(stem: str) -> str:
    """Return a name for the infant, derived from the name of the file."""
    name = re.sub("[^a-z0-9]+", "_", stem.lower()).strip("_")
    return (name if name[:1].isalpha() else f"{DEFAULT_NAME}_{name}")[:64].strip("_")
