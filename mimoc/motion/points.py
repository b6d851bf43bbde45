"""Names of the points of a body that cameras, markers and pose estimators see, and what connects them."""

SIDES = "left", "right"
ON_SIDES = (
    *("eye", "ear", "shoulder", "elbow", "wrist", "hand", "hip", "knee", "ankle", "foot"),
    *("heel", "big_toe", "small_toe"),
)
"""On both sides, with `left_` or `right_` before: `hand` is the knuckle of the middle finger, `foot` the root of the
toes, which MINI-RGBD's body model calls hand and foot."""
MIDDLE = "head", "nose", "neck", "mid_hip"
"""`head` lies within the skull, above its centre, where MINI-RGBD's body model has its joint."""
POINTS = (*MIDDLE, *(f"{side}_{name}" for side in SIDES for name in ON_SIDES))
"""The names of all points that mimoc knows."""
MINI_RGBD_POINTS = (
    *("head", "neck"),
    *(f"{side}_{name}" for side in SIDES for name in ("shoulder", "elbow", "hand", "hip", "knee", "foot")),
)
"""The points of MINI-RGBD that the measures of movement are defined on: two in the middle, six on each side."""
_LIMBS = ("shoulder", "elbow", "wrist", "hand"), ("hip", "knee", "ankle", "foot")
BONES = (
    *(("neck", "head"), ("neck", "nose"), ("neck", "mid_hip")),
    *(
        bone
        for side in SIDES
        for arm_or_leg in _LIMBS
        for bone in (
            ("neck", f"{side}_{arm_or_leg[0]}"),
            *zip(*([f"{side}_{name}" for name in names] for names in (arm_or_leg, arm_or_leg[1:])), strict=False),
            *zip(*([f"{side}_{name}" for name in names] for names in (arm_or_leg[1:2], arm_or_leg[3:])), strict=True),
        )
    ),
)
"""Pairs of points that a stick figure connects, where both are known; a hand without a wrist hangs on its elbow."""
