"""What an infant must have to learn, and after how many control steps its episodes end."""

import warnings
from typing import cast

from gymnasium.spaces import Dict

from mimoc.errors import TrainingError
from mimoc.runtime.env import InfantEnv
from mimoc.units import ms_to_s

MIN_IMAGE_PX = 36
"""Smallest image that Stable-Baselines3's convolutional network accepts."""
STEPS_PER_EPISODE = 500
"""Control steps of an episode that neither the caller nor the task limits: 5 s, with control steps of 10 ms."""
NOTHING = "nothing"
"""The observation of an infant without senses."""


def check_learnable(infant: InfantEnv) -> None:
    """Check that an infant can be trained.

    Raises:
        TrainingError: If it observes nothing, its images are too small, or its action is empty.
    """
    manifest, space = infant.manifest, cast("Dict", infant.observation_space)
    if not any(actuator.commanded for actuator in manifest.actuation.actuators):
        raise TrainingError("this infant has no commanded actuators to train; name some in actuation.regions")
    if [*space] == [NOTHING]:
        raise TrainingError(
            f"'{manifest.name}' observes nothing to learn from; give its spec a sense, such as senses: "
            "{proprioception: {}}"
        )
    vision = manifest.senses.vision
    if vision and min(vision.width_px, vision.height_px) < MIN_IMAGE_PX:
        size = f"{vision.width_px} x {vision.height_px}"
        raise TrainingError(f"images of {size} px are too small to learn from; give at least {MIN_IMAGE_PX} px")


def episode_limit(infant: InfantEnv, chosen: int | None) -> int:
    """Return after how many control steps the episodes of a training end: as was chosen, or as the task says.

    If neither says it, it is STEPS_PER_EPISODE, with a warning.

    Args:
        infant: An infant with its task.
        chosen: The number that the caller has chosen, if any.

    Raises:
        TrainingError: If the task ends episodes before that.
    """
    of_task = infant.max_steps
    if of_task is None and chosen is None:
        duration_s = ms_to_s(STEPS_PER_EPISODE * infant.manifest.step_ms)
        warnings.warn(
            f"the task of '{infant.manifest.name}' does not limit its episodes: this training ends them after "
            f"{STEPS_PER_EPISODE} control steps ({duration_s:g} s); choose another number with steps_per_episode",
            stacklevel=3,
        )
        return STEPS_PER_EPISODE
    if of_task is not None and chosen is not None and chosen > of_task:
        raise TrainingError(
            f"steps_per_episode: the task ends episodes after {of_task} control steps; give at most as many, or change "
            "the steps of the task"
        )
    return chosen or of_task or STEPS_PER_EPISODE
