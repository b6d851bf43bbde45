"""Recording of videos."""

from mimoc.recording.record import filming, record
from mimoc.recording.video import check_video

__all__ = ["check_video", "filming", "record"]
