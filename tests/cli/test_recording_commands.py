"""Commands on recordings, and `mimoc retarget`, whose folder is one."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from support.motions import moved, retargeted
from support.store import built

import mimoc
from mimoc.bundle.model import load_model
from mimoc.cli.movement import print_account
from mimoc.motion.body_points import film


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


SPEC = {"mimoc": 1, "name": "kim", "age_months": 3, "scene": {"kind": "flat", "pose": "supine"}}


@pytest.fixture(scope="module")
def built_result():
    bundle = built({**SPEC, "senses": {"proprioception": {}}})
    return retargeted(bundle, moved(bundle, 0.6))


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    bundle = built({**SPEC, "senses": {"proprioception": {}}})
    motion, model = moved(bundle, 0.6), load_model(bundle)
    seen = film(model, motion.qpos, motion.rate_hz)
    mirrored = replace(seen, positions=seen.positions * [-1, 1] + [640, 0])
    return mimoc.write_points(mirrored, tmp_path_factory.mktemp("points") / "kim.npz")


@pytest.mark.full
@pytest.mark.slow
def test_a_mirrored_recording_becomes_a_child_that_moves(points, tmp_path, invoke):
    out = tmp_path / "kim"
    arguments = ["retarget", str(points), "-o", str(out), "--age", "3"]
    code, *texts = invoke(*arguments)
    assert code == 2
    assert "mirrored (--view mirrored)" in "".join(map(str, texts))
    code, output = invoke(*arguments, "--view", "mirrored")[:2]
    assert code == 0, output
    assert "of the trunk" in output
    assert "overall size is known" in output
    assert np.isfinite(mimoc.read_retargeted(out).motion.qpos).all()
    for arguments in (["replay", str(out)], ["run", str(out), "--policy", "motion", "--root", "assisted"]):
        code, output = invoke(*arguments)[:2]
        assert code == 0, output
    assert "Assisted force median" in output
    assert "left_knee" in output


def test_an_age_is_needed_without_a_spec(points, tmp_path, invoke):
    done = invoke("retarget", str(points), "-o", str(tmp_path / "kim"))
    message = "how old the infant is, is not known; give its age with --age, or a --spec"
    assert (done.code, done.out, done.err) == (2, "", f"{points}: {message}\n")


def test_intervals_are_printed_with_their_level(capsys, built_result):
    print_account(built_result)
    out = capsys.readouterr().out
    assert "trunk         20.0 cm (90 %: 19.0 to 21.0)" in out
    assert "camera          1.08 m above the floor (90 %: 1.00 to 1.20)" in out
    assert "scale not known" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--camera", "1,2,3"], "is not a camera"),
        (["--format", "betamax"], "betamax"),
        (["--view", "side"], "'side' is not a view; choose from back, front, mirrored, swapped"),
        (["--rate", "nan"], ""),
        (["--name", "left_knee"], "'left_knee' is no label with its point; write it as p7=left_foot"),
        (["--name", "p7=tail"], "'tail' is not a point"),
    ],
)
def test_bad_options_are_refused_and_nothing_is_written(points, tmp_path, invoke, arguments, message):
    code, *texts = invoke("retarget", str(points), "-o", str(tmp_path / "kim"), "--age", "3", *arguments)
    assert code == 2
    assert message in "".join(map(str, texts))
    assert list(tmp_path.iterdir()) == []


def test_the_root_belongs_to_motions(tmp_path, invoke):
    spec = tmp_path / "kim.yaml"
    spec.write_text("mimoc: 1\nname: kim\nage_months: 3\n")
    code, *texts = invoke("run", str(spec), "--root", "free")
    assert code == 2
    assert "--root says how the trunk follows a motion" in "".join(map(str, texts))
