"""Measures of the smoothness of hand movements."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

MIN_STEPS = 8
"""Minimum number of positions for a measure of smoothness; jerk is not meaningful for fewer."""
MAX_HZ = 10.0
MIN_MAGNITUDE = 0.05
PADDING = 4
"""Parameters of the spectral arc length: cut-off frequency, threshold of the magnitude, and number of powers of two by
which the speed is zero-padded (Balasubramanian et al. 2015)."""

UNIT_M_S = 0.05
"""Change of speed that counts as an acceleration or a deceleration: chosen here, to leave out ripples that a video of
infants, whose hands move at .2 to .4 m/s, would not show."""


def movement_units(path_m: FloatArray, step_s: float, least_m_s: float = UNIT_M_S) -> int:
    """Return the number of movement units: an acceleration, and the deceleration that follows (von Hofsten 1979).

    A deceleration at the end, at which a target is hit, is not needed to complete the last unit.

    Args:
        path_m: Positions at regular intervals, shape (n, 3).
        step_s: Interval between positions.
        least_m_s: Change of speed below which neither is counted.
    """
    count, is_rising, turned = 0, False, 0.0
    for speed in (np.linalg.norm(np.diff(path_m, axis=0), axis=1) / step_s).tolist():
        turned = max(turned, speed) if is_rising else min(turned, speed)
        if abs(speed - turned) >= least_m_s:
            is_rising, turned = not is_rising, speed
            count += is_rising
    return count


def path_ratio(path_m: FloatArray) -> float:
    """Return the length of a path by the straight distance from its start to its end."""
    length_m = np.linalg.norm(np.diff(path_m, axis=0), axis=1).sum()
    return float(length_m / np.linalg.norm(path_m[-1] - path_m[0]))


def log_dimensionless_jerk(path_m: FloatArray, step_s: float) -> float:
    """Return the log dimensionless jerk of a movement, which is larger for smoother movements; NaN without motion.

    -ln(T³ / v² x the integral of squared jerk over the duration T), where v is the peak speed. It is independent of the
    size and the duration of a movement; a minimum-jerk movement has -ln(720 / 1.875²) = -5.32 (Hogan & Sternad 2009).

    Args:
        path_m: Positions at regular intervals, shape (n, 3).
        step_s: Interval between positions.
    """
    velocity = np.diff(path_m, axis=0) / step_s
    if len(path_m) < MIN_STEPS or not (peak := np.linalg.norm(velocity, axis=1).max()):
        return float("nan")
    jerk = np.diff(velocity, n=2, axis=0) / step_s**2
    duration_s = (len(path_m) - 1) * step_s
    return float(-np.log(duration_s**3 / peak**2 * (jerk**2).sum() * step_s))


def spectral_arc_length(path_m: FloatArray, step_s: float) -> float:
    """Return the spectral arc length of a movement, which is larger for smoother movements; NaN without motion.

    The negative arc length of the normalised magnitude spectrum of the speed (SPARC; Balasubramanian et al. 2015).

    Args:
        path_m: Positions at regular intervals, shape (n, 3).
        step_s: Interval between positions.
    """
    speed = np.linalg.norm(np.diff(path_m, axis=0), axis=1) / step_s
    if len(path_m) < MIN_STEPS or not speed.any():
        return float("nan")
    size = 2 ** (int(np.ceil(np.log2(len(speed)))) + PADDING)
    frequencies_hz, magnitudes = np.fft.rfftfreq(size, step_s), np.abs(np.fft.rfft(speed, size))
    magnitudes /= magnitudes.max()
    above = np.flatnonzero((frequencies_hz <= MAX_HZ) & (magnitudes >= MIN_MAGNITUDE))
    band = slice(above[0], above[-1] + 1)
    width_hz = frequencies_hz[above[-1]] - frequencies_hz[above[0]]
    return float(-np.hypot(np.diff(frequencies_hz[band]) / width_hz, np.diff(magnitudes[band])).sum())
