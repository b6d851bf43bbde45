"""Formats that recordings are exported to."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import ExporterKind

EARLIER = "recording"
"""The format of this version itself, to which those of earlier versions are converted."""
_OWN = (
    ExporterKind("minari", "needs `mimoc[minari]`", "mimoc.recording.exporters.minari", is_uniform=True),
    ExporterKind("lerobot", "version 3", "mimoc.recording.exporters.lerobot", is_uniform=True),
    ExporterKind("mjlab", "motions for its tracking tasks", "mimoc.recording.exporters.mjlab"),
    ExporterKind("csv", "tidy tables of text", "mimoc.recording.exporters.csv_tables"),
    ExporterKind("parquet", "the same tables", "mimoc.recording.exporters.parquet_tables"),
    ExporterKind(EARLIER, "converts one that an older mimoc made", "mimoc.recording.exporters.earlier"),
)
EXPORTERS = Kinds[ExporterKind]("format of recordings", {kind.name: kind for kind in _OWN})
