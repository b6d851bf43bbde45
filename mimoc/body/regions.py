"""Names of parts of the body that the runtime needs: head, arms, legs and eyes (MIMo's)."""

from typing import Literal

Side = Literal["left", "right"]
Ends = tuple[str, str]
"""Names of two things, with `{side}`."""

HEAD = "head"
ARM: Ends = ("{side}_upper_arm", "{side}_hand")
"""First and last body; fingers are parts of the hand."""
LEG: Ends = ("{side}_upper_leg", "{side}_foot")
"""First and last body; toes are parts of the foot."""
EYE: Ends = ("{side}_eye", "eye_{side}")
"""Body and camera."""

LIMB_SIDES: tuple[Side, Side] = ("right", "left")
EYE_SIDES: tuple[Side, Side] = ("left", "right")
"""Sides in MIMo's order."""
