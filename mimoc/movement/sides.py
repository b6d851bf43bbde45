"""The measures of movement of one side: those that are of both, taken of left and right alone."""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.motion.points import SIDES
from mimoc.movement.details import details_of
from mimoc.movement.joints import joint_measures
from mimoc.movement.measures import core_of
from mimoc.movement.trunk_frame import TrunkPaths, trunk_paths

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
