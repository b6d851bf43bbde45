"""A spherical head: how long after its centre a sound reaches each ear, and how much of it.

    time    T(β) = -(r / c) cos β    up to β = 90°,    (r / c) (β - 90°)    beyond,

with the angle β between the direction of the source and that of the ear, so that the ears of a source at an azimuth θ
differ by Woodworth's (r / c) (θ + sin θ) (Woodworth 1938), at all frequencies. And

    level   H(f, β) = a + (1 - a) / √(1 + (f / f₀)²),    f₀ = c / (π r),
            a(β) = 1.05 + .95 cos(β 180° / 150°),

which is the filter with one pole and one zero of Brown & Duda (1998, IEEE Trans Speech Audio Process 6: 476), of whose
pole only the size is kept, as the times above already have what its phase would add. Differences of level between the
ears are within 5 dB of those of the sphere's diffraction (Duda & Martens 1998, J Acoust Soc Am 104: 3048) up to
k r = 8. Neither pinnae nor shoulders are there, and a source is as if it were far away, but for its distance from the
centre.
"""

import math
from typing import Any

import numpy as np

from mimoc.base.geometry.rotations import FloatArray

SOUND_M_S = 343.0
RADIUS_OF_ADULTS_M = 0.0875  # Radius of the sphere whose interaural times are those of adults (Woodworth 1938).
CIRCUMFERENCES = 0.964
"""Radius of the sphere in adults' circumferences / 2 π: 57 cm of adults. Derived; assumed of infants, too."""
MIN_SHARE, MIN_AT_RAD = 0.1, math.radians(150.0)  # Smallest a, and the angle where it is (Brown & Duda).


def head_radius_m(circumference_m: float) -> float:
    """Return the radius of the sphere of a head."""
    return CIRCUMFERENCES * circumference_m / (2 * math.pi)


def interaural_time_s(azimuth_rad: Any, radius_m: float) -> Any:
    """Return by how much earlier a sound is at the nearer ear, from an azimuth of 0 to 90°, by Woodworth's formula.

    Example:
        >>> import math
        >>> from mimoc.base.geometry.spherical_head import interaural_time_s
        >>> round(1e6 * interaural_time_s(math.radians(90), 0.0875))  # [µs], of an adult
        656
    """
    return radius_m / SOUND_M_S * (azimuth_rad + np.sin(azimuth_rad))


def ear_angles(directions: FloatArray) -> FloatArray:
    """Return angles between unit vectors (n, 3), x forward and y left, and the left and the right ear, shape (n, 2)."""
    cosines = np.stack([directions[:, 1], -directions[:, 1]], axis=1)
    return np.arccos(np.minimum(np.maximum(cosines, -1.0), 1.0))


def ear_delays_s(angles: FloatArray, radius_m: float) -> FloatArray:
    """Return how much later than at the centre of the head a sound is at the ears; negative is earlier."""
    times = np.where(angles < np.pi / 2, -np.cos(angles), angles - np.pi / 2)
    return radius_m / SOUND_M_S * times


def high_share(angles: FloatArray) -> FloatArray:
    """Return a(β): the amplitude of high frequencies at an ear, relative to the sound without a head."""
    return (1 + MIN_SHARE / 2) + (1 - MIN_SHARE / 2) * np.cos(angles * (np.pi / MIN_AT_RAD))


def low_part(frequency_hz: Any, radius_m: float) -> Any:
    """Return 1 / √(1 + (f / f₀)²): the share of a frequency that is in the part which passes every head alike."""
    corner_hz = SOUND_M_S / (math.pi * radius_m)
    return 1 / np.sqrt(1 + (np.asarray(frequency_hz) / corner_hz) ** 2)


def level_gain(frequency_hz: Any, angles: FloatArray, radius_m: float) -> Any:
    """Return H: the amplitude of a frequency at an ear, relative to the sound without a head."""
    high = high_share(angles)
    return high + (1 - high) * low_part(frequency_hz, radius_m)
