"""PyArrow, which only those have who record."""

from mimoc.errors import MissingExtraError

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError:
    raise MissingExtraError("pyarrow", "record") from None

__all__ = ["pa", "pq"]
