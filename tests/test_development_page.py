"""The tables and commands of docs/development.md."""

import re
import shlex
from pathlib import Path

import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.body.strength import STRENGTH
from mimoc.fits import measure

PAGE = (Path(__file__).resolve().parents[1] / "docs" / "development.md").read_text(encoding="utf-8")
ROWS = [[cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line.startswith("|")]
MONTHS = (0, 1, 2, 3, 4, 6, 9, 12, 18)


def row(start: str) -> list[str]:
    (found,) = [cells for cells in ROWS if cells[0].startswith(start)]
    return found


@pytest.mark.parametrize("group", sorted(STRENGTH.keys() - {"eyes"}))
def test_the_table_of_strength_is_that_of_the_law(group):
    _, newborn, tau, power, *shares = row(f"`{group}`")
    curve = STRENGTH[group]
    assert (float(newborn), float(tau), float(power)) == (curve.newborn, curve.decay.tau_months, curve.decay.power)
    assert shares == [f"{curve(age_months):.2f}" for age_months in (1, 2, 3, 4, 6, 9, 12, 15, 18)]


@pytest.mark.parametrize(
    ("start", "joint", "angle"),
    [
        ("hip, straightest", "hip1", lambda joint: joint.range_deg[1]),
        ("knee, straightest", "knee", lambda joint: joint.range_deg[1]),
        ("elbow, straightest", "elbow", lambda joint: joint.range_deg[1]),
        ("ankle, furthest up", "foot1", lambda joint: joint.range_deg[1]),
        ("ankle, furthest down", "foot1", lambda joint: joint.range_deg[0]),
        ("rest of the hip", "hip1", lambda joint: joint.springref_deg),
        ("rest of the knee", "knee", lambda joint: joint.springref_deg),
        ("rest of the elbow", "elbow", lambda joint: joint.springref_deg),
        ("rest of the fingers", "fingers", lambda joint: joint.springref_deg),
    ],
)
def test_the_table_of_joints_is_that_of_grown_infants(start, joint, angle):
    anatomy = assemble("mitten", chest_joint=False)
    grown = [angle(grow_tree(measure(age), anatomy).joints[f"robot:left_{joint}"]) for age in MONTHS]
    assert list(map(float, row(start)[1:])) == [pytest.approx(degrees, abs=0.51) for degrees in grown]


def test_every_explanation_names_the_law_and_says_how_certain_it_is(invoke, monkeypatch):
    monkeypatch.chdir(Path(__file__).resolve().parents[1])
    (block,) = re.findall(r"^```sh\n(mimoc explain .*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    for command in block.splitlines():
        code, printed, _ = invoke(*shlex.split(command)[1:])
        assert code == 0, command
        assert "the law `maturing`" in " ".join(printed.split())
        assert "D: derived for mimoc" in printed
