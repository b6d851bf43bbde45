"""What BabyBench's configuration says and a spec does not."""

from mimoc.errors import suggestion
from mimoc.importers.settings import Settings, plain
from mimoc.schema.key_paths import shown

WHERE = "say where results go when you run something: mimoc train OUT -o DIR"
HOW_OFTEN = "say how often when you train: mimoc train --help"
HOW_LARGE = "say how large when you draw: mimoc render OUT -o FILE.png --width PX --height PX"
REASONS = {
    "save_dir": WHERE,
    "log_dir": WHERE,
    "save_logs_every": HOW_OFTEN,
    "save_every": HOW_OFTEN,
    "render_size": HOW_LARGE,
    "render_width": HOW_LARGE,
    "render_height": HOW_LARGE,
    "vision_stereo": "both eyes always see; leave 'eye_left' or 'eye_right' of the observation aside",
}
"""What to do about each key."""
KNOWN = (
    *REASONS,
    *("actuation_model", "behavior", "frame_skip", "max_episode_steps", "position", "proprioception", "scene", "seed"),
    *("touch", "touch_function", "touch_response", "touch_scale", "vestibular", "vision", "vision_resolution"),
)
"""Names to think of for one that is unknown."""
NO_BEHAVIOR = {"none", "custom"}


def note_the_rest(settings: Settings) -> None:
    """Note what nothing has been made of."""
    behavior = settings.find("behavior", "behaviour")
    if behavior and (word := plain(settings.value(behavior))) not in NO_BEHAVIOR:
        message = f"mimoc gives no reward for '{shown(word)}'; add yours with a Gymnasium wrapper"
        settings.note(behavior, f"no counterpart; {message}")
    for key in settings.left_over():
        settings.note(key, f"no counterpart; {_reason(key)}")


def _reason(key: str) -> str:
    if key in REASONS:
        return REASONS[key]
    near = suggestion(key[:80], KNOWN)
    return f"unknown here; {near}" if near.startswith("did you mean") else "unknown here"
