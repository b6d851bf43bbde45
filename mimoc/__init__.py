"""mimoc compiles simulated infants: from a YAML spec to plain MuJoCo XML and a Gymnasium environment."""

import sys
from typing import TYPE_CHECKING

from mimoc.base import interruption

if interruption.is_command():
    interruption.quit_at_once()  # Before anything is imported that takes time.

from mimoc.base.lazy import names_of, when_imported

if TYPE_CHECKING:
    from mimoc.base.errors import MimocError as MimocError
    from mimoc.bundle.io import Bundle as Bundle, read_bundle as read_bundle, write_bundle as write_bundle
    from mimoc.bundle.world import WorldBundle as WorldBundle, read_world_bundle as read_world_bundle
    from mimoc.compiler.building import build as build
    from mimoc.compiler.worlds import build_world as build_world
    from mimoc.components.companions.caregiver import Caregiver as Caregiver
    from mimoc.motion.point_recording import Camera as Camera, PointRecording as PointRecording
    from mimoc.motion.reading import read_points as read_points, write_points as write_points
    from mimoc.movement.measured import measure_movement as measure_movement
    from mimoc.movement.retargeting.folder import (
        read_retargeted as read_retargeted,
        write_retargeted as write_retargeted,
    )
    from mimoc.movement.retargeting.retarget import retarget as retarget
    from mimoc.policies.control.inverse_dynamics import InverseDynamics as InverseDynamics
    from mimoc.policies.control.objectives import (
        Gains as Gains,
        GazeTask as GazeTask,
        OrientationTask as OrientationTask,
        PositionTask as PositionTask,
        Posture as Posture,
    )
    from mimoc.policies.many import policy_vec as policy_vec
    from mimoc.recording.exporters import export_recording as export_recording
    from mimoc.recording.measures import (
        contacts_and_gaze as contacts_and_gaze,
        measure_recordings as measure_recordings,
    )
    from mimoc.recording.reading import read_recording as read_recording
    from mimoc.recording.record import record as record
    from mimoc.recording.recorder import Recorder as Recorder
    from mimoc.recording.replaying import replay_recording as replay_recording
    from mimoc.runtime.actuation import torque_limits as torque_limits
    from mimoc.runtime.companion import Companion as Companion
    from mimoc.runtime.env import InfantEnv as InfantEnv
    from mimoc.runtime.growth_wrapper import GrowthWrapper as GrowthWrapper, growth_schedule as growth_schedule
    from mimoc.runtime.opening import make as make, make_parallel as make_parallel
    from mimoc.runtime.task import Judgement as Judgement, Task as Task, Verdict as Verdict
    from mimoc.runtime.term import Term as Term
    from mimoc.runtime.vector_opening import make_vec as make_vec
    from mimoc.schema.infant import InfantSpec as InfantSpec, load_spec as load_spec
    from mimoc.schema.plugins import register as register
    from mimoc.studies.bench import run_bench as run_bench, verify_bench as verify_bench
    from mimoc.studies.cohorts.cohort import Cohort as Cohort, read_cohort as read_cohort
    from mimoc.studies.experiment import run_experiment as run_experiment
    from mimoc.studies.milestones import validate_milestones as validate_milestones
    from mimoc.studies.movement import validate_movement as validate_movement
    from mimoc.studies.reporting import report as report
    from mimoc.training import evaluate as evaluate, train as train
    from mimoc.training.evaluation import load_policy as load_policy
    from mimoc.training.opening import (
        rsl_rl_env as rsl_rl_env,
        sb3_vec_env as sb3_vec_env,
        world_vec_env as world_vec_env,
    )
    from mimoc.version import __version__ as __version__
    from mimoc.viewer.viewing import View as View, view as view

# The names imported above under TYPE_CHECKING, each imported when first used.
__getattr__, __dir__, __all__ = names_of(__name__)


def _register_envs() -> None:
    from mimoc.runtime import register_envs

    register_envs()


when_imported("gymnasium.envs.registration", _register_envs)
if "IPython" in sys.modules:
    from mimoc.viewer.formatters import register_formatters

    register_formatters()
