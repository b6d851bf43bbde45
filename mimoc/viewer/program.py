"""The program of pages and what belongs to it: files beside this module, some of them built by `make viewer`."""

from importlib import resources

from mimoc.errors import MimocError

FOLDER = resources.files("mimoc.viewer")


def source(name: str) -> str:
    """Return a text that goes into pages as it is."""
    return (FOLDER / "source" / name).read_text(encoding="utf-8")


def built(name: str) -> bytes:
    """Return a file that `make viewer` builds.

    Raises:
        MimocError: If it is missing.
    """
    try:
        return (FOLDER / "built" / name).read_bytes()
    except FileNotFoundError:
        raise MimocError(f"mimoc/viewer/built/{name} is missing; in a checkout, `make viewer` builds it") from None
