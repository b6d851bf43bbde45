"""How smoothly a hand moves."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

LEAST_STEPS = 8
"""Of a movement that has a smoothness: fewer have no jerk to speak of."""
HIGHEST_HZ = 10.0
LEAST_MAGNITUDE = 0.05
PADDING = 4
"""Of the spectral arc length: frequencies looked at, the magnitude below which the spectrum is over, and by how many
powers of two the speed is padded (Balasubramanian et al. 2015)."""


def log_dimensionless_jerk(path_m: FloatArray, step_s: float) -> float:
    """Return how smooth a movement is, the larger (the less negative) the smoother; NaN where nothing moves.

    -ln(T³ / v² x the integral of squared jerk over the duration T), where v is the peak speed: neither size nor
    duration of a movement changes it. A movement of minimum jerk has -ln(720 / 1.875²) = -5.32 (Hogan & Sternad 2009).

    Args:
        path_m: Places at even times, shape (n, 3).
        step_s: Between two of them.
    """
    velocity = np.diff(path_m, axis=0) / step_s
    if len(path_m) < LEAST_STEPS or not (peak := np.linalg.norm(velocity, axis=1).max()):
        return float("nan")
    jerk = np.diff(velocity, n=2, axis=0) / step_s**2
    duration_s = (len(path_m) - 1) * step_s
    return float(-np.log(duration_s**3 / peak**2 * (jerk**2).sum() * step_s))


def spectral_arc_length(path_m: FloatArray, step_s: float) -> float:
    """Return how smooth a movement is, the larger (the less negative) the smoother; NaN where nothing moves.

    The length of the curve that the spectrum of the speed makes, both axes scaled to one, with its sign turned
    (SPARC; Balasubramanian et al. 2015).

    Args:
        path_m: Places at even times, shape (n, 3).
        step_s: Between two of them.
    """
    speed = np.linalg.norm(np.diff(path_m, axis=0), axis=1) / step_s
    if len(path_m) < LEAST_STEPS or not speed.any():
        return float("nan")
    size = 2 ** (int(np.ceil(np.log2(len(speed)))) + PADDING)
    frequencies_hz, magnitudes = np.fft.rfftfreq(size, step_s), np.abs(np.fft.rfft(speed, size))
    magnitudes /= magnitudes.max()
    loud = np.flatnonzero((frequencies_hz <= HIGHEST_HZ) & (magnitudes >= LEAST_MAGNITUDE))
    heard = slice(loud[0], loud[-1] + 1)
    along, up = frequencies_hz[heard], magnitudes[heard]
    span_hz = along[-1] - along[0]
    return float(-np.hypot(np.diff(along) / span_hz, np.diff(up)).sum())
