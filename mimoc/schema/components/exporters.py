"""Formats that recordings are exported to."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import ExporterKind

_OWN = (
    ExporterKind("minari", "needs `mimoc[minari]`", "mimoc.recording.exporters.minari", is_uniform=True),
    ExporterKind("lerobot", "version 3", "mimoc.recording.exporters.lerobot", is_uniform=True),
    ExporterKind("mjlab", "motions for its tracking tasks", "mimoc.recording.exporters.mjlab"),
    ExporterKind("csv", "tidy tables of text", "mimoc.recording.exporters.csv_tables"),
    ExporterKind("parquet", "the same tables", "mimoc.recording.exporters.parquet_tables"),
)
EXPORTERS = Kinds[ExporterKind]("format of recordings", {kind.name: kind for kind in _OWN})
