"""Recordings of points on infants who were filmed, and the formats in which they come."""

from mimoc.base.kinds import Kinds, MotionFormat

FORMATS = Kinds[MotionFormat]("format of recorded points", {})
"""Formats that recordings of points are read from, in the order in which they are tried."""
