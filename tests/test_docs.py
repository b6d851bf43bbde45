"""Commands, programs and links that the pages in docs print; README and `own_scene.md` have tests of their own."""

import re
import shlex
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType

import gymnasium
import numpy as np
import pytest
import yaml

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.anatomy.parts import PARTS
from mimoc.body.grow import grow_tree
from mimoc.body.strength import STRENGTH
from mimoc.fits import measure
from mimoc.schema.base import recompose
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import EXPORTERS
from mimoc.schema.outline import language_of

CHECKOUT = Path(__file__).resolve().parents[1]


def blocks(page: str, language: str) -> list[str]:
    text = (CHECKOUT / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    (tmp_path / "configs").symlink_to(CHECKOUT / "configs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_commands_for_code_written_for_mimo_work(here, invoke):
    commands = "".join(blocks("docs/compatibility.md", "sh")).splitlines()
    assert commands
    for command in commands:
        program, *arguments = shlex.split(command, comments=True)
        assert program == "mimoc"
        assert invoke(*arguments)[0] == 0, command
    assert (here / "out" / "for_mimo" / "scene.xml").exists()


def test_the_program_that_runs_an_experiment_works(here):
    _, program = blocks("docs/experiments/README.md", "python")
    assert '"strength"' in program
    exec(program.replace("strength", "growth"), {})
    assert any((here / "out" / "growth").glob("*.md"))


def test_the_experiment_of_ones_own_works(here, invoke, monkeypatch):
    own, _ = blocks("docs/experiments/README.md", "python")
    (here / "own.py").write_text(own)
    monkeypatch.syspath_prepend(here)
    monkeypatch.delitem(sys.modules, "own", raising=False)  # Other tests have modules of this name.
    assert invoke("experiment", "own.py", "-o", "out/hands", "--quick") == (0, "out/hands/hands.md\n", "")
    assert len(own.splitlines()) <= 80
    assert "| no verdict | this page (assumption) |" in (here / "out" / "hands" / "hands.md").read_text()


@pytest.mark.extras
@pytest.mark.slow
def test_the_programs_that_run_many_infants_work(here, capsys):
    session: dict = {}
    for program in blocks("docs/many.md", "python"):
        exec(program, session)
    assert capsys.readouterr().out.startswith("(8, ")


def test_the_program_on_kinds_of_environments_works(here):
    (program,) = blocks("docs/environments.md", "python")
    session: dict = {}
    exec(program, session)
    assert session["worlds"].get_attr("age_months") == (6.0, 7.0, 6.0, 9.0)
    assert [*session["episodes"]] == ["anna", "ben"]


def test_the_programs_on_growing_work(here):
    session: dict[str, object] = {}
    for program in blocks("docs/growing.md", "python"):
        exec(program, session)
    assert session["schedule"](0) == 6


def test_the_programs_on_recordings_work(here):
    session: dict[str, object] = {}
    try:
        for program in blocks("docs/recording.md", "python"):
            exec(program, session)
    finally:
        EXPORTERS.remove("npz")
    files = [np.load(file) for file in (here / "out" / "reach_npz").glob("*.npz")]
    assert sum(len(arrays["actions"]) for arrays in files) == 100
    assert all(len(arrays["observation.proprioception"]) == len(arrays["actions"]) + 1 for arrays in files)


def test_the_program_on_reports_works(here, capsys):
    (program,) = blocks("docs/report.md", "python")
    exec(program, {})
    assert capsys.readouterr().out == "six_months.html\n"
    assert (here / "six_months.html").stat().st_size < 1_000_000


@pytest.mark.slow
def test_the_programs_on_cohorts_work(here, capsys):
    whole = (CHECKOUT / "examples" / "cohort" / "spring.yaml").read_text(encoding="utf-8")
    folder = here / "examples" / "cohort"
    folder.mkdir(parents=True)
    (folder / "spring.yaml").write_text(whole.replace("draw: 8", "draw: 1").replace("[3, 6, 12]", "[3]"))
    (folder / "reach_of_arms.py").symlink_to(CHECKOUT / "examples" / "cohort" / "reach_of_arms.py")
    (program,) = blocks("docs/cohorts.md", "python")
    exec(program, {})
    assert capsys.readouterr().out.startswith("1 infants, 5 jobs\n5 done, ")


def test_the_commands_on_cohorts_and_its_file_are_right(invoke, here):
    (here / "nine_months.yaml").symlink_to(CHECKOUT / "configs" / "nine_months.yaml")
    (text,) = blocks("docs/cohorts.md", "yaml")
    (here / "cohort.yaml").write_text(text)
    assert len(mimoc.read_cohort("cohort.yaml").jobs()) == 100 * 7 * 2 * 7
    for line in blocks("docs/cohorts.md", "sh")[0].splitlines():
        program, group, command, *_ = shlex.split(line, comments=True)
        assert (program, group, invoke(group, command, "--help").code) == ("mimoc", "cohort", 0)


def test_every_file_that_a_page_links_to_exists():
    pages = [CHECKOUT / "README.md", CHECKOUT / "CONTRIBUTING.md", *(CHECKOUT / "docs").rglob("*.md")]
    pages += (CHECKOUT / "examples").rglob("*.md")
    texts = {page: re.sub(r"(?ms)^```.*?^```", "", page.read_text(encoding="utf-8")) for page in pages}
    links = [(page, link) for page, text in texts.items() for link in re.findall(r"\]\(([^)#:]+)\)", text)]
    assert len(links) > 20
    assert [(page.name, link) for page, link in links if not (page.parent / link).exists()] == []


def test_every_page_says_something_where_no_site_is_built():
    pages = {path: path.read_text(encoding="utf-8") for path in (CHECKOUT / "docs").rglob("*.md")}
    prose = {path: re.sub(r"(?ms)^```.*?^```|^#.*?$", "", text) for path, text in pages.items()}
    assert [path.name for path, text in prose.items() if len(text.strip()) < 80] == []


def test_no_temporary_file_is_kept():
    folders = [CHECKOUT / name for name in ("benchmarks", "configs", "data", "docs", "examples", "mimoc", "tests")]
    assert [path for folder in folders for path in folder.rglob("*.tmp")] == []
    assert [path for folder in folders for path in folder.rglob(".mimoc-*")] == []


def test_pages_that_build_in_the_same_folder_can_be_read_in_any_order():
    pages = [CHECKOUT / "README.md", *sorted((CHECKOUT / "docs").rglob("*.md"))]
    lines = [line for page in pages for line in "".join(blocks(str(page), "sh")).splitlines()]
    builds = [(match[1], line) for line in lines if (match := re.search(r"mimoc build .*-o (\S+)", line))]
    often = {out for out, count in Counter(out for out, _ in builds).items() if count > 1}
    assert "out/nine_months" in often
    assert [line for out, line in builds if out in often and "--force" not in line] == []


def test_every_module_that_contributing_names_exists():
    pages = (CHECKOUT / "CONTRIBUTING.md", CHECKOUT / "docs" / "recipes.md")
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    named = re.findall(r"`(mimoc/[a-z0-9_/]+(?:\.py|/))`", text)
    assert len(named) > 20
    assert [name for name in named if not (CHECKOUT / name).exists()] == []


def test_every_environment_that_a_page_names_is_registered():
    pages = [CHECKOUT / "README.md", *(CHECKOUT / "docs").rglob("*.md")]
    named = {name for page in pages for name in re.findall(r"\bmimoc/\w+-v\d+", page.read_text(encoding="utf-8"))}
    assert {"mimoc/Infant-v0", "mimoc/Reach-v0"} <= named <= set(gymnasium.registry)


def test_a_host_of_code_runs_what_ci_runs():
    """And what a release must be: the tag's version in the code, and a section of the changelog that has its name."""
    workflow = yaml.safe_load((CHECKOUT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))
    commands = {name: [step["run"] for step in job["steps"] if "run" in step] for name, job in workflow["jobs"].items()}
    assert commands["test"] == ["bash .ci/run"]
    check, look, *_ = (command.replace("${GITHUB_REF_NAME#v}", mimoc.__version__) for command in commands["release"])
    assert subprocess.run(check, shell=True, cwd=CHECKOUT, check=False).returncode == 0
    assert "CHANGELOG.md" in look


def test_the_changelog_has_each_change_under_a_release():
    headings = re.findall(r"(?m)^## (.*)$", (CHECKOUT / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert headings
    assert [text for text in headings if not re.fullmatch(r"Unreleased|\d+\.\d+\.\d+", text)] == []


def test_the_tail_of_the_page_on_own_parts_grows_moves_and_feels(monkeypatch, capsys):
    monkeypatch.chdir(CHECKOUT)
    (program,) = blocks("docs/own_part.md", "python")
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


DOCS = Path(__file__).resolve().parents[1] / "docs"
COMMANDS = "build", "check", "explain", "run", "train", "validate", "cohort run", "cohort table"


@pytest.fixture
def extension(monkeypatch) -> Callable[[str], ModuleType]:
    monkeypatch.setattr(sys, "path", [str(DOCS / "_ext"), *sys.path])
    return import_module


def test_the_reference_of_specs_has_every_key_once_in_its_section(extension):
    text = extension("spec_reference").reference("spec")
    language = language_of(InfantSpec)
    sections = dict(re.findall(r"^##+ `([\w.]+)`\n(.*?)(?=^##|\Z)", text, re.MULTILINE | re.DOTALL))
    assert {"body", "senses.touch", "delays", "scene.toys"} <= sections.keys()
    for name, section in sections.items():
        path = tuple(name.split("."))
        if not language.kinds_of(path):
            assert re.findall(r"^`(\w+)`$", section, re.MULTILINE) == list(language.outline(path).keys), name
    assert {f"task: {{kind: {kind}}}" for kind in language.kinds_of(("task",))} <= set(re.findall("`(.*?)`", text))


def test_the_reference_of_specs_says_what_values_there_are_with_their_units_and_defaults(extension):
    text = extension("spec_reference").reference("spec")
    assert "`age_months`\n: *number, at least 0, at most 24, in months; required*" in text
    assert "`hands`\n: *`mitten` or `five_finger`; default `mitten`*" in text
    assert "`motor`\n: *`maturing` or number, at least 0, at most 1; default `0.0`*" in text


@pytest.mark.parametrize("command", COMMANDS)
def test_the_reference_of_commands_has_the_options_that_help_shows(extension, invoke, monkeypatch, command):
    monkeypatch.setenv("COLUMNS", "200")
    text = extension("cli_reference").reference()
    section = re.search(rf"^##+ `mimoc {command}`\n(.*?)(?=^##|\Z)", text, re.MULTILINE | re.DOTALL)[1]
    entries = " ".join(re.findall(r"^`(.*)`$", section, re.MULTILINE))
    shown = " ".join(re.findall(r"^│[ *]+((?:--[\w-]+ +)+)", invoke(*command.split(), "--help").out, re.MULTILINE))
    assert set(shown.split()) - {"--help"} == set(re.findall(r"--[\w-]+", entries))


def test_the_reference_of_python_has_every_public_name_once():
    text = (DOCS / "api.md").read_text(encoding="utf-8")
    named = re.findall(r"^\.\. auto\w+:: (\w+)$", text, re.MULTILINE)
    assert sorted(named) == sorted(set(mimoc.__all__) - {"__version__"})


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
