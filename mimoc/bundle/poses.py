"""Poses: the keyframes of a bundle that an infant can be put into."""

from mimoc.bundle.manifest import Manifest
from mimoc.errors import UnknownNameError


def pose_of(manifest: Manifest, pose: str | None) -> str:
    """Return a pose that a bundle has, or its own if none is named.

    Raises:
        UnknownNameError: If it has no such pose.
    """
    if pose is None or pose in manifest.poses:
        return pose or manifest.pose
    kept = manifest.constraints.locks or manifest.constraints.welds
    raise UnknownNameError("pose with what is held or locked in place" if kept else "pose", str(pose), manifest.poses)
