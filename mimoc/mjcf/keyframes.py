"""The poses of a body as MuJoCo's keyframes."""

from mimoc.body import BodyTree
from mimoc.body.poses import POSES, poses_of, resting_states
from mimoc.mjcf.scene import Keyframe


def keyframes(tree: BodyTree) -> tuple[Keyframe, ...]:
    """Return every pose of this body as a state that rests on the ground, z = 0."""
    return tuple(map(Keyframe, POSES, resting_states(tree, poses_of(tree))))
