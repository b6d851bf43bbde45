"""Conversion of BabyBench configurations; BabyBench is a competition based on MIMo, whose body is 18 months old.

The keys are those of the BabyBench 2025 starter kit and likely variants of them.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from mimoc.base.errors import suggestion
from mimoc.compat.import_babybench.scene import read_actuation, read_body, read_control, read_scene, read_task
from mimoc.compat.import_babybench.senses import read_senses
from mimoc.compat.settings import MIMO_AGE_MONTHS, Imported, Settings, infant_name, plain
from mimoc.schema.base import shown
from mimoc.schema.source import FileKind, read

FOLDER = "set the output folder when you train: mimoc train OUT -o DIR"
INTERVAL = "set the interval when you train: mimoc train OUT -o DIR --checkpoint-every STEPS"
SIZE = "set the size when you render: mimoc render OUT -o FILE.png --width PX --height PX"
ADVICE = {
    "save_dir": FOLDER,
    "log_dir": FOLDER,
    "save_logs_every": INTERVAL,
    "save_every": INTERVAL,
    "render_size": SIZE,
    "render_width": SIZE,
    "render_height": SIZE,
    "vision_stereo": "both eyes are always observed; ignore 'eye_left' or 'eye_right' in the observation",
}
KNOWN = (
    *ADVICE,
    *("actuation_model", "behavior", "frame_skip", "max_episode_steps", "position", "proprioception", "scene", "seed"),
    *("touch", "touch_function", "touch_response", "touch_scale", "vestibular", "vision", "vision_resolution"),
)
"""Keys to suggest for an unknown key."""
NO_BEHAVIOR = {"none", "custom"}


def note_unmatched(settings: Settings) -> None:
    """Add a note for each key that has not been converted."""
    behavior = settings.find("behavior", "behaviour")
    if behavior and (word := plain(settings.value(behavior))) not in NO_BEHAVIOR:
        message = f"mimoc has no reward for '{shown(word)}'; write yours as a task (docs/own_reward.md)"
        settings.note(behavior, f"no counterpart; {message}")
    for key in settings.unread_keys():
        similar = suggestion(key[:80], KNOWN)
        advice = f"unknown key; {similar}" if similar.startswith("did you mean") else "unknown key"
        settings.note(key, f"no counterpart; {ADVICE.get(key, advice)}")


CONFIGURATION = FileKind("configuration", "behavior, scene and actuation_model", "scene: base")
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
    """Convert a BabyBench configuration, a flat YAML file, into a spec; raise a SpecError with all problems.

    Missing keys have the defaults of BabyBench's examples: all regions are actuated and have skin, nothing is locked,
    and all senses except proprioception are off.
    """
    source = read(path, CONFIGURATION)
    settings = Settings(source)
    age_months = settings.number("age_months", "age", low=0, high=MAX_AGE_MONTHS)
    head = {
        "mimoc": 1,
        "name": infant_name(Path(path).stem, DEFAULT_NAME),
        "age_months": MIMO_AGE_MONTHS if age_months is None else age_months,
        "development": "published",
    }
    sections = {name: read_section(settings) for name, read_section in SECTIONS.items()}
    note_unmatched(settings)
    said = {name: section for name, section in sections.items() if section}
    return Imported("BabyBench", source.file, head | said, settings.notes())
