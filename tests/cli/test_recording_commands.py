"""Recording on the command line, and what becomes of it."""

import pytest
from PIL import Image

import mimoc


def test_a_run_is_recorded_replayed_filmed_and_exported(invoke, built, here):
    code, out, err = invoke("run", built, "--steps", 6, "--record", "kept")
    assert (code, err) == (0, "")
    assert out.endswith("\nkept\n")
    assert [each.steps for each in mimoc.read_recording("kept")] == [6]
    done = invoke("replay", "kept", "--video", "film.gif", "--size", 64)
    assert done == (0, "ok: all numbers of 1 episode, 6 control steps, came out again\nfilm.gif\n", "")
    with Image.open("film.gif") as film:
        assert film.n_frames == 2
    code, out, err = invoke("export", "kept", "--to", "csv", "-o", "tables")
    assert (code, out) == (0, "tables\n")
    assert err.startswith("note: ")
    assert (here / "tables" / "0000-000000.csv").is_file()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--record", "full"], "full: the folder is not empty and no recording; name a new or empty folder"),
        (["--record", "new", "--policy", "zreo"], "'zreo' is not a policy; did you mean 'zero'?"),
    ],
)
def test_bad_input_ends_in_exit_code_2_with_one_line_and_nothing_written(options, message, invoke, built, here):
    (here / "full").mkdir()
    (here / "full" / "letter.txt").write_text("dear")
    code, out, err = invoke("run", built, "--steps", 10**9, *options)
    assert (code, out, err) == (2, "", f"{message}\n")
    assert [path.name for path in here.rglob("*")] == ["full", "letter.txt"]


def test_several_infants_are_not_filmed_at_once(invoke, built, here):
    with mimoc.Recorder(mimoc.make_vec(built, num_envs=2), "two") as envs:
        envs.reset(seed=0)
    code, out, err = invoke("replay", "two", "--video", "film.gif")
    assert (code, out, err) == (2, "", "two: 2 infants are recorded here; choose one for --video with --infant\n")
    assert invoke("replay", "two", "--eyes").code == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "name the folder of a recording, or list what can be measured with --list"),
        (["nowhere"], "nowhere: there is no such folder; record one with 'mimoc run INFANT --record DIR'"),
        (["."], ".: there is no recording here"),
    ],
)
def test_what_cannot_be_measured_is_one_line(arguments, message, invoke, here):
    assert invoke("measure", *arguments) == (2, "", f"{message}\n")


def test_movement_is_chosen_for_a_recording_only(invoke, built, here):
    code, out, err = invoke("run", built, "--movement", "gaze")
    assert (code, out) == (2, "")
    assert err == "--movement says which movement columns are recorded; name a folder with --record\n"
