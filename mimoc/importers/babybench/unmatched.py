"""Notes on settings of BabyBench that have no counterpart in a spec."""

from mimoc.errors import suggestion
from mimoc.importers.settings import Settings, plain
from mimoc.schema.base import shown

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
"""What to do instead, by key."""
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
        settings.note(key, f"no counterpart; {_advice(key)}")


def _advice(key: str) -> str:
    if key in ADVICE:
        return ADVICE[key]
    similar = suggestion(key[:80], KNOWN)
    return f"unknown key; {similar}" if similar.startswith("did you mean") else "unknown key"
