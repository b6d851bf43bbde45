"""Where the units of a spec meet those of a model: cm and ms become SI here and nowhere else."""

CM_PER_M = 100.0
MM_PER_CM = 10.0
GRAVITY_M_S2 = 9.81  # Gravitational acceleration in all scenes.
DAYS_PER_MONTH = 365.25 / 12  # As WHO's Child Growth Standards count months (30.4375 days).


def cm_to_m(length_cm: float) -> float:
    """Return a length in metres."""
    return length_cm / CM_PER_M


def m_to_cm(length_m: float) -> float:
    """Return a length in centimetres."""
    return length_m * CM_PER_M


def ms_to_s(time_ms: float) -> float:
    """Return a time in seconds."""
    return time_ms / 1000.0


def months_to_days(age_months: float) -> float:
    """Return an age in days, as WHO counts them."""
    return age_months * DAYS_PER_MONTH


def to_steps(time_ms: float, timestep_ms: float) -> int:
    """Return a time as whole physics steps, to nine digits; a ValueError names the nearest time that is."""
    steps = time_ms / timestep_ms
    if abs(steps - round(steps)) > 1e-6 + 1e-8 * steps:
        nearest_ms = round(steps) * timestep_ms
        raise ValueError(
            f"{time_ms:g} ms is {steps:.2f} steps of {timestep_ms:g} ms; the nearest that works is {nearest_ms:g} ms"
        )
    return round(steps)
