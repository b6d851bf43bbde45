"""Commands on worlds of several infants."""

import csv

import pytest
from PIL import Image
from support.worlds import ANNA, BEN, written

import mimoc

PAIRS = (("anna", "ben"), ("ben", "anna"))
PAIR = "infants: [anna.yaml, ben.yaml]\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a world's file, and its bundle in `out`."""
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
