"""Gymnasium's names for mimoc's environments."""

from gymnasium.envs.registration import register, registry

ENTRY_POINTS = {"mimoc/Infant-v0": "mimoc.runtime.env:InfantEnv"}


def register_envs() -> None:
    """Tell Gymnasium of mimoc's environments; calling it again changes nothing."""
    for name, entry_point in ENTRY_POINTS.items():
        if name not in registry:
            register(id=name, entry_point=entry_point)
