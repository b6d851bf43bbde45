"""JSON that pose estimators write, a file for each frame or one for all."""

from collections.abc import Iterator, Sequence
from typing import Any

from pydantic_core import from_json

from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.frame_files import FrameFiles


def parse_frames(files: FrameFiles) -> Iterator[tuple[int, str, Any]]:
    """Yield index in time, name and data of each file; an UnusableFileError says which is damaged."""
    for place, name, content in zip(files.places, files.names, files.contents, strict=True):
        yield place, name, parse(content, name)


def parse(content: bytes, name: str = "") -> Any:
    """Return the data of a file; an UnusableFileError says where it is damaged."""
    try:
        return from_json(content)
    except ValueError as error:
        where = f"{one_line(name)}: " if name else ""
        raise UnusableFileError(f"{where}is damaged JSON ({one_line(str(error))}); export it again") from None


def objects(data: Any, where: str, key: str = "") -> Sequence[dict[str, Any]]:
    """Return a list of JSON objects, or what is one under a key of an object, or raise an UnusableFileError."""
    items = data.get(key) if key and isinstance(data, dict) else data
    if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
        what = f"no list '{key}' of persons" if key else "no list of persons"
        raise UnusableFileError(f"{one_line(where)}: {what}; export it again, or give another format")
    return items
