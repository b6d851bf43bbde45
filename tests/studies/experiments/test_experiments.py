"""What holds of every experiment; each is made small."""

import re
import sys
from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from PIL import Image
from support.full import full_but

import mimoc
from mimoc.base.errors import MissingExtraError, OutputError, UnknownNameError
from mimoc.bundle.model import load_model
from mimoc.runtime.quantities import EpisodeResult
from mimoc.studies.comparison import Figure
from mimoc.studies.experiment import Experiment, figure_rows, figures_of, find_experiment, grid, run_experiment
from mimoc.studies.experiments import (
    EXPERIMENTS,
    delays,
    growth,
    kicking,
    localisation,
    looking,
    regard,
    sitting,
    strength,
)
from mimoc.studies.experiments.contingency import Phases
from mimoc.studies.experiments.delays import reaching
from mimoc.studies.experiments.growing import (
    AGES_MONTHS,
    QUICK_STEPS,
    STEPS,
    comparison,
    reaching as growing_infant,
    schedule_of,
)
from mimoc.studies.experiments.inverse import sitting as sitting_infant
from mimoc.studies.experiments.learner import Learner, by_group
from mimoc.studies.experiments.strength import lying
from mimoc.studies.notebook import page_text
from mimoc.training import Curve, Training

REGARDING = grid(regard.Case, condition=regard.POLICIES, age_months=(0, 4), seconds=(0.4,))
SITTING = [sitting.Case(9), *(sitting.Case(9, name, levels[-1]) for name, levels in sitting.LEVELS.items())]
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
        "MAX_PLOTTED": 1,
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
        "mimoc.policies.control.postures.BISECTIONS": 6,
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
    "kicking": {"seeds": range(1), "cases": [kicking.Case(age, 4.0) for age in (0, 3)]},
    "weights": {"QUICK_SECONDS": 4.0, "seeds": range(1)},
    "contingency": {
        "seeds": range(1),
        "cases": [Phases((4.0, 6.0, 4.0, 4.0), 60.0)],
    },
    "mobile": {
        "seeds": range(1),
        "cases": [Phases((4.0, 8.0, 4.0), 180.0)],
        "TYING_S": 1.0,
    },
    "stepping": {"QUICK_SECONDS": 3.0, "seeds": range(1)},
    "localisation": {"QUICK_TRIALS": 100, "cases": [localisation.Case(age, (0, 30, 90)) for age in (4, 18)]},
    "sitting": {"seeds": range(1), "SECONDS": 0.3, "cases": SITTING},
    "regard": {
        "MONTHS": (0, 4),
        "cases": REGARDING,
        "seeds": range(1),
        "SIZE_PX": 32,
        "SEEING_PX": {"sees": 16},
        "PICTURED_S": 0.2,
    },
    "looking": {
        "AGES_MONTHS": (1, 12),
        "cases": grid(looking.Case, eyes=looking.KINDS, age_months=(1, 12)),
        "SIZE_PX": 128,
        "ACUITY_SHARES": (0.1, 0.2),
        "USUAL_CPD": (0.3, 0.6),
        "CONTRAST_CPD": (0.25,),
        "THRESHOLD_SHARES": (0.6, 1.6),
    },
}
"""What makes an experiment small, by name: seeds, cases, constants of its module, and others with their modules."""


ALWAYS = ("growth", "acuity", "inverse", "rooms")


LAWS = {name: law for name in EXPERIMENTS if (law := find_experiment(name).development)}


def small(name: str, patch: pytest.MonkeyPatch) -> Experiment:
    experiment = find_experiment(name)
    for constant, value in SMALL[name].items():
        if constant not in ("seeds", "cases"):
            module = EXPERIMENTS[name].partition(":")[0]
            patch.setattr(constant if "." in constant else f"{module}.{constant}", value)
    return replace(experiment, quick={key: value for key, value in SMALL[name].items() if key in ("seeds", "cases")})


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
    name, told = request.param, []
    folder = tmp_path_factory.mktemp(name)
    with pytest.MonkeyPatch.context() as patch:
        run_experiment(small(name, patch), folder, quick=True, progress=lambda *done: told.append(done))
    return name, [folder, folder_of(name)], told


@pytest.mark.parametrize(
    "infant",
    [lambda: lying("published", 6)(0), lambda: reaching("published", 50), lambda: sitting_infant("published")],
    ids=["effort", "delays", "inverse"],
)
def test_what_the_paper_shows_of_strength_and_control_is_shown_by_its_law(infant):
    """Whose motors have no activation."""
    bundle = infant()
    assert "development: published" in bundle.files["resolved.yaml"].decode().splitlines()
    assert load_model(bundle).na == 0


def test_the_same_seeds_give_the_same_tables_to_the_byte(made):
    one, other = ({path.name: path.read_bytes() for path in folder.glob("*.csv")} for folder in made[1])
    assert one == other


def test_it_writes_whole_tables_small_pictures_and_one_page_that_shows_them_all(made):
    name, (folder, _), _ = made
    tables, pictures, pages = (list(folder.glob(f"*.{suffix}")) for suffix in ("csv", "png", "md"))
    assert tables
    for path in tables:
        heading, *rows = (line.split(",") for line in path.read_text().splitlines())
        assert rows, path
        assert {len(row) for row in rows} == {len(heading)}
    for path in pictures:
        with Image.open(path) as picture:
            picture.verify()
        assert path.stat().st_size < 300_000
    assert [page.name for page in pages] == [f"{name}.md"]
    page = pages[0].read_text()
    assert set(re.findall(r"\]\((.*?)\)", page)) == {path.name for path in pictures} != set()
    assert all(f"`{path.name}`" in page for path in tables)
    for said in ("| --- |", "paper", f"mimoc experiment {name} -o ", f"mimoc {mimoc.__version__}"):
        assert said in page
    assert "{" not in page.replace("{model: muscle}", "")
    assert str(folder.parent) not in page


def test_progress_counts_up_to_the_end(made):
    told = made[2]
    counts = [done for done, _ in told]
    assert counts == sorted(counts)
    assert {total for _, total in told} == {counts[-1]}


# The law of development.

OTHER = {"published": "maturing", "maturing": "published"}


@pytest.mark.parametrize("name", full_but(("growth", "inverse", "rooms"), list(LAWS)))
def test_it_works_by_the_other_law_too(name, folder_of):
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
            ["juggling", "-o", "out"],
            f"'juggling' is not a known experiment; choose from {', '.join(sorted(EXPERIMENTS))}",
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
    monkeypatch.setattr(growth, "QUICK_MONTHS", (6,))
    assert invoke("experiment", "growth", "-o", "out/growth", "--quick") == (0, "out/growth/growth.md\n", "")


def test_what_was_finished_outlives_an_interruption(tmp_path, monkeypatch):
    """Every file is whole or not there; what an earlier run left stays until its successor is whole."""
    (tmp_path / "strength.csv").write_text("earlier")

    def interrupt(done: int, total: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(strength, "PAPER_MONTHS", (3,))
    with pytest.raises(KeyboardInterrupt):
        run_experiment("strength", tmp_path, quick=True, progress=interrupt)
    assert [path.name for path in tmp_path.iterdir()] == ["strength.csv"]
    assert (tmp_path / "strength.csv").read_text() == "earlier"


PAPERS = ("growth", "strength", "acuity", "delays", "inverse", "rooms")


def row(paper: str, measured) -> tuple[str, ...]:
    return Figure("length [cm]", paper, "S", "its code").row(measured)[1:4]


def test_a_number_has_a_digit_more_than_the_papers_and_its_difference():
    assert row("82.6", 82.6125) == ("82.6", "82.61", "+0.01")
    assert row("+0.3", 0.296) == ("+0.3", "+0.30", "+0.00")
    assert row("10", 3) == ("10", "3", "-7")


def test_a_word_differs_or_does_not():
    assert row("yes", "yes") == ("yes", "yes", "")
    assert row("yes", "no") == ("yes", "no", "differs")
    assert row("2.25", None) == ("2.25", "never", "differs")


@pytest.mark.parametrize("name", PAPERS)
def test_each_experiment_of_the_paper_has_figures_that_say_how_they_are_known(name):
    figures = figures_of(name)
    assert len({figure.quantity for figure in figures}) == len(figures) > 0
    assert all(figure.certainty in "SDM" and figure.source for figure in figures)
    assert not list(figure_rows(name, {}))


@pytest.mark.parametrize(
    ("longer", "verdict"),
    [
        ({"units": 2.0, "path_ratio": 2.0, "arc_length": -2.0, "jerk": -7.0}, "yes"),
        ({"units": 1.0, "path_ratio": 2.0, "arc_length": -1.0, "jerk": -7.0}, "by path length and jerk only"),
        ({"units": 1.0, "path_ratio": 1.0, "arc_length": -1.0, "jerk": -6.0}, "no"),
    ],
)
def test_movements_are_less_smooth_where_every_measure_that_the_page_lists_says_so(longer, verdict):
    """The verdict beside the paper's is made from the page's list."""

    def learner(**measures) -> Any:
        return SimpleNamespace(mean=measures.get, median=measures.get)

    shortest = {"units": 1.0, "path_ratio": 1.0, "arc_length": -1.0, "jerk": -6.0}
    assert delays._less_smooth({"0 ms": [learner(**shortest)], "200 ms": [learner(**longer)]}) == verdict


def test_experiments_of_the_paper_are_those_whose_infants_can_have_its_body():
    assert [name for name in EXPERIMENTS if find_experiment(name).development] == list(PAPERS)


NUMBERS = {"steps": 1000, "seeds": 3, "balls": 2, "check_balls": 1}
NUMBERS |= dict.fromkeys(("reproduction", "training_seeds", "first_ball"), "")


def learner(schedule: str, seed: int, time_s: float, early_s: float, tmp_path) -> Learner:
    """Return an infant that takes so long to touch each ball, and so long at its first checkpoint."""
    reaches = [EpisodeResult(90.0, 10, True, time_s, ball) for ball in range(2)]
    early = [EpisodeResult(10.0, 10, False, early_s, 0)]
    checks = {500: early, 1000: reaches[:1]}
    return Learner(schedule, seed, Training(Curve(), tmp_path, 0), reaches, checks)


@pytest.fixture
def page(tmp_path):
    def write(**times_s: list[tuple[float, float]]) -> str:
        learners = [
            learner(name, seed, *each, tmp_path) for name, times in times_s.items() for seed, each in enumerate(times)
        ]
        untrained = [EpisodeResult(5.0, 100, True, 3.0, 0), EpisodeResult(-5.0, 1000, False, 10.0, 1)]
        return page_text("growing", **comparison(by_group(learners), untrained, (6, 12)), **NUMBERS)

    return write


FAST, SLOW, MIXED = (
    [(time, 5 * time) for time in times] for times in ((0.1, 0.2, 0.3), (0.4, 0.5, 0.6), (0.2, 0.4, 0.6))
)


def test_the_infant_is_of_the_oldest_age_and_matures():
    resolved = growing_infant(12.0).files["resolved.yaml"].decode().splitlines()
    assert "age_months: 12.0" in resolved
    assert "development: published" not in resolved


@pytest.mark.parametrize("steps", [STEPS, QUICK_STEPS])
def test_all_schedules_but_adult_have_the_same_ages_for_equally_long(steps):
    """Up to the one control step that a stage can be longer than another."""
    courses = ("grown", "reversed", "shuffled")
    counts = [Counter(map(schedule_of(name, 1, steps), range(steps))) for name in courses]
    assert [set(count) == set(counts[0]) for count in counts] == [True] * 3
    assert all(max(count.values()) - min(count.values()) <= 1 for count in counts)
    assert set(map(schedule_of("adult", 1, steps), range(steps))) == {AGES_MONTHS[1]}


def test_reaches_that_fail_count_with_their_whole_length(tmp_path):
    found = learner("grown", 0, 0.2, 1.0, tmp_path)
    assert found.time_s() == pytest.approx(0.2)
    assert found.check_times_s() == {500: 1.0, 1000: 0.2}
    assert found.time_over_checkpoints_s() == pytest.approx(0.6)


EARLY_BUT_WORSE = [(time, 0.1) for time, _ in SLOW]


@pytest.mark.parametrize(
    ("grown", "adult", "shuffled", "told"),
    [
        (FAST, SLOW, SLOW, ["**Growing helped here", "better than every other", "after training: better, -60%"]),
        (SLOW, FAST, MIXED, ["**Growing did not help here", "is not shown by both measures"]),
        (MIXED, FAST, MIXED, ["**No effect of growing is shown here"]),
        (EARLY_BUT_WORSE, [(0.1, 9.0)] * 3, SLOW, ["over all checkpoints, and harmed time to touch after training.**"]),
        # Of the 20 ways to deal six numbers to two groups of three, two part them.
        (FAST, SLOW, SLOW, ["10% of such comparisons", "Naya-Varela", "1/25", "policy touches 50% of the balls"]),
    ],
)
def test_the_page_claims_that_growing_helps_only_if_every_seed_is_ahead(page, grown, adult, shuffled, told):
    text = " ".join(page(grown=grown, adult=adult, reversed=SLOW, shuffled=shuffled).split())
    assert all(words in text for words in told)
