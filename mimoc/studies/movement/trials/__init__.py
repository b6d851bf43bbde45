"""The trials of movement, each as an experiment in physics."""

from collections.abc import Mapping

from mimoc.studies.movement.trial import MovementTrial
from mimoc.studies.movement.trials.arm_lift import ARM_LIFT, ARM_PULL
from mimoc.studies.movement.trials.grip import GRIP
from mimoc.studies.movement.trials.kick import KICK
from mimoc.studies.movement.trials.kicking import LEG_WEIGHT, POSTURE, STEPPING
from mimoc.studies.movement.trials.pendulum import DAMPING, PENDULUM
from mimoc.studies.movement.trials.posture import AWAKE, FOLD, RECOIL, REST, SPEEDS
from mimoc.studies.movement.trials.reach import REACH
from mimoc.studies.movement.trials.roll import ROLL
from mimoc.studies.movement.trials.saccade import SACCADE

TRIALS: Mapping[str, MovementTrial] = {
    trial.name: trial
    for trial in (
        *(KICK, PENDULUM, DAMPING, RECOIL, ARM_LIFT, FOLD, REST, AWAKE, SACCADE, GRIP),
        *(STEPPING, LEG_WEIGHT, POSTURE, ARM_PULL, SPEEDS, REACH, ROLL),
    )
}
USUAL: tuple[str, ...] = tuple(trial.name for trial in TRIALS.values() if not trial.on_request)
