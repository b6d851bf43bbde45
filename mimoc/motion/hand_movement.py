"""Movements of a hand, and how many units they have, how straight and how smooth they are."""

from dataclasses import dataclass

import numpy as np

from mimoc.motion.point_recording import FloatArray, low_passed

MIN_STEPS = 8  # Minimum number of positions for a measure of smoothness; jerk is not meaningful for fewer.
MAX_HZ = 10.0
MIN_MAGNITUDE = 0.05
PADDING = 4
"""Parameters of the spectral arc length: cut-off frequency, threshold of the magnitude, and number of powers of two by
which the speed is zero-padded (Balasubramanian et al. 2015)."""

UNIT_M_S = 0.05
"""Change of speed that counts as an acceleration or a deceleration: chosen here, to leave out ripples that a video of
infants, whose hands move at .2 to .4 m/s, would not show."""


@dataclass(frozen=True, slots=True)
class Movement:
    """A movement of a hand."""

    path_m: FloatArray  # Positions of the hand at regular intervals, shape (n, 3), world frame.
    step_s: float  # Interval between positions, such as a control step.

    @property
    def duration_s(self) -> float:
        """Time from onset to the end."""
        return (len(self.path_m) - 1) * self.step_s

    @property
    def speed_m_s(self) -> FloatArray:
        """Speed of the hand in each interval, shape (n - 1,)."""
        return np.linalg.norm(np.diff(self.path_m, axis=0), axis=1) / self.step_s

    @property
    def units(self) -> int:
        """Number of movement units: an acceleration, and the deceleration that follows (von Hofsten 1979).

        A deceleration at the end, at which a target is hit, is not needed to complete the last unit.
        """
        count, is_rising, turned = 0, False, 0.0
        for speed in self.speed_m_s.tolist():
            turned = max(turned, speed) if is_rising else min(turned, speed)
            if abs(speed - turned) >= UNIT_M_S:
                is_rising, turned = not is_rising, speed
                count += is_rising
        return count

    @property
    def path_ratio(self) -> float:
        """Length of the path by the straight distance from its start to its end."""
        length_m = np.linalg.norm(np.diff(self.path_m, axis=0), axis=1).sum()
        return float(length_m / np.linalg.norm(self.path_m[-1] - self.path_m[0]))

    @property
    def jerk(self) -> float:
        """Log dimensionless jerk, which is larger for smoother movements; NaN without motion.

        -ln(T³ / v² x the integral of squared jerk over the duration T), where v is the peak speed. It is independent of
        the size and the duration of a movement; a minimum-jerk movement has -ln(720 / 1.875²) = -5.32 (Hogan & Sternad
        2009).
        """
        velocity = np.diff(self.path_m, axis=0) / self.step_s
        if len(self.path_m) < MIN_STEPS or not (peak := np.linalg.norm(velocity, axis=1).max()):
            return float("nan")
        jerk = np.diff(velocity, n=2, axis=0) / self.step_s**2
        return float(-np.log(self.duration_s**3 / peak**2 * (jerk**2).sum() * self.step_s))

    @property
    def arc_length(self) -> float:
        """Spectral arc length, which is larger for smoother movements; NaN without motion.

        The negative arc length of the normalised magnitude spectrum of the speed (SPARC; Balasubramanian et al. 2015).
        """
        speed = self.speed_m_s
        if len(self.path_m) < MIN_STEPS or not speed.any():
            return float("nan")
        size = 2 ** (int(np.ceil(np.log2(len(speed)))) + PADDING)
        frequencies_hz = np.fft.rfftfreq(size, self.step_s)
        magnitudes = np.abs(np.fft.rfft(speed, size))
        magnitudes /= magnitudes.max()
        above = np.flatnonzero((frequencies_hz <= MAX_HZ) & (magnitudes >= MIN_MAGNITUDE))
        band = slice(above[0], above[-1] + 1)
        width_hz = frequencies_hz[above[-1]] - frequencies_hz[above[0]]
        return float(-np.hypot(np.diff(frequencies_hz[band]) / width_hz, np.diff(magnitudes[band])).sum())


def movement_of(path_m: FloatArray, step_s: float) -> Movement:
    """Return the movement of a hand in a path, shape (n, 3), from when it is first faster than `UNIT_M_S`.

    What is faster than 6 Hz is left out, as of all measures of movement.
    """
    smooth_m = low_passed(path_m, 1 / step_s)
    speeds = np.linalg.norm(np.diff(smooth_m, axis=0), axis=1) / step_s
    onset = int(np.argmax(speeds > UNIT_M_S)) if len(speeds) else 0
    return Movement(smooth_m[onset:], step_s)
