"""The folder of a retargeted recording: a recording of mimoc, all or nothing, whose child can be run."""

import numpy as np
import pytest
from support.motions import moved, retargeted
from support.store import built

import mimoc
from mimoc.base.errors import MimocError, OutputError
from mimoc.motion.joint_motion import JointMotion
from mimoc.movement.retargeting import folder as folders
from mimoc.movement.retargeting.folder import altered, write_retargeted
from mimoc.viewer.episode_page import points_of

SPEC = {
    "mimoc": 1,
    "name": "kim",
    "age_months": 3,
    "scene": {"kind": "flat", "pose": "supine"},
    "senses": {"proprioception": {}},
    "actuation": {"model": "muscle"},
}


@pytest.fixture(scope="module")
def motion() -> JointMotion:
    return moved(built(SPEC), 0.6)


@pytest.fixture(scope="module")
def out(motion, tmp_path_factory):
    return write_retargeted(retargeted(built(SPEC), motion), tmp_path_factory.mktemp("out") / "kim")


def test_it_reads_back_as_it_was_written(out, motion):
    result = mimoc.read_retargeted(out)
    assert np.array_equal(result.motion.qpos, motion.qpos)
    assert result.recording.frames == result.fitted.frames == len(motion.qpos)
    assert result.account["limits_touched"] == {"robot:left_knee": 0.25}
    assert result.bundle.manifest.name == "kim"


def test_it_is_a_recording_that_comes_out_again(out, motion):
    frames = []
    (replayed,) = mimoc.replay_recording(out, watch=lambda env, observation: frames.append(env.data.qpos.copy()))
    assert replayed.difference is None
    wanted = motion.at(0.01 * np.arange(len(frames))).qpos
    errors_deg = np.degrees(np.array(frames) - wanted)[:, 7:]
    assert np.sqrt((errors_deg**2).mean()) < 1.0


def test_it_says_that_touch_in_it_is_not_physical(out):
    assert "Take senses from such a run" in (out / "README.md").read_text()


def test_its_child_can_be_made(out):
    assert mimoc.make(out).unwrapped.manifest.name == "kim"


def test_its_page_knows_the_points(out, tmp_path):
    points = points_of(out)
    assert points is not None
    assert points["recorded"].shape == points["fitted"].shape
    assert np.allclose(points["errors"], 0.0)
    assert points_of(tmp_path) is None


def test_another_folder_is_never_replaced(out, motion, tmp_path):
    result = retargeted(built(SPEC), motion)
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="not empty and no retargeted recording"):
        write_retargeted(result, tmp_path, force=True)
    with pytest.raises(OutputError, match="replace it with --force"):
        write_retargeted(result, out)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    write_retargeted(result, out, force=True)
    assert mimoc.read_retargeted(out).motion.rate_hz == motion.rate_hz


def test_a_failed_write_leaves_nothing(motion, tmp_path, monkeypatch):
    def fail(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(folders, "pack_motion", fail)
    with pytest.raises(KeyboardInterrupt):
        write_retargeted(retargeted(built(SPEC), motion), tmp_path / "kim")
    assert list(tmp_path.iterdir()) == []


def test_no_folder_is_one_line(tmp_path):
    with pytest.raises(MimocError, match="this is not a retargeted recording"):
        mimoc.read_retargeted(tmp_path)


def test_the_child_can_have_other_senses(motion):
    result = altered(retargeted(built(SPEC), motion), ["vestibular"], "torque")
    manifest = result.bundle.manifest
    assert manifest.senses.vestibular is not None
    assert manifest.senses.proprioception is None
    assert manifest.actuation.model == "torque"


@pytest.mark.parametrize("place", ["/proc/kim", "file/kim", "missing/file/kim"])
def test_a_place_that_cannot_be_written_is_refused_before_anything_is_fitted(tmp_path, invoke, place, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    (tmp_path / "missing").mkdir()
    (tmp_path / "missing" / "file").touch()
    refused = invoke("retarget", "no_such_points.csv", "-o", place, "--age", "3")
    assert (refused.code, refused.out) == (2, "")
    assert refused.err.startswith(f"{place}: cannot be written (")
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "file", "missing"]
