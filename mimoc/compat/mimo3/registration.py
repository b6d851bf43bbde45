"""MIMo3's ids of environments in Gymnasium's registry, whoever had them before."""

from typing import Any

from gymnasium.envs.registration import register, registry

from mimoc.base.errors import MimocError

ENVIRONMENTS = {
    "MIMoReach-v0": ("MIMoReachEnv", 1000),
    "MIMoStandup-v0": ("MIMoStandupEnv", 500),
    "MIMoSelfBody-v0": ("MIMoSelfBodyEnv", 500),
    "MIMoCatch-v0": ("MIMoCatchEnv", 800),
    "MIMoRollOver-v0": ("MIMoRollOverEnv", 500),
    "MIMoBench-v0": ("MIMoDummyEnv", 6000),
    "MIMoBenchV2-v0": ("MIMoV2DummyEnv", 6000),
    "MIMoMuscle-v0": ("MIMoMuscleDummyEnv", 6000),
}
"""The class of each id, and the control steps after which its episodes are truncated."""
ELSEWHERE = {
    "MIMoShowroom-v0": "a spec with 'scene: {kind: room, toys: {}}' as model_path of MIMoBenchV2-v0",
    **dict.fromkeys(
        (
            *("MIMoMuscleStaticTest-v0", "MIMoMuscleStaticTestV2-v0", "MIMoVelocityMuscleTest-v0"),
            *("MIMoVelocityMuscleTestV2-v0", "MIMoComplianceTest-v0", "MIMoComplianceMuscleTest-v0"),
        ),
        "`mimoc experiment strength` and `mimoc.torque_limits`, which measure motors and muscles",
    ),
}
"""Ids without a counterpart, and what to use instead."""


def register_ids() -> None:
    """Let MIMo3's ids be mimoc's from now on; those without a counterpart stay MIMo3's, if it has registered them."""
    for name, (environment, steps) in ENVIRONMENTS.items():
        registry.pop(name, None)
        register(name, f"mimoc.compat.mimo3:{environment}", max_episode_steps=steps)
    for name in ELSEWHERE:
        if name not in registry:
            register(name, "mimoc.compat.mimo3.registration:refuse", kwargs={"name": name})


def refuse(name: str, **keywords: Any) -> None:
    """Say what to use instead of an environment."""
    raise MimocError(f"{name} has no counterpart in mimoc; use {ELSEWHERE[name]}")
