"""BabyBench's actuation: actuation model, actuated regions and locked regions."""

from typing import Any

from mimoc.importers.babybench.regions import (
    SINGLE_GROUPS,
    enabled_groups,
    named,
    note_coarser_groups,
    switches,
)
from mimoc.importers.babybench.scene import scene_locks
from mimoc.importers.settings import Settings

MODELS = {
    "spring_damper": "torque",
    "torque": "torque",
    "muscle": "muscle",
    "muscles": "muscle",
    "position": "position",
    "positional": "position",
}
"""The actuation model of mimoc by its name in BabyBench, MIMo or mimoc."""


ORDER = "the action is ordered by limb in mimoc and by region in BabyBench"
COMMANDS = {
    "torque": "",
    "muscle": "; the two muscles of a joint are adjacent in it, where BabyBench has all muscles of one direction first",
    "position": "; its range is -1 to 1 for the range of each joint, where BabyBench uses angles in radians",
}
"""Further differences in the action, by mimoc's actuation model."""


def read_actuation(settings: Settings) -> dict[str, Any]:
    """Return the section `actuation` of a spec, without mimoc's defaults."""
    key = settings.find("actuation_model", "actuation")
    model = settings.choice(key, meanings=MODELS) if key else None
    if key and model:
        settings.note(key, f"{ORDER}{COMMANDS[model]}")
    locking, acting = switches(settings, "lock_"), switches(settings, "act_")
    by_scene = scene_locks(settings)
    locked = enabled_groups(locking, default=False, merge=all) | by_scene
    acts = enabled_groups(acting, default=True, merge=any)
    note_coarser_groups(settings, locking, locked, {True: "which is locked", False: "which is not locked"})
    note_coarser_groups(settings, acting, acts, {True: "which is actuated", False: "which is not actuated"})
    for switch in acting:
        if switch.on and locked & set(switch.region.groups):
            groups = " and ".join(named(locked & set(switch.region.groups)))
            settings.note(
                switch.key, f"true has no counterpart; '{groups}' is locked, and locked joints are not actuated"
            )
    section: dict[str, Any] = {"model": model} if model else {}
    if acts - locked != set(SINGLE_GROUPS) - locked:
        section["regions"] = named(acts - locked)
    if locked:
        section["locked"] = named(locked)
    return section
