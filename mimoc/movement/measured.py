"""All measures of movement of one recording."""

from mimoc.base.classes import takes
from mimoc.motion.point_recording import PointRecording
from mimoc.movement.details import details_of
from mimoc.movement.joints import joint_measures
from mimoc.movement.measures import core_of
from mimoc.movement.trunk_frame import trunk_paths


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
