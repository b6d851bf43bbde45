"""Every training that README, the guides and the examples print gives a curve; `.ci/task trainings` runs longer."""

import os
import re
import shlex
from pathlib import Path

import pytest
from stable_baselines3 import PPO
from support.full import full_but

from mimoc.cli.commands import COMMANDS
from mimoc.training import Curve

CHECKOUT = Path(__file__).resolve().parents[1]
STEPS = int(os.environ.get("MIMOC_TRAINING_STEPS", "0"))  # Control steps of each; 0 is as few as an episode takes.
SHORT = ["--steps", "504", "--envs", "1", "--set", "n_steps=504", "--set", "batch_size=504", "--set", "n_epochs=1"]
PAGES = sorted(
    path
    for pattern in ("README.md", "docs/**/*.md", "examples/**/*.md", "examples/**/*.py", "containers/*.md")
    for path in CHECKOUT.glob(pattern)
)
INSTEAD = {"SPEC": "configs/reach.yaml", "RUN": "runs/run", "specs/reach_9.yaml": "configs/reach.yaml"}
"""What stands for the words that are to be replaced, and for a file that another command writes."""


def commands() -> dict[str, str]:
    """Return each `mimoc train` with arguments, by where it stands: in a block or within a line."""
    texts = {str(path.relative_to(CHECKOUT)): path.read_text(encoding="utf-8") for path in PAGES}
    texts["mimoc train --help"] = f"mimoc train {COMMANDS['train'][1]}"
    found = {}
    for name, text in texts.items():
        for match in re.finditer(r"mimoc train( [^`\n#]*-o [^`\n#]*)", text):
            found[f"{name}:{text.count(chr(10), 0, match.start()) + 1}"] = match[1]
    return found


def programs() -> dict[str, list[str]]:
    """Return the Python blocks of each page that trains in one of them, but for those that read what commands wrote."""
    found = {}
    for path in PAGES:
        blocks = re.findall(r"^```python\n(.*?)^```$", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        if any(".learn(" in block for block in blocks):
            found[str(path.relative_to(CHECKOUT))] = [block for block in blocks if "read_recording(" not in block]
    return found


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    """Return a working directory with the configs, and with the tasks of the guide in `my_tasks.py`."""
    (tmp_path / "configs").symlink_to(CHECKOUT / "configs")
    (tmp_path / "reach.yaml").symlink_to(CHECKOUT / "configs" / "reach.yaml")  # As `mimoc new` writes it.
    blocks = re.findall(r"^```python\n(.*?)^```$", (CHECKOUT / "docs" / "own_reward.md").read_text(), re.M | re.S)
    (tmp_path / "my_tasks.py").write_text(blocks[0].partition("\nenv = ")[0])
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_guides_print_trainings():
    pages = {name.rpartition(":")[0] for name in commands()}
    wanted = {"docs/training.md", "docs/own_reward.md", "docs/recording.md", "docs/growing.md", "mimoc train --help"}
    assert wanted <= pages
    assert "docs/many.md" in programs()


@pytest.mark.slow
@pytest.mark.parametrize("place", full_but([place for place in commands() if "growing" not in place], commands()))
def test_a_command_gives_a_curve(place, invoke, here):
    on_the_cpu = commands()[place].replace("--device cuda:0", "")
    arguments = [INSTEAD.get(word, word) for word in shlex.split(on_the_cpu)]
    length = ["--steps", str(STEPS)] if STEPS else SHORT
    done = invoke("train", *arguments, *length)
    assert done.code == 0, done.err
    curve = Curve.from_csv((here / arguments[arguments.index("-o") + 1] / "curve.csv").read_text())
    assert any(row.episodes or row.unfinished for row in curve.rows)
    if STEPS or "--steps-per-episode" in arguments:
        assert any(row.episodes for row in curve.rows)


@pytest.mark.slow
@pytest.mark.parametrize("page", programs())
def test_a_program_gives_a_curve(page, here, monkeypatch):
    learnt, learn = [], PPO.learn

    def longer(agent, steps, *rest, **options):
        learnt.append(agent)
        return learn(agent, STEPS or steps, *rest, **options)

    monkeypatch.setattr(PPO, "learn", longer)
    session: dict[str, object] = {}
    for block in programs()[page]:
        exec(block, session)
    assert learnt
    assert all(agent.env.episode_lengths.any() or agent.ep_info_buffer for agent in learnt)
    if STEPS:
        assert all(agent.ep_info_buffer for agent in learnt)
