"""PyArrow, which only those have who record."""

from typing import Any

from mimoc.errors import MissingExtraError

try:
    import pyarrow
    import pyarrow.parquet
except ImportError:
    raise MissingExtraError("pyarrow", "record") from None

pa: Any = pyarrow
pq: Any = pyarrow.parquet
