"""What a user can say of a recording of points that is read."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from mimoc.motion.point_recording import Camera

View = Literal["front", "back", "mirrored", "swapped"]
VIEWS: tuple[View, ...] = get_args(View)
Up = Literal["x", "y", "z", "-x", "-y", "-z"]
UPS: tuple[Up, ...] = get_args(Up)


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """What the files do not say, or say wrongly."""

    rate_hz: float | None = None
    """Frames per second; None if the files say it."""
    camera: Camera | None = None
    """The camera of pixels; None if the files say it, or nobody knows."""
    infant: int | str | None = None
    """Which of several persons is the infant: its identity in the files or, where they have none, its number in the
    first frame with several, from 0. None is the largest."""
    names: Mapping[str, str] = field(default_factory=dict)
    """Mimoc's names by the labels of the files, for those that it does not know or gets wrong."""
    view: View | None = "front"
    """What the camera sees of an infant: its `front`; its `back` where it lies on its belly; `mirrored` if the picture
    is, or y counts upwards; `swapped` if left and right are exchanged. None is for points that were checked before."""
    min_score: float | None = None
    """Confidence below which a point is taken not to be seen; None is what the format's own programs go by."""

    picture_px: tuple[int, int] | None = None
    """Width and height of the picture, for points that are shares of it; None if the camera says it, or the files."""
    up: Up | None = None
    """Which axis of places in space points upwards; None is z, where the format does not say it."""

    def least_score(self, usual: float) -> float:
        """Return the confidence below which a point is taken not to be seen, by what is usual in a format."""
        return usual if self.min_score is None else self.min_score
