"""Units of length and time, by the words that files have for them."""

import re

_METRES = {
    1.0: "m metre meter mtr",
    0.1: "dm decimetre decimeter",
    0.01: "cm centimetre centimeter",
    0.001: "mm millimetre millimeter",
    1e-6: "um µm μm micrometre micrometer micron",
    0.0254: "in inch inche",
    0.3048: "ft foot feet",
}
_SECONDS = {
    1.0: "s sec second",
    1e-3: "ms msec milli millisec millisecond",
    1e-6: "us µs μs usec micro microsec microsecond",
    1e-9: "ns nsec nano nanosec nanosecond",
}
LENGTHS = "mm, cm, dm, m, in, ft"
_SHORTEST_PLURAL = 3
"""Letters: `cms` are centimetres, `ms` are no metres."""
_LENGTHS_BY_WORD, _TIMES_BY_WORD = (
    {word: size for size, words in sizes.items() for word in words.split()} for sizes in (_METRES, _SECONDS)
)


def metres_in(unit: str) -> float | None:
    """Return how many metres a unit is, such as .001 of `Millimeters` or `[mm]`; None if it is no unit of length."""
    return _find(unit, _LENGTHS_BY_WORD)


def seconds_in(unit: str) -> float | None:
    """Return how many seconds a unit is, such as .001 of `ms`; None if it is no unit of time."""
    return _find(unit, _TIMES_BY_WORD)


def _find(unit: str, sizes: dict[str, float]) -> float | None:
    word = re.sub("[^a-zµμ]", "", unit.lower())
    single = word.removesuffix("s") if len(word) >= _SHORTEST_PLURAL else word
    return sizes.get(word, sizes.get(single))
