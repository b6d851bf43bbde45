"""The program of docs/own_part.md runs as printed."""

import re
from pathlib import Path

import mimoc
from mimoc.anatomy.parts import PARTS
from mimoc.schema.composition import recompose

ROOT = Path(__file__).resolve().parents[2]


def test_the_tail_of_the_page_grows_moves_and_feels(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    (program,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "own_part.md").read_text("utf-8"), re.DOTALL)
    names: dict[str, object] = {}
    try:
        exec(program, names)
        env = names["env"]
        assert isinstance(env.unwrapped, mimoc.InfantEnv)
        assert float(capsys.readouterr().out.strip("[]\n")) < 0.05
        assert "robot:tail angle [rad]" in env.unwrapped.layout("proprioception")
        assert env.unwrapped.model.actuator("act:tail").gear[0] < 0.8
        env.close()
    finally:
        PARTS.remove("tail")
        recompose()
