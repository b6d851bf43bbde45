"""Reinforcement learning: resumable training, learning curves, evaluation, and trained policies.

Its names are imported when they are first used: settings, curves and folders of runs need no Stable-Baselines3.
"""

from typing import TYPE_CHECKING, Any

from mimoc.base.errors import MissingExtraError
from mimoc.base.lazy import names_of

if TYPE_CHECKING:
    from mimoc.training.agents import (
        load_agent as load_agent,
        torch_devices as torch_devices,
    )
    from mimoc.training.curve import Curve as Curve, CurvePoint as CurvePoint
    from mimoc.training.evaluation import evaluate as evaluate, load_policy as load_policy
    from mimoc.training.trainer import Training as Training, train as train
    from mimoc.training.vector_env import (
        InfantVecEnv as InfantVecEnv,
        growth_settings as growth_settings,
        monitored as monitored,
    )

_get, __dir__, __all__ = names_of(__name__)


def __getattr__(name: str) -> Any:
    """Return a name; raise a MissingExtraError if it needs Stable-Baselines3, which is not installed."""
    try:
        return _get(name)
    except ModuleNotFoundError as error:
        if error.name not in ("stable_baselines3", "torch"):
            raise
        raise MissingExtraError("stable_baselines3", "train") from None
