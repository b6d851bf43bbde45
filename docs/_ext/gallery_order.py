"""The order of the gallery: what is looked at first, then what is done with it."""

FIRST = ("ages", "percentiles", "strength", "growing", "rooms", "vision", "touch", "delays", "actuation", "reaching")


class GalleryOrder:
    """Sorts the files of programs."""

    def __init__(self, folder: str):
        """Sort the files in a folder, which need not be known."""

    def __call__(self, file: str) -> tuple[int, str]:
        """Return the key by which a file is sorted: its place, or the end for those not named."""
        name = file.removeprefix("plot_").removesuffix(".py")
        return FIRST.index(name) if name in FIRST else len(FIRST), name
