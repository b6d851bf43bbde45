"""Experiments: trials that an interruption leaves intact, what their pages show, and experiments from outside."""

import csv
import json
import math
import re
import textwrap
import time
from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import pytest

from mimoc.base.errors import MimocError, OutputError, UnknownNameError
from mimoc.compiler import building
from mimoc.schema.infant import InfantSpec
from mimoc.studies import experiment as experiments, jobs
from mimoc.studies.comparison import Reference, change_text, direction, interval, relative_changes, sign_test
from mimoc.studies.experiment import TRIALS, Experiment, Lines, TrialResult, find_experiment, grid, run_experiment
from mimoc.studies.notebook import bodies_digest, markdown_table, open_notebook
from mimoc.studies.skills import CHILD, bodies_of, shipped_skills


@dataclass(frozen=True)
class Case:
    factor: float
    age_months: float = 3.0


RUNS: list[int] = []


def multiply(case: Case, seed: int) -> dict[str, float]:
    RUNS.append(seed)
    if seed == 13:
        raise KeyboardInterrupt
    return {"product": case.factor * seed}


def wait(case: Case, seed: int) -> TrialResult:
    time.sleep(seed)
    return TrialResult(values={"waited": seed})


@pytest.fixture
def toy():
    RUNS.clear()
    return Experiment(name="toy", trial=multiply, cases=[Case(2.0)], seeds=(1, 2))


def tried(experiment: Experiment, folder, quick: bool = True, progress=None):
    return experiment._try_all(open_notebook("toy", folder, quick=quick, progress=progress))


# Trials.


def test_results_come_by_case_in_the_order_of_the_seeds(toy, tmp_path):
    results = tried(replace(toy, cases=[Case(2.0), Case(3.0), Case(2.0)], seeds=(3, 1)), tmp_path)
    assert [results.values(case, "product") for case in results.by_case] == [[6.0, 2.0], [9.0, 3.0]]


def test_what_was_finished_is_not_repeated_after_an_interruption_and_counts(toy, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        tried(replace(toy, seeds=(1, 2, 13)), tmp_path)
    counts = []
    tried(replace(toy, seeds=(1, 2, 3)), tmp_path, progress=lambda *done: counts.append(done))
    assert RUNS == [1, 2, 13, 3]
    assert counts == [(1, 3), (2, 3), (3, 3)]


@pytest.mark.full
def test_an_interruption_ends_running_trials_within_seconds_and_keeps_finished_ones(toy, tmp_path):
    def interrupt(done: int, total: int) -> None:
        raise KeyboardInterrupt

    begin = time.monotonic()
    waiting = replace(toy, trial=wait, seeds=(0, 600, 601))
    with pytest.raises(KeyboardInterrupt):
        tried(waiting, tmp_path, quick=False, progress=interrupt)
    assert time.monotonic() - begin < 30.0
    assert len(list((tmp_path / TRIALS).iterdir())) == 1


def test_a_trial_of_other_software_or_another_case_is_done_again(toy, tmp_path, monkeypatch):
    tried(toy, tmp_path)
    assert tried(replace(toy, cases=[Case(3.0)], seeds=(1,)), tmp_path).values(Case(3.0), "product") == [3.0]
    changed = {**jobs.software(), "studies/jobs.py": "sha256:0"}
    monkeypatch.setattr(jobs, "software", lambda: changed)
    tried(toy, tmp_path)
    assert RUNS == [1, 2, 1, 1, 2]


def test_a_damaged_result_is_done_again(toy, tmp_path):
    tried(replace(toy, seeds=(1,)), tmp_path)
    (path,) = (tmp_path / TRIALS).iterdir()
    path.write_text("{")
    assert tried(replace(toy, seeds=(1,)), tmp_path).values(Case(2.0), "product") == [2.0]
    assert RUNS == [1, 1]


def test_the_software_is_all_of_mimoc_and_its_tables():
    software = jobs.software()
    assert {"mimoc", "mujoco", "numpy", "policies/__init__.py", "data/anthrokids.csv"} <= software.keys()
    assert not [name for name in software if name.endswith(".pyc")]


# Tables, plots and pages.


def test_without_further_words_it_shows_all_measures_with_intervals_beside_real_infants(toy, tmp_path):
    known = Reference(youngest_months=0, oldest_months=4, low=1, high=4, certainty="read", source="Some 1999")
    full = replace(
        toy,
        cases=grid(Case, factor=(1.0, 2.0), age_months=(3.0, 6.0)),
        quick={"seeds": (1, 2, 3)},
        files={"toy.png": Lines("age_months", "product", "factor", known)},
        references={"product": [known]},
    )
    page = run_experiment(full, tmp_path / "out", quick=True).read_text()
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["toy.csv", "toy.md", "toy.png"]
    table = (tmp_path / "out" / "toy.csv").read_text()
    assert table.startswith("factor,age_months,seed,measure,value\n1,3,1,product,1\n")
    assert "| 1 | 3 | product | 3 | 2.00 (-0.48 to 4.48) | 1 to 4 | inside | Some 1999 (read) |" in page
    assert "| 2 | 6 | product | 3 | 4.00 (-0.97 to 8.97) |  |  |  |" in page
    assert "    mimoc experiment toy -o out --quick\n" in page


@pytest.mark.parametrize("returned", [{"a": float("nan")}, {"a": "much"}, None, [1.0]])
def test_a_trial_that_returns_no_numbers_is_an_error_in_one_line(returned, toy, tmp_path):
    with pytest.raises(
        MimocError, match=r"^a trial of the experiment 'toy' returned .*; return finite numbers by name"
    ):
        run_experiment(replace(toy, trial=lambda case, seed: returned), tmp_path, quick=True)


@pytest.mark.parametrize("wrong", [{"name": "My toy"}, {"trial": None}, {"measure": lambda notebook: None}])
def test_an_experiment_has_a_name_and_one_way_to_measure(wrong, toy):
    with pytest.raises(MimocError, match=r"cannot name an experiment|needs either 'trial' or 'measure'"):
        replace(toy, **wrong)


# Experiments from outside.

OWN = """
from mimoc.studies.experiment import Experiment

def double(case, seed):
    return {"twice": 2.0 * case * seed}

EXPERIMENT = Experiment(name="doubling", trial=double, cases=(1.0, 2.0), seeds=(1, 2))
"""


@pytest.fixture
def own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)

    def write(name: str, text: str) -> str:
        (tmp_path / f"{name}.py").write_text(textwrap.dedent(text))
        return f"{name}.py"

    return write


def test_a_file_that_defines_an_experiment_runs_it(own, invoke, tmp_path):
    assert invoke("experiment", own("own_doubling", OWN), "-o", "out", "--quick") == (0, "out/doubling.md\n", "")
    page = (tmp_path / "out" / "doubling.md").read_text()
    assert "    mimoc experiment own_doubling.py -o out --quick\n" in page
    assert "| 2 | twice | 2 | 6.00 (-19.41 to 31.41) |  |  |  |" in page


@pytest.mark.full
def test_trials_of_a_file_run_in_other_processes(own, invoke):
    assert invoke("experiment", own("own_parallel", OWN), "-o", "out").code == 0


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("own_nothing", "x = 1", "own_nothing.py: defines no experiments; define one, EXPERIMENT = Experiment(...)"),
        ("own_broken", "x = ", "own_broken.py: cannot be imported (SyntaxError("),
        ("own_failing", "1 / 0", "own_failing.py: cannot be imported (ZeroDivisionError('division by zero'))"),
        ("json", OWN, f"json.py: there is another module 'json' ({json.__file__}); choose another name"),
    ],
)
def test_a_file_that_defines_none_is_refused_in_one_line(name, text, message, own, invoke):
    code, out, err = invoke("experiment", own(name, text), "-o", "out")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(message)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(MimocError, match="there is no such file"):
        find_experiment(tmp_path / "own.py")


def test_a_plug_ins_experiment_is_known_by_its_name(own, invoke, monkeypatch):
    own("own_plugin", OWN)
    points = EntryPoints(
        EntryPoint(name, f"own_plugin:{target}", "mimoc.experiments")
        for name, target in (("doubling", "EXPERIMENT"), ("lost", "LOST"), ("double", "double"))
    )
    monkeypatch.setattr(experiments, "installed_entry_points", lambda: points)
    assert invoke("experiment", "doubling", "-o", "out", "--quick") == (0, "out/doubling.md\n", "")
    with pytest.raises(MimocError, match="the experiment 'lost' cannot be loaded: AttributeError"):
        find_experiment("lost")
    with pytest.raises(MimocError, match=r"the entry point 'double' of 'mimoc\.experiments' is no Experiment"):
        find_experiment("double")
    with pytest.raises(UnknownNameError, match="did you mean 'doubling'"):
        find_experiment("doublin")


# Comparisons.


def test_the_interval_is_students():
    """1, 2, 3: mean 2, standard deviation 1, t of .975 with 2 degrees of freedom 4.303."""
    mean = interval([1.0, 2.0, 3.0])
    assert (mean.mean, mean.high - mean.mean) == pytest.approx((2.0, 4.3027 / 3**0.5), rel=1e-4)
    assert mean.text(1) == "2.0 (-0.5 to 4.5)"
    assert interval([5.0]).text(0) == "5 (5 to 5)"


def test_the_sign_test_is_one_sided_and_ignores_ties():
    assert sign_test([1.0] * 5) == 1 / 32
    assert sign_test([1.0, 0.0, -1.0]) == 0.75
    assert sign_test([]) == 1.0


def test_each_seed_is_compared_with_itself():
    plain, changed = [{"x": 1.0}, {"x": 3.0}, {}], [{"x": 2.0}, {"x": 3.0}, {"x": 9.0}]
    assert relative_changes(plain, changed, "x") == [0.5, 0.0]
    assert change_text([0.5, 0.0, 0.25]) == "+25% (-37% to +87%), 2 of 3"
    assert relative_changes([{"x": 0.0}], [{"x": 1.0}], "x") == []


def test_a_direction_needs_more_than_chance():
    assert direction([0.1] * 5) == "more"
    assert direction([-0.1] * 5) == "less"
    assert direction([0.1] * 4) == "unclear"
    assert direction([0.1, -0.1] * 4) == "same"
    assert direction([0.1] * 5, least=0.2) == "same"
    assert direction([]) == "unclear"


@pytest.fixture
def notebook(tmp_path):
    return open_notebook("growth", tmp_path / "deep" / "down", quick=True, development="maturing")


def test_its_folder_is_made(notebook, tmp_path):
    assert notebook.folder == tmp_path / "deep" / "down"
    assert notebook.folder.is_dir()


def test_a_table_reads_back_as_it_was_written(notebook):
    notebook.write_table("some.csv", "name,size_m", [("a, b", 0.125), ("c", 1)])
    with (notebook.folder / "some.csv").open(newline="") as file:
        assert list(csv.DictReader(file)) == [{"name": "a, b", "size_m": "0.125"}, {"name": "c", "size_m": "1"}]


def test_nothing_to_say_is_an_empty_cell(notebook):
    notebook.write_table("some.csv", "a,b,c", [(None, math.nan, 0.0)])
    assert (notebook.folder / "some.csv").read_bytes() == b"a,b,c\n,,0\n"


def test_text_is_wrapped_and_tables_are_not(notebook):
    table = markdown_table(("a", "b"), [("long " * 40, "1")])
    page = notebook.write_page(f"# Growth\n\n{'many words ' * 40}\n\n{table}").read_text()
    assert page.startswith("# Growth\n\nmany words many words")
    assert table in page
    assert max(len(line) for line in page.splitlines() if not line.startswith("|")) <= 120


def test_what_is_there_already_stays(notebook):
    (notebook.folder / "mine.txt").write_text("mine")
    open_notebook("growth", notebook.folder, quick=False).write_table("some.csv", "a", [])
    assert sorted(path.name for path in notebook.folder.iterdir()) == ["mine.txt", "some.csv"]


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ("file.txt", "is a file, not a folder; choose another folder"),
        ("file.txt/results", "cannot be created"),
        ("l" * 300, "cannot be created"),
        ("nul\0", "a folder cannot have this name"),
    ],
)
def test_a_folder_that_cannot_be_is_an_error(place, reason, tmp_path):
    (tmp_path / "file.txt").write_text("mine")
    with pytest.raises(OutputError, match=reason):
        open_notebook("growth", tmp_path / place, quick=False)
    assert [path.name for path in tmp_path.iterdir()] == ["file.txt"]


def test_a_markdown_table_has_a_line_for_each_row():
    assert markdown_table(("a", "b"), [("1", "2")]) == "| a | b |\n| --- | --- |\n| 1 | 2 |"


CHECKOUT = Path(__file__).resolve().parents[2]
COLUMNS = (("maturing", "torque"), ("maturing", "muscle"), ("published", "torque"))
"""Laws and actuation models of the table of milestones; its column of servos says itself of which bodies it is."""


def child(**keys) -> InfantSpec:
    return InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 6} | keys)


@pytest.fixture(scope="module")
def digest() -> str:
    return bodies_digest([child()])


def test_what_moves_nothing_is_not_in_the_digest(digest):
    other = child(name="lee", senses={"touch": {}, "vision": {}}, delays={"preset": "physiological"})
    assert bodies_digest([other]) == digest


@pytest.mark.parametrize(
    "keys",
    [{"age_months": 6.1}, {"actuation": {"strength": {"arms": 0.99}}}, {"scene": {"kind": "room"}}],
    ids=lambda keys: next(iter(keys)),
)
def test_what_moves_otherwise_changes_the_digest(keys, digest):
    assert bodies_digest([child(**keys)]) != digest


def test_a_bundle_has_the_digest_of_its_spec_and_order_matters():
    first, second = child(), child(age_months=9)
    both = bodies_digest([first, second])
    assert bodies_digest([building.build(first), building.build(second)]) == both
    assert bodies_digest([second, first]) != both
    assert re.fullmatch("[0-9a-f]{16}", both)


@pytest.mark.parametrize("report", shipped_skills().skills, ids=lambda report: report.skill)
def test_results_of_skills_are_of_todays_bodies(report):
    today = bodies_of(InfantSpec.model_validate(CHILD), [result.age_months for result in report.ages])
    renew = f"learn it again (docs/skills.md): mimoc/studies/skills/results/{report.skill}.json"
    assert report.bodies == today, f"{renew} is of the bodies {report.bodies}, today's are {today}"


def test_the_table_of_milestones_is_of_todays_bodies():
    page = (CHECKOUT / "docs" / "milestones.md").read_text(encoding="utf-8")
    today = bodies_digest(
        child(age_months=age_months, development=law, actuation={"model": model})
        for law, model in COLUMNS
        for age_months in (0, 6, 12)
    )
    (measured,) = re.findall(r"of the bodies `(\w+)`", page)
    renew = "renew the table of docs/milestones.md with 'mimoc validate --against milestones'"
    assert measured == today, f"{renew}: it is of the bodies {measured}, today's are {today}"
