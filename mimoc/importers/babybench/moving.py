"""BabyBench's actuation: which model, which regions act, which are locked."""

from typing import Any

from mimoc.importers.babybench.regions import (
    SINGLE_GROUPS,
    named,
    note_what_is_coarser,
    switched_on,
    switches,
)
from mimoc.importers.babybench.world import scene_locks
from mimoc.importers.settings import Settings

MODELS = {
    "spring_damper": "torque",
    "torque": "torque",
    "muscle": "muscle",
    "muscles": "muscle",
    "position": "position",
    "positional": "position",
}
"""BabyBench's words, MIMo's and mimoc's own, with mimoc's."""


ORDER = "commands come limb by limb here and region by region in BabyBench"
COMMANDS = {
    "torque": "",
    "muscle": "; and the two muscles of a joint side by side, where BabyBench has all of one direction first",
    "position": "; and from -1 to 1 over the range of each joint, where BabyBench takes angles in radians",
}
"""What else differs in the commands, by mimoc's actuation model."""


def read_actuation(settings: Settings) -> dict[str, Any]:
    """Return the section `actuation` of a spec, empty where all of it is as mimoc has it anyway."""
    key = settings.find("actuation_model", "actuation")
    model = settings.choice(key, meanings=MODELS) if key else None
    if key and model:
        settings.note(key, f"{ORDER}{COMMANDS[model]}")
    locking, acting = switches(settings, "lock_"), switches(settings, "act_")
    by_scene = scene_locks(settings)
    locked = switched_on(locking, default=False, merge=all) | by_scene
    acts = switched_on(acting, default=True, merge=any)
    note_what_is_coarser(settings, locking, locked, {True: "which is locked", False: "which is not locked"})
    note_what_is_coarser(settings, acting, acts, {True: "which takes commands", False: "which takes none"})
    for switch in acting:
        if switch.on and locked & set(switch.region.groups):
            groups = " and ".join(named(locked & set(switch.region.groups)))
            settings.note(switch.key, f"true has no counterpart; '{groups}' is locked, and what is locked is not moved")
    found: dict[str, Any] = {"model": model} if model else {}
    if acts - locked != set(SINGLE_GROUPS) - locked:
        found["regions"] = named(acts - locked)
    if locked:
        found["locked"] = named(locked)
    return found
