"""Commands on specs that are not yet built, also from standard input, and on worlds of several infants."""

import csv
import os
import shutil
from pathlib import Path

import pytest
from PIL import Image
from support.worlds import ANNA, BEN, written

import mimoc

SPEC = "mimoc: 1\nname: piped\nage_months: 9\nsenses: {proprioception: {}, touch: {density: 0.1}}\n"
SMALL = "--width 32 --height 24"


@pytest.fixture
def run(invoke, here):
    return lambda arguments, piped="": invoke(*arguments.split(), piped=piped)


COMMANDS = {
    "run": "run {} --steps 3",
    "check": "check {}",
    "explain": "explain {} body.head.mass",
    "render": f"render {{}} -o picture.png {SMALL}",
    "see": "see {} -o picture.png --size 16 --ages 2",
    "train": "train {} -o runs --steps 64 --envs 1 --set n_steps=64 --set batch_size=64 --one-process",
}


def told(out: str) -> list[str]:
    """Return what a command says, but for how fast it was and how it came by the infant."""
    return [line for line in out.splitlines() if "steps/s" not in line and "files" not in line and "s of" not in line]


@pytest.mark.full
@pytest.mark.parametrize("command", [name for name in COMMANDS if name != "train"])
def test_a_spec_a_piped_spec_and_its_bundle_do_the_same(command, run):
    Path("piped.yaml").write_text(SPEC)
    mimoc.write_bundle(mimoc.build("piped.yaml"), "bundle")
    done, pictures = [], []
    for infant in ("bundle", "piped.yaml", "-"):
        code, out, err = run(COMMANDS[command].format(infant), SPEC)
        assert (code, err) == (0, "")
        done.append(told(out))
        pictures.append(Path("picture.png").read_bytes() if Path("picture.png").exists() else b"")
    assert done[0] == done[1] == done[2]
    assert pictures[0] == pictures[1] == pictures[2]
    assert sorted(set(os.listdir()) - {"picture.png"}) == ["bundle", "piped.yaml"]


def test_build_reads_a_pipe_and_keeps_what_it_read(run):
    code, out, err = run("build - -o out", SPEC)
    assert (code, err) == (0, "")
    assert "piped, 9 months" in out
    assert mimoc.read_bundle("out").files["spec.yaml"] == SPEC.encode()


def test_a_wrong_spec_in_a_pipe_is_told_line_by_line_and_nothing_is_written(run):
    code, out, err = run("build - -o out", SPEC.replace("9", "99") + "delay: {}\n")
    assert (code, out) == (2, "")
    assert err.splitlines() == [
        "<stdin>:3:13: age_months: 99 is too large; give 0 to 24 months",
        "<stdin>:5:1: delay: unknown key; did you mean 'delays'?",
    ]
    assert os.listdir() == []


@pytest.mark.parametrize(("piped", "said"), [("", "the file is empty"), ("#" * (2**20 + 1), "larger than 1 MiB")])
def test_a_pipe_without_a_spec_is_a_clear_line(piped, said, run):
    code, _, err = run("check -", piped)
    assert (code, len(err.splitlines())) == (2, 1)
    assert err.startswith("<stdin>:1:1: ")
    assert said in err


def test_paths_in_a_piped_spec_are_seen_from_the_current_folder(run):
    spec = f"{SPEC}scene: {{kind: room, textures: {{floor: papers}}}}\n"
    assert "<stdin>:5:" in run("build - -o out", spec)[2]
    Path("papers").mkdir()
    Image.new("RGB", (8, 8), (200, 10, 10)).save("papers/red.png")
    assert run("build - -o out", spec)[::2] == (0, "")


def test_rooms_are_drawn_of_a_bundle_too_and_say_where_only_toys_differ(run):
    Path("toys.yaml").write_text(f"{SPEC}scene: {{kind: flat, toys: {{count: [2, 2]}}}}\n")
    mimoc.write_bundle(mimoc.build("toys.yaml"), "out")
    sheets = []
    for infant in ("toys.yaml", "out"):
        code, out, err = run(f"rooms {infant} --seeds 0:2 --size 32 -o rooms.webp")
        assert (code, out) == (0, "rooms.webp\n")
        assert err == "note: in a 'flat' scene only the toys depend on the seed\n"
        sheets.append(Path("rooms.webp").read_bytes())
    assert sheets[0] == sheets[1]


@pytest.mark.parametrize(
    ("name", "format"),
    [("a.png", "PNG"), ("a.jpg", "JPEG"), ("a.JPEG", "JPEG"), ("a.webp", "WEBP"), ("a.bmp", "BMP"), ("a.tiff", "TIFF")],
)
def test_a_picture_is_what_its_name_says(name, format, run):
    Path("piped.yaml").write_text(SPEC)
    assert run(f"render piped.yaml -o {name} {SMALL}") == (0, f"{name}\n", "")
    with Image.open(name) as picture:
        assert (picture.format, picture.size) == (format, (32, 24))


def test_explain_lists_finds_and_explains(run):
    Path("piped.yaml").write_text(SPEC)
    mimoc.write_bundle(mimoc.build("piped.yaml"), "out")
    listed = run("explain out")[1].splitlines()
    assert "body.left_foot: mass pos" in listed
    assert len(listed) < 250
    found = run("explain out left_foot")[1].splitlines()
    assert len(found) > 3
    assert all("left_foot" in line and " = " in line for line in found)
    assert run("explain out LEFT_FOOT.MASS")[1] == run("explain out body.left_foot.mass")[1]


def test_lines_in_a_pipe_are_whole_whatever_the_environment_says_of_terminals(run, monkeypatch):
    Path("piped.yaml").write_text(SPEC)
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "40")
    lines = run("explain piped.yaml body.left_foot.mass")[1].splitlines()
    assert max(map(len, lines)) > 80


def test_an_infant_in_a_file_of_another_name_is_refused_with_what_would_do(run):
    Path("notes.txt").write_text(SPEC)
    assert run("check notes.txt") == (
        2,
        "",
        "notes.txt: this is a file; name the folder of a bundle, or a spec that ends in .yaml or .yml\n",
    )


@pytest.mark.extras
def test_train_takes_a_piped_spec(run):
    code, out, _ = run(COMMANDS["train"].format("-"), SPEC)
    assert code == 0
    assert "trained for 64 control steps" in out
    assert mimoc.read_bundle("runs/bundle").files["spec.yaml"] == SPEC.encode()
    shutil.rmtree("runs")


def test_a_child_without_a_scale_is_not_judged_by_who(invoke, here):
    (here / "kim.yaml").write_text("mimoc: 1\nname: kim\nage_months: 3\nbody: {size_is_known: false}\n")
    done = invoke("validate", "kim.yaml")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(
        "kim.yaml: scale not known, so that no growth standard says anything of it; give its length"
    )
    assert done.err.count("\n") == 1


def test_a_length_contradicts_a_size_that_is_not_known(invoke, here):
    (here / "kim.yaml").write_text(
        "mimoc: 1\nname: kim\nage_months: 3\nbody: {size_is_known: false, individual: {length_cm: 60}}\n"
    )
    done = invoke("build", "kim.yaml", "-o", "out")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "body.size_is_known: contradicts 'length_cm' of 'individual'" in done.err


PAIRS = (("anna", "ben"), ("ben", "anna"))
PAIR = "infants: [anna.yaml, ben.yaml]\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("world")
    mimoc.write_bundle(mimoc.build_world(written(folder, PAIR, anna=ANNA, ben=BEN)), folder / "out")
    return folder


def test_a_world_is_built_with_the_measures_of_each(invoke, tmp_path):
    path = written(tmp_path, PAIR, anna=ANNA, ben=BEN)
    done = invoke("build", str(path), "-o", str(tmp_path / "out"))
    assert "anna, 9 months" in done.out
    assert "ben, 3 months" in done.out
    assert (tmp_path / "out" / "infants" / "ben" / "manifest.json").is_file()


def test_a_bad_world_leaves_nothing_behind(invoke, tmp_path):
    path = written(tmp_path, "infants: [anna.yaml, none.yaml]\n", anna=ANNA)
    done = invoke("build", str(path), "-o", str(tmp_path / "out"))
    assert done.code == 2
    assert done.err.splitlines()[-1].startswith(f"{path}:3:22: infants[1]: none.yaml: the file does not exist")
    assert not (tmp_path / "out").exists()


def test_a_world_is_checked(invoke, folder):
    done = invoke("check", str(folder / "out"))
    assert done.code == 0
    assert "files are unchanged" in done.out
    assert "start: no warnings" in done.out
    assert "of the world compile" in invoke("check", str(folder / "world.yaml")).out


def test_its_numbers_are_explained_by_infant(invoke, folder):
    out = str(folder / "out")
    assert "ben.body.head.mass = " in invoke("explain", out, "head.mass").out
    assert "scene.xml: body[@name='ben_head']/geom/@mass" in invoke("explain", out, "ben.body.head.mass").out
    assert "side by side along y" in invoke("explain", out, "place.ben.y_m").out


def test_it_is_drawn_and_filmed(invoke, folder, tmp_path):
    picture, film = tmp_path / "two.png", tmp_path / "two.gif"
    assert invoke("render", str(folder / "out"), "-o", str(picture), "--width", "64", "--height", "48").code == 0
    with Image.open(picture) as drawn:
        assert drawn.size == (64, 48)
    run = ["run", str(folder / "out"), "--policy", "general_movements+reflexes", "--steps", "8", "--size", "64"]
    done = invoke(*run, "--video", str(film))
    assert done.code == 0
    assert "anna" in done.out
    assert "ben" in done.out
    with Image.open(film) as filmed:
        assert getattr(filmed, "n_frames", 1) >= 2


def test_it_is_drawn_in_another_pose_with_the_points_of_all_skins(invoke, folder, tmp_path):
    pictures = {}
    for name, options in {"as it is": [], "standing": ["--pose", "standing"], "skin": ["--skin"]}.items():
        picture = tmp_path / f"{name}.png"
        sized = ["--width", "64", "--height", "48", *options]
        assert invoke("render", str(folder / "out"), "-o", str(picture), *sized).code == 0
        pictures[name] = picture.read_bytes()
    assert len(set(pictures.values())) == 3


def test_it_is_built_in_the_scene_of_another_seed(invoke, folder, tmp_path):
    text = PAIR + "scene: {kind: room, toys: {count: [2, 2]}}\n"
    path = written(tmp_path, text, anna=ANNA, ben=BEN)
    assert invoke("build", str(path), "-o", str(tmp_path / "out"), "--seed", "3").code == 0
    bundle = mimoc.read_world_bundle(tmp_path / "out")
    assert bundle.manifest.seed == 3
    assert bundle.manifest.toys != mimoc.build_world(path).manifest.toys
    again = mimoc.build_world(bundle.path / "resolved.yaml")
    assert again.files["scene.xml"] == bundle.files["scene.xml"]


def test_each_infant_has_a_policy_from_the_command_line(invoke, folder):
    done = invoke(
        "run", str(folder / "world.yaml"), "--policy", "anna=look_at:ben,ben=general_movements", "--steps", "3"
    )
    assert done.code == 0
    assert "Error of the gaze" in done.out


def test_from_a_file_to_a_recording_a_table_of_contacts_and_gaze_and_a_film(invoke, folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = invoke("run", folder / "out", "--steps", 12, "--record", "kept", "--movement", "contacts,gaze")
    assert (done.code, done.err) == (0, "")
    assert done.out.endswith("\nkept\n")
    done = invoke("measure", "kept", "--contacts", "contacts.csv")
    assert (done.code, done.out, done.err) == (0, "contacts.csv\n", "")
    with (tmp_path / "contacts.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["other_part"] == "any"]
    found = [(row["infant"], row["does"], row["other"]) for row in rows]
    assert found == [(who, does, whom) for who, whom in PAIRS for does in ("touches", "looks at")]
    printed = invoke("measure", "kept")
    assert printed.code == 0
    assert all(words in printed.out for words in ("anna", "ben", "anna touches ben", "ben looks at anna"))
    replayed = invoke("replay", "kept", "--video", "two.gif", "--size", 64)
    told = "ok: all numbers of 2 episodes, 24 control steps, came out again\ntwo.gif\n"
    assert (replayed.code, replayed.out, replayed.err) == (0, told, "")
    assert invoke("replay", "kept", "--infant", "ben").out.startswith("ok: all numbers of 1 episode, 12 ")
    assert invoke("export", "kept", "--to", "csv", "-o", "tables").code == 0
    assert (tmp_path / "tables" / "0001-000000.csv").is_file()


def test_each_infant_has_its_policy_its_task_and_its_healthy_counterpart(invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own_task.py").write_text(
        "class Height:\n    def judge(self, data, action, effort):\n        return float(data.qpos[2])\n"
    )
    weak = {**BEN, "impairments": {"weakness": {"right_arm": 0.1}}}
    path = str(written(tmp_path, PAIR, anna=ANNA, ben=weak))
    run = ["run", path, "--policy", "anna=random", "--policy", "ben=zero", "--steps", "3", "--task", "own_task:Height"]
    done = invoke(*run, "--beside", "healthy", "--eyes", "--video", "both.gif", "--size", "64")
    assert done.code == 0, done.err
    assert [name.strip() for name in done.out.splitlines()[2].strip("┃").split("┃")][1:] == [
        "anna",
        "ben",
        "anna, healthy",
        "ben, healthy",
    ]
    evaluated = invoke("evaluate", path, "--policy", "ben=random", "--episodes", "2", "--steps-per-episode", "3")
    assert evaluated.code == 0, evaluated.err
    assert "2 episodes, seeds 0 to 1" in evaluated.out
    own = ["--episodes", "2", "--steps-per-episode", "3", "--task", "own_task:Height"]
    beside = [invoke("evaluate", path, "--policy", "random", *own, "--envs", str(envs)) for envs in (1, 2)]
    assert beside[0].code == 0, beside[0].err
    assert beside[0].out == beside[1].out
    told = "'bne' is not a name of an infant of this world; did you mean 'ben'?\n"
    assert invoke("run", path, "--policy", "bne=zero").err == told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "--infant", "bem", "--video", "a.gif"], "'bem' is not a name of an infant here; did you mean 'ben'?"),
        (["run", "--policy", "bob=sit"], "'bob' is not a name of an infant of this world"),
        (["build", "-o", "out", "--for", "mimo"], "--for is for a single infant"),
        (["render", "-o", "a.png", "--pose", "crawling"], "'crawling' is not a pose of 'anna'"),
        (["render", "-o", "a.png", "--crop", "head"], "--crop head draws the head of one infant"),
        (["view", "-o", "a.html", "--physics"], "--physics is for a single infant"),
        (["see", "-o", "a.png", "--infant", "bob"], "'bob' is not a name of an infant of this world"),
        (["rooms", "-o", "a.png"], "'flat' without toys is the same for every seed"),
        pytest.param(
            ["train", "-o", "out", "--one-process"],
            "worlds of a training are in one process",
            marks=pytest.mark.extras,
        ),
    ],
)
def test_what_is_for_single_infants_is_refused_in_one_line(invoke, folder, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    command, *rest = arguments
    done = invoke(command, str(folder / "world.yaml"), *rest)
    assert done.code != 0
    assert message in done.err
    assert "Traceback" not in done.err
    assert list(tmp_path.iterdir()) == []
