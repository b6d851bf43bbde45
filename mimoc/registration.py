"""Gymnasium's names for mimoc's environments."""

from gymnasium.envs.registration import register, registry

INFANT = "mimoc/Infant-v0"
TASKS = {
    "mimoc/Reach-v0": "reach",
    "mimoc/Standup-v0": "standup",
    "mimoc/Selfbody-v0": "selfbody",
    "mimoc/Catch-v0": "catch",
    "mimoc/Rollover-v0": "rollover",
    "mimoc/Free-v0": "free",
}
"""The task of each environment that is named after one."""


def register_envs() -> None:
    """Tell Gymnasium of mimoc's environments; calling it again changes nothing."""
    if INFANT not in registry:
        register(id=INFANT, entry_point="mimoc.runtime.env:InfantEnv")
    for name, kind in TASKS.items():
        if name not in registry:
            register(id=name, entry_point="mimoc.environments:make_task", kwargs={"kind": kind})
