"""Whether the simulation of an infant stays stable, as `mimoc check` finds."""

from collections.abc import Callable

from mimoc.bundle.io import Bundle
from mimoc.quantities.stability import BEYOND_LIMITS, ENERGY
from mimoc.reporting import words
from mimoc.reporting.page import Cell, Section, Text, number, table
from mimoc.runtime.check import CHECKED_S, MAX_BEYOND_DEG, MAX_ENERGY_J_PER_KG, PoseCheck, check_stability

ABOUT = (
    "From each pose, {seconds:g} s of random commands and {seconds:g} s of commands that drive all joints to and fro "
    "at full strength. A simulation is stable if MuJoCo gives no warning, the kinetic energy stays below {energy:g} J "
    "per kg, and joints go no more than {beyond:g}° beyond their soft limits."
)
SKIPPED = "Not checked for this page. mimoc check does it."


def stability(bundle: Bundle, progress: Callable[[int], None]) -> Section:
    """Return the section on the stability of an infant; *progress* is told how many poses are checked."""
    checks: list[PoseCheck] = []
    for check in check_stability(bundle):
        checks.append(check)
        progress(len(checks))
    about = ABOUT.format(seconds=CHECKED_S, energy=MAX_ENERGY_J_PER_KG, beyond=MAX_BEYOND_DEG)
    headings = ("pose", "result", "warnings", ENERGY.heading, BEYOND_LIMITS.heading, "")
    return Section("stability", "Stability", (Text(about), table(headings, map(_row, checks))))


def unchecked() -> Section:
    """Return the section on the stability of an infant that was not checked."""
    return Section("stability", "Stability", (Text(SKIPPED, "note"),))


def _row(check: PoseCheck) -> tuple[Cell, ...]:
    return (
        Cell(words.sentence(check.pose)),
        Cell("stable", "good") if check.passed else Cell("not stable", "bad"),
        Cell(", ".join(check.warnings) or "none"),
        number(words.figure(check.energy_j_per_kg, 2)),
        number(f"{check.beyond_deg:.0f}"),
        Cell(words.name(check.joint.removeprefix("robot:"))),
    )
