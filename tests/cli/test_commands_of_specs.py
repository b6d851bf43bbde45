"""Commands accept a bundle, a spec, or a spec from standard input, and write images in the format of their names."""

import os
import shutil
from pathlib import Path

import pytest
from PIL import Image

import mimoc

SPEC = "mimoc: 1\nname: piped\nage_months: 9\nsenses: {proprioception: {}, touch: {density: 0.1}}\n"
SMALL = "--width 32 --height 24"


@pytest.fixture
def run(invoke, here):
    """Return what runs a command in an empty folder, some text in its standard input."""
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
