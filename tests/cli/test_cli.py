"""What each command does, and what it says of bad input."""

import json
import os
import re
import shlex
import shutil
from pathlib import Path

import pytest
from support.full import full_rows

import mimoc
from mimoc.bundle.io import LOCK, lock_files
from mimoc.studies import growth, movement
from mimoc.studies.movement import TRIALS

CONFIGS = Path(__file__).parents[2] / "configs"
SPEC = str(CONFIGS / "nine_months.yaml")
PNG = b"\x89PNG\r\n\x1a\n"


# What the commands do.


def test_build_writes_a_bundle_and_describes_it(invoke, here):
    done = invoke("build", SPEC, "-o", "out")
    assert (done.code, done.err) == (0, "")
    child = mimoc.read_bundle("out").manifest.child
    for said in ("nine_months, 9 months", f"{child.length_cm:.2f}", f"{child.weight_kg:.2f}", "WHO percentile"):
        assert said in done.out
    assert "out: open out/scene.xml with MuJoCo, or try: mimoc run out" in done.out


def test_build_replaces_a_bundle_only_with_force(invoke, here):
    assert invoke("build", SPEC, "-o", "out").code == 0
    before = {path: path.read_bytes() for path in (here / "out").rglob("*") if path.is_file()}
    refused = invoke("build", CONFIGS / "newborn.yaml", "-o", "out")
    assert refused.code == 2
    assert "--force" in refused.err
    assert {path: path.read_bytes() for path in (here / "out").rglob("*") if path.is_file()} == before
    assert invoke("build", CONFIGS / "newborn.yaml", "-o", "out", "--force").code == 0
    assert mimoc.read_bundle("out").manifest.name == "newborn"


def test_validate_prints_every_month_and_a_verdict(invoke, here):
    done = invoke("validate")
    assert (done.code, done.err) == (0, "")
    for indicator in ("Length", "Weight", "Head circumference", "Upper-arm circumference"):
        assert f"{indicator} [" in done.out
    assert len(re.findall(r"^│ +\d+ ", done.out, re.MULTILINE)) == 3 * 25 + 22
    assert "ok: within one SD" in done.out


@pytest.mark.full
def test_validate_gives_numbers_to_other_programs(invoke, here, one_age):
    done = invoke("validate", one_age, "--json", "--plot", "growth.png")
    report = json.loads(done.out)
    assert (done.code, done.err, report["passed"]) == (0, "", True)
    assert {"length_cm", "weight_kg", "head_circumference_cm"} <= report["worst"].keys()
    assert Path("growth.png").read_bytes().startswith(PNG)


SMALL = "mimoc: 1\nname: kim\nage_months: 7\nbody: {individual: {sex: male, length_percentile: 3}}\n"
BROAD = "mimoc: 1\nname: kim\nage_months: 7\nbody: {measurements: {upper_arm_circumference_cm: 16}}\n"
VALIDATED = [("who", ""), ("who", SMALL), ("who", BROAD), ("anthrokids", ""), ("anthrokids", BROAD)]


@pytest.mark.full
@pytest.mark.parametrize(("against", "text"), full_rows([("who", ""), ("anthrokids", BROAD)], VALIDATED))
def test_tables_of_validate_fit_80_columns_and_have_no_empty_column(invoke, here, against, text):
    Path("kim.yaml").write_text(text)
    done = invoke("validate", *(["kim.yaml"] if text else []), "--against", against)
    assert (done.code, done.err) == (0, "")
    check_tables(done.out)


def test_movement_is_tried_at_the_ages_asked_for_and_fails_outside_its_windows(invoke, here, monkeypatch):
    kick, rest = TRIALS["kick"], TRIALS["rest"]
    rows = [
        movement.Row("rest", rest.measures[0], 0.0, -55.0, movement.window_of("rest_hip_deg", 0.0)),
        movement.Row("kick", kick.measures[1], 3.0, 0.5, movement.window_of("kick_s", 3.0)),
    ]
    for count, code in ((1, 0), (2, 1)):
        report = movement.MovementReport("maturing", "torque", rows[:count])
        monkeypatch.setattr(movement, "validate_movement", lambda *_, report=report, **__: report)
        done = invoke("validate", "--against", "movement", "--ages", "0,3", "--plot", "movement.svg")
        assert (done.code, done.err) == (code, "")
        check_tables(done.out)
        assert Path("movement.svg").exists()
    assert json.loads(invoke("validate", "--against", "movement", "--json").out)["passed"] is False


@pytest.mark.full
def test_trials_of_movement_are_those_asked_for(invoke, here):
    done = invoke("validate", "--against", "movement", "--trials", "rest,damping", "--ages", "0", "--json")
    assert list(json.loads(done.out)["trials"]) == ["rest", "damping"]
    assert "did you mean 'roll'" in invoke("validate", "--against", "movement", "--trials", "rol").err
    assert invoke("validate", "--trials", "roll").code == 2


def check_tables(text):
    """Check the width of each table, and that each of its columns has a heading and something below."""
    lines = [line for line in text.splitlines() if line.startswith(tuple("┏┃┡│└"))]
    assert max(map(len, lines)) <= 80
    tables = "\n".join(lines).split("┏")[1:]
    assert tables
    for table in tables:
        _, head, _, *rows, _ = table.splitlines()
        assert all(cell.strip() for cell in head.split("┃")[1:-1])
        assert all(any(map(str.strip, cells)) for cells in zip(*(row.split("│")[1:-1] for row in rows), strict=True))


def test_validate_fails_outside_one_sd(invoke, monkeypatch):
    row = growth.GrowthRow(3.0, "weight_kg", 9.0, {"male": 1.1, "female": 1.3, "mean": 1.2})
    monkeypatch.setattr(growth, "grow_against_who", lambda *_, **__: growth.GrowthReport((row,)))
    done = invoke("validate")
    assert done.code == 1
    assert re.search(r"\+1\.20\* .* missed *│$", done.out, re.MULTILINE)
    verdict = "failed: not within one SD of the mean of WHO's boys and girls at every age: weight_kg"
    assert " ".join(done.out.split()).endswith(verdict)
    assert invoke("validate", "--json").code == 1


@pytest.mark.parametrize("policy", ["random", "zero"])
def test_run_prints_a_summary(invoke, built, policy):
    done = invoke("run", built, "--policy", policy, "--steps", 30)
    assert (done.code, done.err) == (0, "")
    assert "30 control steps, 0.3 s simulated" in done.out
    assert re.search(r"^\d+ steps/s, [\d.]+ times real time$", done.out, re.MULTILINE)


def test_run_says_what_behaviours_know_that_no_sense_tells(invoke, here):
    """Of each infant of a world, below the table."""
    senses = "senses: {proprioception: {}, vestibular: {}, touch: {}}"
    for name, told in (("ann", "senses: {touch: {}}"), ("ben", senses)):
        (here / f"{name}.yaml").write_text(f"mimoc: 1\nname: {name}\nage_months: 9\n{told}\n")
    infants = "[{name: ann, spec: ann.yaml}, {name: ben, spec: ben.yaml, x_cm: 90}]"
    (here / "both.yaml").write_text(f"mimoc: 1\nname: both\nscene: {{kind: flat}}\ninfants: {infants}\n")
    done = invoke("run", "both.yaml", "--policy", "sit", "--steps", 1)
    assert (done.code, done.err) == (0, "")
    missing = "add 'proprioception' and 'vestibular' to the senses"
    read = "it reads the true state of its body, as no sense tells"
    _, *notes = " ".join(done.out.split()).split("note: ")
    (note,) = notes
    assert note.startswith(f"ann: {read} the angles of joints and the tilt of the trunk")
    assert note.endswith(missing)


def test_run_reports_episodes_if_there_is_a_task(invoke, built, here):
    (here / "turning.yaml").write_text("mimoc: 1\nname: x\nage_months: 9\ntask: {kind: rollover, steps: 20}\n")
    assert invoke("build", "turning.yaml", "-o", "turning").code == 0
    for steps, told in ((10, {"episodes": "0"}), (40, {"episodes": "2", "succeed": "0"})):
        lines = invoke("run", "turning", "--steps", str(steps)).out.splitlines()
        shown = {line.split()[-4]: line.split()[-2] for line in lines if line.startswith("│")}
        assert {name: shown.get(name) for name in ("episodes", "succeed")} == {"succeed": None, **told}
    assert "succeed" not in invoke("run", str(built), "--steps", "10").out


def test_run_with_the_same_seed_prints_the_same_summary(invoke, built):
    def numbers(seed):
        return invoke("run", built, "--steps", 50, "--seed", seed).out.splitlines()[:-1]

    assert numbers(1) == numbers(1) != numbers(2)


def test_check_passes_an_intact_and_stable_bundle(invoke, built):
    done = invoke("check", built)
    assert (done.code, done.err) == (0, "")
    words = [line.split(maxsplit=1)[0] for line in done.out.splitlines()]
    assert words == ["ok"] * 5


def test_check_fails_an_unstable_bundle(invoke, built, here):
    """Intact, as its lock fits, but with motors as strong as a crane's."""
    files = dict(mimoc.read_bundle(built).files)
    files["scene.xml"] = re.sub(rb'gear="[^"]+"', b'gear="1e9"', files["scene.xml"])
    files.pop(LOCK)
    mimoc.write_bundle(lock_files(files, versions={}, inputs={}), "crane")
    done = invoke("check", "crane")
    assert (done.code, done.err) == (1, "")
    assert "failed supine: BADQ" in done.out
    assert os.listdir() == ["crane"]  # No log of MuJoCo's.


def test_explain_traces_a_number_from_the_xml_to_the_table(invoke, built):
    done = invoke("explain", built, "body.left_foot.mass")
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith("body.left_foot.mass = ")
    for said in ("written to infant.xml", "anthrokids.csv:", "spec.yaml:"):
        assert said in done.out


def test_render_draws_a_picture_of_the_size_and_pose_asked_for(invoke, built, here):
    done = invoke("render", built, "-o", "sitting.png", "--width", 64, "--height", 48)
    assert (done.code, done.out, done.err) == (0, "sitting.png\n", "")
    assert invoke("render", built, "-o", "prone.png", "--pose", "prone", "--width", 64, "--height", 48).code == 0
    pictures = [Path(name).read_bytes() for name in ("sitting.png", "prone.png")]
    assert pictures[0] != pictures[1]
    for picture in pictures:
        assert picture.startswith(PNG)
        assert [int.from_bytes(picture[start : start + 4]) for start in (16, 20)] == [64, 48]


def test_import_replaces_a_spec_only_with_force(invoke, here):
    (here / "baby.yml").write_text("touch: true\n")
    (here / "mine.yaml").write_text("mine")
    done = invoke("import", "babybench", "baby.yml", "-o", "mine.yaml")
    assert (done.code, done.err) == (
        2,
        "mine.yaml: already exists; choose another file, or replace it with --force\n",
    )
    assert (here / "mine.yaml").read_text() == "mine"
    assert invoke("import", "babybench", "baby.yml", "-o", "mine.yaml", "--force").code == 0
    assert "touch" in (here / "mine.yaml").read_text()


def test_import_writes_a_spec_and_lists_settings_without_counterpart(invoke, here):
    Path("baby.yml").write_text("scene: crib\nsave_dir: results\n")
    done = invoke("import", "babybench", "baby.yml", "-o", "spec.yaml")
    *_, note, written = done.out.splitlines()
    assert (done.code, done.err) == (0, "")
    assert note.startswith("baby.yml:2:1: save_dir: no counterpart; ")
    assert written == "spec.yaml: try it with: mimoc build spec.yaml -o out/baby"
    assert mimoc.load_spec("spec.yaml").scene.kind == "crib"


# Bad input.

BAD_INPUT = {  # What is said, by the command.
    "build bad.yaml -o new": "bad.yaml:3:13: age_months: ",
    "build handless.yaml -o new": "handless.yaml:5:14: task.kind: task 'reach' requires right_fingers",
    "build nowhere.yaml -o new": "nowhere.yaml:1:1: the file does not exist",
    "build folder -o new": "folder:1:1: ",
    "build -o new": "Missing argument 'SPEC'",
    f"build {SPEC}": "Missing option '-o'",
    f"build {SPEC} -o bad.yaml": "bad.yaml: this is a file",
    f"build {SPEC} -o folder": "folder: this folder is not a bundle",
    f"build {SPEC} -o bad.yaml/new": "bad.yaml/new: cannot be written",
    f"build {SPEC} -o /proc/new": "/proc/new: cannot be written",
    "validate --against cdc": "'cdc' is not a comparison; choose from anthrokids, milestones, movement, skills, who",
    "validate --against who --ages 1": "only movements are tried at ages of choice; use it with --against movement",
    "validate --against milestones --without noises": "'noises' is not a part of the nervous system; did "
    "you mean 'noise'?",
    "validate --against who --without noise": "only milestones have delays and noise; use it with --against milestones",
    "validate --against milestones --delays": "milestones have delays and noise by default; '--without noise' is ",
    "validate --against milestones one.yaml --beside helthy": "'helthy' is not a child to stand beside; did you mean "
    "'healthy'?",
    "validate --against milestones one.yaml --beside healthy": "nothing impairs this child; give it impairments, or "
    "leave --beside out",
    "validate --against who --beside healthy": "only who tries stands beside another child; use --against milestones "
    "or movement",
    "run nowhere --beside healthy": "nowhere: --beside changes the spec",
    "report folder -o x.html --beside healthy": "folder: 'beside' changes the spec",
    "movement folder --beside healthy": "--beside is for an infant that is simulated; name a spec or a bundle, and its "
    "--policy",
    "validate --against movement --ages old": "'old' is not a list of ages",
    "validate nowhere.yaml": "nowhere.yaml:1:1: the file does not exist",
    "validate one.yaml --plot nowhere/x.png": "nowhere/x.png: cannot be written",
    "run nowhere": "nowhere: there is no such folder",
    "check folder": "folder: this is not a bundle",
    "explain folder/thesis.tex body.head.mass": "folder/thesis.tex: this is a file; name the folder",
    "run damaged": "damaged: infant.xml was changed",
    "check lacking": "lacking: scene.xml is missing",
    "run out --policy zreo": "'zreo' is not a policy; did you mean 'zero'?",
    "rooms configs/playroom.yaml --seeds 7:7 -o rooms.png": "'7:7' is a range of 0 seeds; give 1 to 400",
    "rooms configs/playroom.yaml --seeds many -o rooms.png": "'many' is not a range of seeds",
    "run out --steps 0": "'--steps'",
    "run out --steps many": "'--steps'",
    "run out --seed -1": "'--seed'",
    "explain out body.left_fot.mass": "did you mean 'body.left_foot.mass'",
    "explain out xyzzy": "without one, `mimoc explain` lists them all",
    "run bad.yaml": "bad.yaml:3:13: age_months: ",
    "render out -o x.doc": "end it in .png, .jpg, ",
    "see out -o x": "end it in .png, .jpg, ",
    "rooms out -o x.mp3": "end it in .png, .jpg, ",
    "validate --plot x.doc": "end it in .png, .svg, ",
    "rooms calm.yaml -o x.png": "calm.yaml:4:15: scene.kind: 'crib' without toys is the same",
    "rooms out -o x.png": "scene.kind: 'flat' without toys is the same for every seed",
    "render out -o x.png --pose sit": "'sit' is not a pose; ",
    "render out out -o x.png --pose sit": "'sit' is not a pose; ",
    "render out -o x.jpg --transparent": "end its name in .png, .webp, ",
    "render out -o x.png --distance 0": "'--distance'",
    "render out -o nowhere/x.png": "nowhere/x.png: cannot be written",
    "render out -o folder.png": "folder.png: cannot be written",
    "render out -o x.png --skin": "'nine_months' has no sense of touch",
    "render out -o x.png --width 100000": "'--width'",
    "import babybnch bad.yaml -o x.yaml": "'babybnch' is not a format to import from; did you",
    "import babybench nowhere.yml -o x.yaml": "nowhere.yml:1:1: the file does not exist",
    "import babybench baby.yml -o x.yaml": "baby.yml:1:8: touch: 'maybe' is not true or false;",
    "import babybench calm.yml -o ./calm.yml": "calm.yml: this is the configuration",
    "import babybench calm.yml -o no/x.yaml": "no/x.yaml: cannot be written",
    "biuld": "No such command 'biuld'",
    "run out --step 3": "No such option: --step",
}


def everything_in(folder):
    return {path.relative_to(folder): path.is_file() and path.read_bytes() for path in folder.rglob("*")}


@pytest.mark.parametrize(("command", "message"), BAD_INPUT.items())
def test_bad_input_ends_in_exit_code_2_with_one_clear_line_and_nothing_written(
    command, message, invoke, here, built, one_age
):
    (here / "bad.yaml").write_text("mimoc: 1\nname: x\nage_months: 99\n")
    (here / "handless.yaml").write_text(
        "mimoc: 1\nname: x\nage_months: 9\nbody: {remove: [right_hand]}\ntask: {kind: reach}\n"
    )
    (here / "one.yaml").write_text(one_age.read_text())
    (here / "baby.yml").write_text("touch: maybe\n")
    (here / "calm.yml").write_text("touch: true\n")
    (here / "calm.yaml").write_text("mimoc: 1\nname: x\nage_months: 9\nscene: {kind: crib}\n")
    (here / "folder").mkdir()
    (here / "folder" / "thesis.tex").touch()
    (here / "folder.png").mkdir()
    for name in {"out", "damaged", "lacking"} & set(command.split()):
        shutil.copytree(built, here / name)
    if "damaged" in command:
        with (here / "damaged" / "infant.xml").open("a") as file:
            file.write("\n")
    if "lacking" in command:
        (here / "lacking" / "scene.xml").unlink()
    before = everything_in(here)
    done = invoke(*shlex.split(command))
    assert done.code == 2
    assert message in " ".join(done.err.replace("│", " ").split())
    assert "Traceback" not in done.err
    assert len(done.err.splitlines()) == 1 or done.err.startswith("Usage: ")
    assert not done.out or "--plot nowhere" in command
    assert everything_in(here) == before


def test_every_problem_of_a_spec_is_reported_with_its_line(invoke, here):
    Path("spec.yaml").write_text("mimoc: 1\nname: X\nage_months: 99\nbody: {hands: miten}\n")
    lines = invoke("build", "spec.yaml", "-o", "out").err.splitlines()
    assert [line.split(": ")[0] for line in lines] == ["spec.yaml:2:7", "spec.yaml:3:13", "spec.yaml:4:15"]


def test_a_bug_in_mimoc_is_not_hidden(invoke, monkeypatch):
    monkeypatch.setattr(growth, "grow_against_who", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        invoke("validate")
