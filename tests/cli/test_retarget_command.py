"""`mimoc retarget`, and what its folder is good for."""

from dataclasses import replace

import numpy as np
import pytest
from support.motions import moved, retargeted
from support.store import built

import mimoc
from mimoc.bundle.model import load_model
from mimoc.cli.retarget import print_account
from mimoc.motion.body_points import film

SPEC = {"mimoc": 1, "name": "kim", "age_months": 3, "scene": {"kind": "flat", "pose": "supine"}}


@pytest.fixture(scope="module")
def built_result():
    bundle = built({**SPEC, "senses": {"proprioception": {}}})
    return retargeted(bundle, moved(bundle, 0.6))


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """Return the file of what a camera sees of a known motion, mirrored."""
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
