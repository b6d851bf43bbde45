"""Recordings of points on infants who were filmed, and the formats in which they come."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import MotionFormat

_ABOUT = {
    "openpose": "folder of OpenPose's JSON, a file for each frame: BODY_25 or COCO-18",
    "mediapipe": "landmarks of MediaPipe, as shares of the picture or in metres: CSV or JSON",
    "coco": "JSON of COCO-17 keypoints: a folder of frames, or one file with all (MMPose, ViTPose, AlphaPose, YOLO)",
    "mini_rgbd": "folder of MINI-RGBD: 2D joints with depth, or 3D joints",
    "csv": "table of named points: wide, long, DeepLabCut's, or public keypoints of MINI-RGBD",
    "npz": "arrays, as mimoc writes them",
    "c3d": "markers of motion capture",
}
FORMATS = Kinds[MotionFormat](
    "format of recorded points",
    {
        name: MotionFormat(name, about, f"mimoc.motion.read_{name}", f"mimoc.motion.read_{name}")
        for name, about in _ABOUT.items()
    },
)
"""Formats that recordings of points are read from, in the order in which they are tried."""
