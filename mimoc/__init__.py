"""mimoc compiles simulated infants: from a YAML spec to plain MuJoCo XML and a Gymnasium environment."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from mimoc.base import interruption

if interruption.is_command():
    interruption.quit_at_once()  # Before anything is imported that takes time.

from mimoc.base.errors import RenderingError, problem_of_loading_mujoco
from mimoc.registration import register_envs, register_formatters
from mimoc.version import __version__

if TYPE_CHECKING:
    from mimoc.base.errors import MimocError
    from mimoc.bundle.io import Bundle, read_bundle, write_bundle
    from mimoc.cohorts import Cohort, read_cohort
    from mimoc.compiler.loading import load_spec
    from mimoc.compiler.pipeline import build
    from mimoc.control import Gains, GazeTask, InverseDynamics, OrientationTask, PositionTask, Posture
    from mimoc.environments import make
    from mimoc.plugins import register
    from mimoc.recording import record
    from mimoc.recording.export import export_recording
    from mimoc.recording.reading import read_recording
    from mimoc.recording.recorder import Recorder
    from mimoc.recordings import replay_recording
    from mimoc.reporting import report
    from mimoc.runtime.env import InfantEnv
    from mimoc.runtime.growth_schedule import growth_schedule
    from mimoc.runtime.growth_wrapper import GrowthWrapper
    from mimoc.runtime.limits import torque_limits
    from mimoc.runtime.term import Term
    from mimoc.schema.infant import InfantSpec
    from mimoc.studies.experiments import run_experiment
    from mimoc.studies.milestones import validate_milestones
    from mimoc.tasks.task import Judgement, Task, Verdict
    from mimoc.training import evaluate, load_policy, train
    from mimoc.vector_environments import make_vec, sb3_vec_env
    from mimoc.viewer.viewing import View, view

_HOMES = {
    "OrientationTask": "mimoc.control",
    "Bundle": "mimoc.bundle.io",
    "Gains": "mimoc.control",
    "Cohort": "mimoc.cohorts",
    "GrowthWrapper": "mimoc.runtime.growth_wrapper",
    "InfantEnv": "mimoc.runtime.env",
    "InfantSpec": "mimoc.schema.infant",
    "InverseDynamics": "mimoc.control",
    "Judgement": "mimoc.tasks.task",
    "GazeTask": "mimoc.control",
    "MimocError": "mimoc.base.errors",
    "Posture": "mimoc.control",
    "PositionTask": "mimoc.control",
    "Recorder": "mimoc.recording.recorder",
    "Task": "mimoc.tasks.task",
    "Term": "mimoc.runtime.term",
    "Verdict": "mimoc.tasks.task",
    "View": "mimoc.viewer.viewing",
    "build": "mimoc.compiler.pipeline",
    "evaluate": "mimoc.training",
    "export_recording": "mimoc.recording.export",
    "growth_schedule": "mimoc.runtime.growth_schedule",
    "load_policy": "mimoc.training",
    "load_spec": "mimoc.compiler.loading",
    "make": "mimoc.environments",
    "make_vec": "mimoc.vector_environments",
    "read_bundle": "mimoc.bundle.io",
    "read_cohort": "mimoc.cohorts",
    "read_recording": "mimoc.recording.reading",
    "record": "mimoc.recording",
    "register": "mimoc.plugins",
    "replay_recording": "mimoc.recordings",
    "report": "mimoc.reporting",
    "run_experiment": "mimoc.studies.experiments",
    "sb3_vec_env": "mimoc.vector_environments",
    "torque_limits": "mimoc.runtime.limits",
    "train": "mimoc.training",
    "validate_milestones": "mimoc.studies.milestones",
    "view": "mimoc.viewer.viewing",
    "write_bundle": "mimoc.bundle.io",
}
"""Where each public name lives: they are imported when first used, so that each command loads only what it needs."""

__all__ = [
    "OrientationTask",
    "Bundle",
    "Cohort",
    "Gains",
    "GrowthWrapper",
    "InfantEnv",
    "InfantSpec",
    "InverseDynamics",
    "Judgement",
    "GazeTask",
    "MimocError",
    "Posture",
    "PositionTask",
    "Recorder",
    "Task",
    "Term",
    "Verdict",
    "View",
    "__version__",
    "build",
    "evaluate",
    "export_recording",
    "growth_schedule",
    "load_policy",
    "load_spec",
    "make",
    "make_vec",
    "read_bundle",
    "read_cohort",
    "read_recording",
    "record",
    "register",
    "replay_recording",
    "report",
    "run_experiment",
    "sb3_vec_env",
    "torque_limits",
    "train",
    "validate_milestones",
    "view",
    "write_bundle",
]

register_envs()
register_formatters()


def __getattr__(name: str) -> Any:
    """Import a public name from its home."""
    if name not in _HOMES:
        raise AttributeError(f"module 'mimoc' has no attribute '{name}'")
    try:
        return getattr(import_module(_HOMES[name]), name)
    except Exception as error:
        if not (problem := problem_of_loading_mujoco(error)):
            raise
        raise RenderingError(problem) from None


def __dir__() -> list[str]:
    """Return the public names, also those not imported yet."""
    return __all__
