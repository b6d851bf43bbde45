"""The checkers of environments of Gymnasium and Stable-Baselines3: neither finds fault."""

import warnings
from pathlib import Path

import gymnasium
from gymnasium.utils import env_checker
from stable_baselines3.common import env_checker as sb3_checker

import mimoc  # noqa: F401 (registers the environment)


def use(bundles: Path) -> str:
    names = [scene.parent.name for scene in sorted(bundles.glob("*/scene.xml"))]
    for name in names:
        env = gymnasium.make("mimoc/Infant-v0", bundle=bundles / name)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            env_checker.check_env(env.unwrapped, skip_render_check=True)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", message=".*(not flattened|image|symmetric|normalized).*")
            sb3_checker.check_env(env, skip_render_check=True)
        env.close()
    assert names
    return f"{len(names)} environments"
