"""The page on an actuation model of one's own works as it is printed, on one infant and on a device."""

import re
from pathlib import Path

import pytest
from support.devices import DEVICE

from mimoc.schema.components.actuation import ACTUATIONS
from mimoc.schema.composition import recompose

PAGE = Path(__file__).resolve().parents[3] / "docs" / "own_actuation.md"


@pytest.fixture
def forgotten():
    yield
    ACTUATIONS.remove("dead_zone")
    recompose()


def test_the_programs_of_the_page_do_what_they_say(forgotten, capsys):
    programs = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    session: dict[str, object] = {}
    for program in programs:
        exec(program.replace("warp:cpu", DEVICE), session)
    printed = [float(line) for line in capsys.readouterr().out.splitlines() if re.fullmatch(r"[0-9.]+", line)]
    assert printed == pytest.approx([0.5, 0.5])
