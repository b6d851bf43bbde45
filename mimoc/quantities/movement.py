"""Measures of spontaneous movement, of points on a real or a simulated infant.

All lengths are in lengths of the trunk, from the neck to the middle of the hips, in its own frame: they depend neither
on the size of the infant and its distance from the camera, nor on how it lies or travels.
"""

from collections.abc import Iterator

from mimoc.quantities.quantity import Quantity

REFERENCE = "Hesse et al. 2018, ECCV workshops"
"""MINI-RGBD, whose 12 infants are the reference values of these measures."""


def of_movement(name: str, label: str, unit: str, about: str, source: str | None = None) -> Quantity:
    """Return the quantity of a whole recording of points."""
    return Quantity(name, label, unit, about, over="recording", steps=(), source=source)


def _of_ends(part: str, parts: str) -> Iterator[Quantity]:
    """Yield what is measured of both hands, and likewise of both feet."""
    label = part.capitalize()
    yield of_movement(
        f"{part}_speed_median_trunk_s",
        f"{label}: speed, median",
        "trunk/s",
        f"median speed of a {part}, over frames and both sides; "
        "speed is the length of the central difference of its position in the frame of the trunk",
    )
    yield of_movement(
        f"{part}_speed_p95_trunk_s",
        f"{label}: speed, 95th percentile",
        "trunk/s",
        f"95th percentile of the speed of a {part}, over frames and both sides",
    )
    yield of_movement(
        f"{part}_moving_share",
        f"{label}: moving",
        "",
        "share of the frames of both sides with a speed above .25 trunk/s",
    )
    yield of_movement(
        f"{part}_spread_trunk",
        f"{label}: spread",
        "trunk",
        "square root of the sum of the variances of its position across and along the trunk; mean of both sides",
    )
    yield of_movement(
        f"{part}_sample_entropy_nats",
        f"{label}: sample entropy",
        "nats",
        "sample entropy of the speed at 10 Hz, standardised: -ln of the share of pairs of 2 values within .2 of each "
        "other that also are with the next value; mean of both sides",
        "Richman & Moorman 2000, Am J Physiol 278: H2039",
    )
    yield of_movement(
        f"{part}_burstiness", f"{label}: burstiness", "", "excess kurtosis of the speed; mean of both sides"
    )
    yield of_movement(
        f"{part}_frequency_hz",
        f"{label}: frequency, median",
        "Hz",
        "frequency below which half of the power of the velocity lies: Welch's spectrum (Hann windows of 8.5 s that "
        "overlap by half) summed over both sides and axes",
        "Welch 1967, IEEE Trans Audio Electroacoust 15: 70",
    )
    yield of_movement(
        f"{parts}_together_r",
        f"{parts.capitalize()} together",
        "",
        "Pearson correlation of the speeds of left and right",
    )
    yield of_movement(
        f"{part}_units_per_min",
        f"{label}: movement units",
        "1/min",
        "maxima of the speed of at least .25 trunk/s and a prominence of at least .125 trunk/s; mean of both sides",
    )


KICKS = of_movement(
    "kicks_per_min",
    "Kicks of a leg",
    "1/min",
    "maxima of the distance from hip to foot with a prominence of at least .25 trunk; mean of both legs",
)
HAND_FOOT_TOGETHER = of_movement(
    "hand_foot_together_r",
    "Hand and foot together",
    "",
    "Pearson correlation of the speeds of hand and foot of the same side; mean of both sides",
)
DIMENSIONS = of_movement(
    "dimensions",
    "Dimensions of the movement",
    "",
    "participation ratio (sum of l)^2 / sum of l^2 of the eigenvalues l of the covariance of the 16 coordinates of "
    "hands, elbows, feet and knees",
)
CORE = (*_of_ends("hand", "hands"), *_of_ends("foot", "feet"), KICKS, HAND_FOOT_TOGETHER, DIMENSIONS)
"""The 21 measures that a distance from a sample of infants is computed from."""
MOVEMENT = CORE
