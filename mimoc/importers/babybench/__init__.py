"""The configuration of BabyBench, a competition with MIMo for a body, as a spec.

Its keys are those of the BabyBench 2025 starter kit and their likely variants. Its body is MIMo's: 18 months old.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mimoc.importers.babybench.moving import read_actuation
from mimoc.importers.babybench.perceiving import read_senses
from mimoc.importers.babybench.remaining import note_the_rest
from mimoc.importers.babybench.world import read_body, read_control, read_scene, read_task
from mimoc.importers.imported import Imported
from mimoc.importers.settings import Settings
from mimoc.schema.source import FileKind, read

CONFIGURATION = FileKind("configuration", "behavior, scene and actuation_model", "scene: base")
MIMO_AGE_MONTHS = 18
"""Age of MIMo's body (Mattern et al. 2024)."""
MAX_AGE_MONTHS = 24
NAMED_BY_NOBODY = "babybench"

SECTIONS: dict[str, Callable[[Settings], dict[str, Any]]] = {
    "body": read_body,
    "actuation": read_actuation,
    "senses": read_senses,
    "scene": read_scene,
    "control": read_control,
    "task": read_task,
}
"""What reads each section of a spec; one that comes out empty is left out."""


def import_babybench(path: str | Path) -> Imported:
    """Return the spec that a configuration of BabyBench comes to.

    What a configuration leaves out is as in BabyBench's examples: a region takes commands and has skin, nothing is
    locked, and a sense is off of which nothing is said, but for proprioception.

    Args:
        path: A flat YAML file.

    Raises:
        SpecError: If it cannot be read, or holds values that its keys cannot have, with all of them.
    """
    source = read(path, CONFIGURATION)
    settings = Settings(source)
    age_months = settings.number("age_months", "age", low=0, high=MAX_AGE_MONTHS)
    head = {
        "mimoc": 1,
        "name": _name(Path(path).stem),
        "age_months": MIMO_AGE_MONTHS if age_months is None else age_months,
    }
    sections = {name: read_section(settings) for name, read_section in SECTIONS.items()}
    note_the_rest(settings)
    said = {name: section for name, section in sections.items() if section}
    return Imported("BabyBench", source.file, head | said, settings.notes())


def _name(stem: str) -> str:
    """Return the name of an infant that is called after a file."""
    name = re.sub("[^a-z0-9]+", "_", stem.lower()).strip("_")
    return (name if name[:1].isalpha() else f"{NAMED_BY_NOBODY}_{name}")[:64].strip("_")
