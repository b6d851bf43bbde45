"""All measures of movement of one recording."""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.base.classes import takes
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.details import details_of
from mimoc.movement.joints import joint_measures
from mimoc.movement.measures import TrunkPaths, core_of, trunk_paths

OF_NO_SIDE = ("hands_", "feet_", "legs_", "hips_", "limbs_", "kicks_together_", "centroid_", "dimensions")
"""How the names of measures begin that are about both sides together, or about all of the body."""


def measure_sides(recording: PointRecording, space: PointRecording | None = None) -> dict[str, dict[str, float]]:
    """Return the measures of each side alone, by `left` and `right` and by the name of their quantity.

    Where a measure is the mean of both sides, or over both, it is that of one here. Points are as for
    `measure_movement`, which raises the same errors, *space* the same in space, if they are known.
    """
    body = trunk_paths(recording)
    return {side: _of_side(body, space or recording, side) for side in SIDES}


def _of_side(body: TrunkPaths, space: PointRecording, side: str) -> dict[str, float]:
    # Points of one side in place of both: measures of both are then those of one.
    other = SIDES[1 - SIDES.index(side)]

    def of_one(points: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        return {name: points.get(name.replace(f"{other}_", f"{side}_"), path) for name, path in points.items()}

    alone = replace(body, paths=of_one(body.paths), velocities=of_one(body.velocities), speeds=of_one(body.speeds))
    values = {**core_of(alone), **details_of(alone), **joint_measures(space, (side,))}
    return {name: value for name, value in values.items() if not name.startswith(OF_NO_SIDE)}


@takes("a recording of points, from mimoc.read_points", PointRecording)
def measure_movement(recording: PointRecording) -> dict[str, float]:
    """Return the measures of movement of a recording, by the name of their quantity.

    The first 21 are those that infants are compared by. What needs points that it lacks (a face), or places in space
    (joint angles), or a kick, is left out. `mimoc.base.quantities.movement` and `movement_details` define them all.

    Raises:
        MovementError: If points are missing or never seen, or it is too slow or too short.

    Example:
        >>> import mimoc
        >>> from mimoc.motion.body_points import film
        >>> env = mimoc.make("nine_months.yaml").unwrapped
        >>> still = env.model.key("supine").qpos[None].repeat(300, axis=0)
        >>> mimoc.measure_movement(film(env.model, still, 30.0))["kicks_per_min"]
        0.0
    """
    body = trunk_paths(recording)
    return {**core_of(body), **details_of(body), **joint_measures(recording)}
