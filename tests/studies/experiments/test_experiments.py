"""What holds of every experiment; each is made small."""

import re
import sys
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path

import pytest
from PIL import Image
from support.full import full_but

import mimoc
from mimoc.base.errors import MissingExtraError, OutputError, UnknownNameError
from mimoc.bundle.model import load_model
from mimoc.studies.experiment import Experiment, figures_of, find_experiment, run_experiment
from mimoc.studies.experiments import EXPERIMENTS
from mimoc.studies.experiments.delays import reaching
from mimoc.studies.experiments.inverse import sitting
from mimoc.studies.experiments.strength import lying

TRAIN = "mimoc.studies.experiments.learner.train"
SHORT_ROUNDS = partial(mimoc.train, hyper={"n_steps": 64, "batch_size": 64})
SMALL = {
    "growth": {"QUICK_MONTHS": (0, 6, 18)},
    "strength": {"PAPER_MONTHS": (3, 18)},
    "acuity": {"PAPER_MONTHS": (1, 6), "QUICK_SIZE_PX": 32},
    "delays": {
        TRAIN: SHORT_ROUNDS,
        "QUICK_STEPS": 512,
        "QUICK_SEEDS": (1,),
        "DELAYS_MS": (0, 50),
        "EPISODES": 1,
        "SHOWN": 1,
        "MONTHS": (4, 9),
        "QUICK_REACHES": 1,
        "SETUPS": {"mimo": {"task": {"kind": "reach", "ball": "mimo"}}},
        "TITLES": ("MIMo's ball",),
        "REACH_S": 0.3,
    },
    "inverse": {"QUICK_TRIALS": 1, "QUICK_SECONDS": 0.2},
    "rooms": {"seeds": range(2), "PICTURE_PX": (64, 48)},
    "development": {
        "QUICK_NAMES": ("no_head_lag",),
        "QUICK_AGES": (0, 18),
        "QUICK_MONTHS": (0, 18),
        "QUICK_SITTING_MONTHS": (0,),
        "VARIED_NAMES": ("no_head_lag",),
        "mimoc.policies.control.holding.postures.BISECTIONS": 6,
    },
    "growing": {
        TRAIN: partial(mimoc.train, hyper={"n_steps": 32, "batch_size": 64}),
        "AGES_MONTHS": (6, 6.5),
        "EPISODE_STEPS": 20,
        "QUICK_STEPS": 256,
        "QUICK_CHECKPOINT_EVERY": 128,
        "QUICK_SEEDS": (1,),
        "QUICK_BALLS": 2,
        "QUICK_CHECK_BALLS": 1,
    },
    "kicking": {"QUICK_SECONDS": 4.0, "seeds": range(1)},
    "weights": {"QUICK_SECONDS": 4.0, "seeds": range(1)},
    "contingency": {
        "seeds": range(1),
        "QUICK_PHASES_S": {"baseline": 4.0, "interaction": 6.0, "still_face": 4.0, "reunion": 4.0},
    },
    "mobile": {
        "seeds": range(1),
        "QUICK_PHASES_S": {"baseline": 4.0, "acquisition": 8.0, "extinction": 4.0},
        "TYING_S": 1.0,
        "BIN_S": 4.0,
    },
    "stepping": {"QUICK_SECONDS": 3.0, "seeds": range(1)},
    "localisation": {"QUICK_MONTHS": (4, 18), "QUICK_ANGLES_DEG": (0, 30, 90), "QUICK_TRIALS": 100},
    "regard": {"MONTHS": (0, 4), "QUICK_SECONDS": 0.4, "SIZE_PX": 32, "PICTURED_S": 0.2},
    "looking": {
        "AGES_MONTHS": (1, 12),
        "QUICK_MONTHS": (1, 12),
        "SIZE_PX": 128,
        "ACUITY_SHARES": (0.1, 0.2),
        "USUAL_CPD": (0.3, 0.6),
        "CONTRAST_CPD": (0.25,),
        "THRESHOLD_SHARES": (0.6, 1.6),
    },
}
"""What makes an experiment small, by name: seeds, constants of its module, and others with their modules."""


ALWAYS = ("growth", "acuity", "inverse", "rooms")


LAWS = {name: law for name in EXPERIMENTS if (law := find_experiment(name).development)}


def small(name: str, patch: pytest.MonkeyPatch) -> Experiment:
    experiment = find_experiment(name)
    for constant, value in SMALL[name].items():
        if constant != "seeds":
            patch.setattr(constant if "." in constant else f"{EXPERIMENTS[name]}.{constant}", value)
    return replace(experiment, quick={name: value for name, value in SMALL[name].items() if name == "seeds"})


@pytest.fixture(scope="module")
def folder_of(tmp_path_factory):
    """Return what gives the folder with the results of a small run of an experiment by a law; it makes each once."""
    folders = {}

    def give(name: str, law: str | None = None) -> Path:
        law = None if law == LAWS.get(name) else law
        if (name, law) not in folders:
            folders[name, law] = tmp_path_factory.mktemp(name) / "out"
            with pytest.MonkeyPatch.context() as patch:
                run_experiment(small(name, patch), folders[name, law], quick=True, development=law)
        return folders[name, law]

    return give


@pytest.fixture(scope="module", params=full_but(ALWAYS, list(EXPERIMENTS)))
def made(request, tmp_path_factory, folder_of):
    """Return the name of an experiment, two folders with the results of one small run each, and its progress."""
    name, told = request.param, []
    folder = tmp_path_factory.mktemp(name)
    with pytest.MonkeyPatch.context() as patch:
        run_experiment(small(name, patch), folder, quick=True, progress=lambda *done: told.append(done))
    return name, [folder, folder_of(name)], told


@pytest.mark.parametrize(
    "infant",
    [lambda: lying("published", 6)(0), lambda: reaching("published", 50), lambda: sitting("published")],
    ids=["effort", "delays", "inverse"],
)
def test_what_the_paper_shows_of_strength_and_control_is_shown_by_its_law(infant):
    """Whose motors have no activation."""
    bundle = infant()
    assert "development: published" in bundle.files["resolved.yaml"].decode().splitlines()
    assert load_model(bundle).na == 0


def test_it_writes_tables_pictures_and_one_page(made):
    name, (folder, _), _ = made
    kinds = [path.suffix for path in folder.iterdir() if path.is_file()]
    assert (folder / f"{name}.md").is_file()
    assert set(kinds) == {".csv", ".png", ".md"}
    assert kinds.count(".md") == 1


def test_the_same_seeds_give_the_same_tables_to_the_byte(made):
    _, folders, _ = made
    one, other = ({path.name: path.read_bytes() for path in folder.glob("*.csv")} for folder in folders)
    assert one == other


def test_every_table_has_a_heading_with_units_and_a_value_in_each_column(made):
    for path in made[1][0].glob("*.csv"):
        heading, *rows = (line.split(",") for line in path.read_text().splitlines())
        assert rows, path
        assert {len(row) for row in rows} == {len(heading)}


def test_every_picture_is_whole_and_small(made):
    for path in made[1][0].glob("*.png"):
        with Image.open(path) as picture:
            picture.verify()
        assert path.stat().st_size < 300_000


def test_the_page_compares_in_a_table_and_names_the_paper(made):
    page = (made[1][0] / f"{made[0]}.md").read_text()
    assert "| --- |" in page
    assert "paper" in page
    assert f"mimoc experiment {made[0]} -o " in page
    assert f"mimoc {mimoc.__version__}" in page


def test_the_page_shows_every_picture_and_mentions_every_table(made):
    name, (folder, _), _ = made
    page = (folder / f"{name}.md").read_text()
    assert set(re.findall(r"\]\((.*?)\)", page)) == {path.name for path in folder.glob("*.png")}
    assert all(f"`{path.name}`" in page for path in folder.glob("*.csv"))


def test_the_page_has_no_gaps_and_no_place_of_this_machine(made):
    page = (made[1][0] / f"{made[0]}.md").read_text()
    assert "{" not in page.replace("{model: muscle}", "")
    assert str(made[1][0].parent) not in page


def test_progress_counts_up_to_the_end(made):
    told = made[2]
    counts = [done for done, _ in told]
    assert counts == sorted(counts)
    assert {total for _, total in told} == {counts[-1]}


# The law of development.

OTHER = {"published": "maturing", "maturing": "published"}


@pytest.mark.parametrize("name", full_but(("growth", "inverse", "rooms"), list(LAWS)))
def test_it_works_by_the_other_law_too(name, folder_of):
    """That of the tests above is the one that it has unless another is asked for."""
    law = OTHER[LAWS[name]]
    page = (folder_of(name, law) / f"{name}.md").read_text()
    assert f"`development: {law}`" in page
    assert f"mimoc experiment {name} -o out --development {law} --quick" in page
    assert ("### The paper's figures beside ours" in page) == (law == "published")


@pytest.mark.parametrize("name", full_but(("growth", "inverse", "rooms"), list(LAWS)))
def test_the_papers_figures_stand_beside_ours_with_how_they_are_known(name, folder_of):
    page = (folder_of(name, "published") / f"{name}.md").read_text()
    rows = page.partition("### The paper's figures beside ours")[2].partition("\n\nS: ")[0].splitlines()
    known = [figure for figure in figures_of(name) if any(row.startswith(f"| {figure.quantity} | ") for row in rows)]
    assert known
    assert all(any(f"| {figure.certainty}: {figure.source} |" in row for row in rows) for figure in known)


# What is refused.


def test_an_unknown_name_lists_those_there_are(tmp_path):
    with pytest.raises(UnknownNameError, match="'strenght' is not a known experiment; did you mean 'strength'"):
        run_experiment("strenght", tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_a_missing_matplotlib_is_told_before_anything_is_done(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"mimoc\[report\]"):
        run_experiment("growth", tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_the_way_is_refused(tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(OutputError, match="is a file"):
        run_experiment("growth", tmp_path / "out")
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["swimming", "-o", "out"],
            f"'swimming' is not a known experiment; choose from {', '.join(sorted(EXPERIMENTS))}",
        ),
        (["growth", "-o", "file"], "file: is a file, not a folder; choose another folder"),
        (
            ["growth", "-o", "out", "--development", "publishd"],
            "'publishd' is not a law of development; did you mean 'published'?",
        ),
        (
            ["growing", "-o", "out", "--development", "published"],
            "the experiment 'growing' has laws of development of its own; leave out 'development'",
        ),
    ],
)
def test_the_command_says_in_one_line_what_is_wrong(arguments, message, invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("mine")
    assert invoke("experiment", *arguments) == (2, "", message + "\n")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_the_help_lists_every_experiment(invoke):
    listed = re.sub(r"[│\s]+", " ", invoke("experiment", "--help").out)
    assert f"One of: {', '.join(EXPERIMENTS)}." in listed


def test_the_command_prints_where_the_page_is(invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(import_module(EXPERIMENTS["growth"]), "QUICK_MONTHS", (6,))
    assert invoke("experiment", "growth", "-o", "out/growth", "--quick") == (0, "out/growth/growth.md\n", "")


def test_what_was_finished_outlives_an_interruption(tmp_path, monkeypatch):
    """Every file is whole or not there; what an earlier run left stays until its successor is whole."""
    strength = import_module(EXPERIMENTS["strength"])
    (tmp_path / "strength.csv").write_text("earlier")

    def interrupt(done: int, total: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(strength, "PAPER_MONTHS", (3,))
    with pytest.raises(KeyboardInterrupt):
        run_experiment("strength", tmp_path, quick=True, progress=interrupt)
    assert [path.name for path in tmp_path.iterdir()] == ["strength.csv"]
    assert (tmp_path / "strength.csv").read_text() == "earlier"
