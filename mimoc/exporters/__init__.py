"""Formats that recordings are exported to."""

from mimoc.base.kinds import ExporterKind, Kinds

_OWN = (
    ExporterKind("minari", "needs `mimoc[minari]`", "mimoc.exporters.minari", is_uniform=True),
    ExporterKind("lerobot", "version 3", "mimoc.exporters.lerobot", is_uniform=True),
    ExporterKind("mjlab", "motions for its tracking tasks", "mimoc.exporters.mjlab"),
    ExporterKind("csv", "tidy tables of text", "mimoc.exporters.csv_tables"),
    ExporterKind("parquet", "the same tables", "mimoc.exporters.parquet_tables"),
)
EXPORTERS = Kinds[ExporterKind]("format of recordings", {kind.name: kind for kind in _OWN})
