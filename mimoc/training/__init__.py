"""Reinforcement learning: resumable training, learning curves, evaluation, and trained policies."""

from importlib import import_module

from mimoc.base.errors import MissingExtraError

try:
    import_module("stable_baselines3")
except ImportError:
    raise MissingExtraError("stable_baselines3", "train") from None

from mimoc.training.curve import Curve, CurvePoint
from mimoc.training.evaluation import Episode, evaluate
from mimoc.training.policies import TrainedPolicy, load_policy
from mimoc.training.trainer import Training, train

__all__ = ["Curve", "Episode", "CurvePoint", "TrainedPolicy", "Training", "evaluate", "load_policy", "train"]
