"""The poses of a bundle: keyframes that an episode can start from."""

from mimoc.bundle.manifest import Manifest
from mimoc.errors import UnknownNameError


def pose_of(manifest: Manifest, pose: str | None) -> str:
    """Return the name of a pose, the bundle's default if *pose* is None.

    Raises:
        UnknownNameError: If the bundle has no such pose.
    """
    if pose is None or pose in manifest.poses:
        return pose or manifest.pose
    kept = manifest.constraints.locks or manifest.constraints.welds
    what = "pose for an infant with held bodies or locked joints" if kept else "pose"
    raise UnknownNameError(what, str(pose), manifest.poses)
