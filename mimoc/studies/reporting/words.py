"""Numbers and names as readers know them."""

import math

from mimoc.render.drawing import MINUS

THIN_SPACE, TIMES, NOTHING = "\u202f", "\u00d7", "\u2013"
FEW, MANY = 3.0, 97.0  # Percentiles between which WHO's charts draw the usual range.
LOW, HIGH = 15.0, 85.0  # Percentiles between which 7 of 10 children are, the inner band of those charts.

COMPARED = {
    "length_cm": ("shorter", "short", "long"),
    "weight_kg": ("lighter", "light", "heavy"),
    "head_circumference_cm": ("smaller", "small", "large"),
    "arm_circumference_cm": ("thinner", "thin", "thick"),
}
"""The comparative for a child with less of each of WHO's indicators, and the words for little and much of it."""
CHILDREN = {"male": "boys", "female": "girls", None: "children"}


def figure(value: float, digits: int = 3) -> str:
    """Return a number with some significant digits, and never with an exponent that a reader need not see."""
    if not math.isfinite(value):
        return NOTHING
    if value == 0:
        return "0"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value)) + 1e-12))
    return f"{value:,.{min(decimals, 9)}f}".replace("-", MINUS) if abs(value) >= 1e-6 else f"{value:.{digits}g}"


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return a number with its unit."""
    return f"{figure(value, digits)}{THIN_SPACE}{unit}"


def torques(limits_nm: tuple[float, float]) -> str:
    """Return the peak torques of a joint in either direction."""
    low, high = (figure(abs(limit), 2) for limit in limits_nm)
    return f"{low if low == high else f'{low} / {high}'}{THIN_SPACE}N{THIN_SPACE}m"


def signed(value: float, decimals: int = 1) -> str:
    """Return a number with its sign."""
    return f"{round(value, decimals) + 0.0:+.{decimals}f}".replace("-", MINUS)


def age(age_months: float) -> str:
    """Return an age as it is said: `newborn`, `9 months`."""
    if age_months == 0:
        return "newborn"
    return "1 month" if age_months == 1 else f"{age_months:.4g} months"


def of_age(age_months: float) -> str:
    """Return the end of a phrase such as `girls of 9 months`."""
    return "at birth" if age_months == 0 else f"of {age(age_months)}"


def rank(indicator: str, percentile: float, sex: str | None, age_months: float) -> str:
    """Return where a child stands among others, in words: how many of a hundred have less."""
    less, little, much = COMPARED[indicator]
    verdict = "usual"
    if not LOW <= percentile <= HIGH:
        how = "rather" if FEW <= percentile <= MANY else "unusually"
        verdict = f"{how} {little if percentile < LOW else much}"
    share = "fewer than 1" if percentile < 1 else "more than 99" if percentile > 99 else f"about {percentile:.0f}"
    verb = "is" if share.endswith(" 1") else "are"
    return f"{verdict}: {share} of 100 {CHILDREN[sex]} {of_age(age_months)} {verb} {less}"


def name(identifier: str) -> str:
    """Return an identifier as words: `crown_rump_length` is `crown rump length`."""
    return " ".join(identifier.replace("_", " ").split())


def sentence(text: str) -> str:
    """Return a text that begins with a capital letter."""
    return text[:1].upper() + text[1:]


def listed(items: list[str]) -> str:
    """Return some things as a list in a sentence."""
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}" if items else "none"


def count(number: int, one: str, many: str = "") -> str:
    """Return how many of something there are: `1 job`, `3 jobs`."""
    return f"{number:,} {one if number == 1 else many or one + 's'}"
