"""Recording of videos, and of all that infants do and sense."""

from mimoc.recording.record import film_of, record
from mimoc.recording.video import check_video

__all__ = ["check_video", "film_of", "record"]
