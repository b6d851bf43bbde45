"""mimoc compiles simulated infants: from a YAML spec to plain MuJoCo XML and a Gymnasium environment."""

from typing import TYPE_CHECKING

from mimoc.base import interruption

if interruption.is_command():
    interruption.quit_at_once()  # Before anything is imported that takes time.

from mimoc.base.lazy import names_of
from mimoc.registration import register_envs, register_formatters

if TYPE_CHECKING:
    from mimoc.base.errors import MimocError as MimocError
    from mimoc.bundle.io import Bundle as Bundle, read_bundle as read_bundle, write_bundle as write_bundle
    from mimoc.bundle.world import WorldBundle as WorldBundle, read_world_bundle as read_world_bundle
    from mimoc.cohorts import Cohort as Cohort, read_cohort as read_cohort
    from mimoc.companions.caregiver.run import Caregiver as Caregiver
    from mimoc.companions.companion import Companion as Companion
    from mimoc.compiler.loading import load_spec as load_spec
    from mimoc.compiler.pipeline import build as build
    from mimoc.compiler.worlds import build_world as build_world
    from mimoc.control import (
        Gains as Gains,
        GazeTask as GazeTask,
        InverseDynamics as InverseDynamics,
        OrientationTask as OrientationTask,
        PositionTask as PositionTask,
        Posture as Posture,
    )
    from mimoc.environments import make as make
    from mimoc.motion.point_recording import Camera as Camera, PointRecording as PointRecording
    from mimoc.motion.reading import read_points as read_points
    from mimoc.motion.writing import write_points as write_points
    from mimoc.movement import measure_movement as measure_movement
    from mimoc.parallel import make_parallel as make_parallel, world_vec_env as world_vec_env
    from mimoc.plugins import register as register
    from mimoc.policies.many import policy_vec as policy_vec
    from mimoc.recording import record as record
    from mimoc.recording.between import contacts_and_gaze as contacts_and_gaze
    from mimoc.recording.export import export_recording as export_recording
    from mimoc.recording.measures import measure_recordings as measure_recordings
    from mimoc.recording.reading import read_recording as read_recording
    from mimoc.recording.wrappers import Recorder as Recorder
    from mimoc.recordings import replay_recording as replay_recording
    from mimoc.reporting import report as report
    from mimoc.retargeting.folder import read_retargeted as read_retargeted, write_retargeted as write_retargeted
    from mimoc.retargeting.retarget import retarget as retarget
    from mimoc.runtime.env import InfantEnv as InfantEnv
    from mimoc.runtime.growth_schedule import growth_schedule as growth_schedule
    from mimoc.runtime.growth_wrapper import GrowthWrapper as GrowthWrapper
    from mimoc.runtime.limits import torque_limits as torque_limits
    from mimoc.runtime.term import Term as Term
    from mimoc.schema.infant import InfantSpec as InfantSpec
    from mimoc.studies.bench.running import run_bench as run_bench, verify_bench as verify_bench
    from mimoc.studies.experiments import run_experiment as run_experiment
    from mimoc.studies.milestones import validate_milestones as validate_milestones
    from mimoc.studies.movement import validate_movement as validate_movement
    from mimoc.tasks.judgement import Judgement as Judgement, Verdict as Verdict
    from mimoc.tasks.task import Task as Task
    from mimoc.training import evaluate as evaluate, train as train
    from mimoc.training.loading import load_policy as load_policy
    from mimoc.vector_environments import make_vec as make_vec, rsl_rl_env as rsl_rl_env, sb3_vec_env as sb3_vec_env
    from mimoc.version import __version__ as __version__
    from mimoc.viewer.viewing import View as View, view as view

__getattr__, __dir__, __all__ = names_of(__name__)

register_envs()
register_formatters()
