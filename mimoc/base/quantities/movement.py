"""The 21 measures of spontaneous movement that infants are compared by, of points on a real or a simulated infant.

All lengths are in lengths of the trunk, from the neck to the middle of the hips, in its own frame: they depend neither
on the size of the infant and its distance from the camera, nor on how it lies or travels.
"""

from mimoc.base.quantities.quantity import Quantity


def of_recording(name: str, label: str, unit: str, about: str, source: str | None = None) -> Quantity:
    """Return the quantity of a whole recording of points."""
    return Quantity(name, label, unit, about, over="recording", steps=(), source=source)


_ENDS: tuple[tuple[str, str, str, str, str | None], ...] = (
    (
        "{0}_speed_median_trunk_s",
        "speed, median",
        "trunk/s",
        "median speed over frames and both sides: length of the central difference of the position in the frame of the"
        " trunk, times frames per second",
        None,
    ),
    ("{0}_speed_p95_trunk_s", "speed, 95th percentile", "trunk/s", "95th percentile over frames and both sides", None),
    ("{0}_moving_share", "share of time in motion", "", "share of frames of both sides faster than .25 trunk/s", None),
    (
        "{0}_spread_trunk",
        "spread",
        "trunk",
        "square root of the sum of the variances of the position across and along the trunk; mean of both sides",
        None,
    ),
    (
        "{0}_sample_entropy_nats",
        "sample entropy of speed",
        "nats",
        "unpredictability of the speed, standardised, at 10 Hz: -ln(A / B), where B pairs of 2 successive values differ"
        " by less than .2, and A of these also in the next value; mean of both sides",
        "Richman & Moorman 2000, Am J Physiol 278: H2039",
    ),
    ("{0}_burstiness", "burstiness", "", "excess kurtosis of the speed; mean of both sides", None),
    (
        "{0}_frequency_hz",
        "frequency, median",
        "Hz",
        "frequency below which half of the power of the velocity lies; Welch's spectra (Hann windows of 8.5 s,"
        " overlapping by half), summed over both sides and both axes",
        "Welch 1967, IEEE Trans Audio Electroacoust 15: 70",
    ),
    ("{1}_together_r", "speeds of left and right", "", "Pearson correlation of the speeds of left and right", None),
    (
        "{0}_units_per_min",
        "movement units",
        "1/min",
        "maxima of the speed of at least .25 trunk/s, with a prominence of at least .125 trunk/s; mean of both sides",
        None,
    ),
)
"""Name, label, unit, definition and source of what is measured of both hands and of both feet."""

KICKS = of_recording(
    "kicks_per_min",
    "Leg: kicks",
    "1/min",
    "maxima of the distance from hip to foot with a prominence of at least .25 trunk; mean of both legs",
)
HAND_FOOT_TOGETHER = of_recording(
    "hand_foot_together_r",
    "Hand and foot: speeds of one side",
    "",
    "Pearson correlation of the speeds of hand and foot of the same side; mean of both sides",
)
DIMENSIONS = of_recording(
    "dimensions",
    "Body: dimensions of movement",
    "",
    "participation ratio (sum of l)^2 / (sum of l^2) of the eigenvalues l of the covariance of the 16 coordinates of"
    " hands, elbows, feet and knees",
)


def _of_both(part: str, parts: str) -> list[Quantity]:
    return [
        of_recording(name.format(part, parts), f"{_title(name, part, parts)}: {label}", unit, about, source)
        for name, label, unit, about, source in _ENDS
    ]


def _title(name: str, part: str, parts: str) -> str:
    return (parts if "{1}" in name else part).capitalize()


CORE = (*_of_both("hand", "hands"), *_of_both("foot", "feet"), KICKS, HAND_FOOT_TOGETHER, DIMENSIONS)
"""The 21 measures, in the order in which they are computed."""
