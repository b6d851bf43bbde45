"""Infants as environments of Stable-Baselines3 and rsl_rl, to learn from with any of their algorithms."""

import warnings
from typing import TYPE_CHECKING, Any, cast

from gymnasium.vector import AutoresetMode, VectorEnv

from mimoc.base.classes import check_class
from mimoc.base.errors import MimocError
from mimoc.runtime import opening
from mimoc.runtime.batch_env import BatchEnv
from mimoc.runtime.vector_opening import Sources, listed, make_vec
from mimoc.runtime.world_env import WorldEnv

if TYPE_CHECKING:  # They need Stable-Baselines3 and MuJoCo Warp, which not everyone has.
    from mimoc.runtime.device.vector_env import DeviceEnv
    from mimoc.training.rsl_rl_env import InfantRslEnv
    from mimoc.training.vector_env import InfantVecEnv, VecMonitor


def sb3_vec_env(source: Sources, num_envs: int | None = None, **options: Any) -> "VecMonitor":
    """Return many infants as an environment of Stable-Baselines3, to learn from with its `PPO` or any other.

    Its `VecMonitor` adds the return and the length of each episode to the last `info`, which Stable-Baselines3 logs as
    `ep_rew_mean` and `ep_len_mean`. Episodes that nothing ends are a warning: they would never be logged.

    Args:
        source: As for `make_vec`.
        num_envs: Likewise.
        options: Others of `make_vec`, but for `autoreset_mode`: Stable-Baselines3 wants a reset in the same step.

    Raises:
        MissingExtraError: If Stable-Baselines3 is not installed.
        MimocError: As `make_vec` does.

    Example:
        >>> import mimoc
        >>> from stable_baselines3 import PPO
        >>> envs = mimoc.sb3_vec_env("reach.yaml", num_envs=2)
        >>> learner = PPO("MultiInputPolicy", envs, n_steps=8, batch_size=16)
        >>> learner.learn(16).num_timesteps
        16
        >>> envs.close()
    """
    from mimoc.training import monitored

    if options.get("device", "cpu") != "cpu":
        raise MimocError("Stable-Baselines3 learns from infants on the CPU; leave out device")
    infants: Any = make_vec(source, num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **options)
    if "max_episode_steps" not in options and None in infants.get_attr("max_steps"):
        warnings.warn(
            "nothing ends the episodes of these infants, so that Stable-Baselines3 logs no returns; give "
            "max_episode_steps, such as max_episode_steps=500",
            stacklevel=2,
        )
    return monitored(infants)


def rsl_rl_env(
    source: "Sources | DeviceEnv", num_envs: int | None = None, device: str = "cuda:0", seed: int = 0, **options: Any
) -> "InfantRslEnv":
    """Return many infants on a device as an environment of rsl_rl, to learn from with its `OnPolicyRunner`.

    Its observations have one group, `policy`: all that an infant observes, in the order of sorted names. An infant
    whose episode ends is reset in the same step.

    Args:
        source: As for `make_vec`, or what `make_vec` returned with `arrays="torch"` and `autoreset_mode="SameStep"`.
        num_envs: Number of infants; by default, as many as sources.
        device: As for `make_vec`, but for `cpu`: `cuda:0`, say, or `warp:cpu` to try it out.
        seed: Infant i begins with the start of seed + i.
        options: Others of `make_vec` on a device, such as `task` and `max_episode_steps`.

    Raises:
        MissingExtraError: If MuJoCo Warp or rsl_rl is not installed.
        MimocError: If the infants see images, or are on the CPU; and as `make_vec` does.

    Example:
        >>> import mimoc
        >>> env = mimoc.rsl_rl_env("reach.yaml", num_envs=2, device="warp:cpu", max_episode_steps=100)
        >>> env.get_observations()["policy"].shape[0], env.num_envs, env.max_episode_length
        (2, 2, 100)
        >>> env.close()
    """
    if device == "cpu":
        raise MimocError("rsl_rl learns from infants on a device; give device='cuda:0', or 'warp:cpu' to try it out")
    if not isinstance(source, VectorEnv):
        for infant in listed(source):
            opening.check_source("rsl_rl_env", infant)
    from mimoc.runtime.device.arrays import only_warnings
    from mimoc.training.rsl_rl_env import InfantRslEnv

    with only_warnings():
        if not isinstance(source, VectorEnv):
            fixed: dict[str, Any] = {"arrays": "torch", "autoreset_mode": AutoresetMode.SAME_STEP}
            made: Any = make_vec(source, num_envs, device=device, **fixed, **options)
            return InfantRslEnv(made, seed)
        return InfantRslEnv(cast("DeviceEnv", source), seed)


def world_vec_env(*worlds: WorldEnv) -> "InfantVecEnv":
    """Return the infants of one world or several as an environment of Stable-Baselines3: all learn one policy.

    Each infant is a row, so all must observe and command the same. When the episode of any infant ends, those of the
    others in its world are truncated, and its world is reset in the same step.

    Args:
        worlds: What `make_parallel` returns; they are closed with it.

    Raises:
        MissingExtraError: If Stable-Baselines3 is not installed.
        BatchMismatchError: If infants do not observe and command the same.
        TypeError: If it gets anything else.

    Example:
        >>> import mimoc
        >>> from stable_baselines3 import PPO
        >>> anna = mimoc.load_spec("nine_months.yaml")
        >>> envs = mimoc.world_vec_env(mimoc.make_parallel({"anna": anna, "ben": anna}))
        >>> PPO("MultiInputPolicy", envs, n_steps=8, batch_size=16).learn(16).num_timesteps
        16
        >>> envs.close()
    """
    from mimoc.training import InfantVecEnv

    for world in worlds:
        check_class("world_vec_env", world, "what mimoc.make_parallel returns", WorldEnv)
    openers = [lambda world=world: world for world in worlds]
    return InfantVecEnv(BatchEnv(openers, autoreset_mode=AutoresetMode.SAME_STEP))
