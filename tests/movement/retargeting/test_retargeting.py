"""Known motions of children come back from what a camera sees of them."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support.retargeting import known, known_motions

import mimoc
from mimoc.base.errors import MimocError, RecordingError, SpecError
from mimoc.bundle.model import load_model
from mimoc.compiler.explain import explain, find
from mimoc.compiler.provenance import who_percentiles
from mimoc.motion.body_points import locate
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.motion.read_mini_rgbd import JOINTS, POINTS
from mimoc.movement.filming import films_in
from mimoc.movement.report import measure_all
from mimoc.movement.retargeting import fitting
from mimoc.movement.retargeting.fitting import INTERRUPTED
from mimoc.movement.retargeting.result import QUANTILE, Retargeted
from mimoc.movement.retargeting.sizes import lengths_of
from mimoc.viewer.growth import describe_standards

import mini_rgbd  # isort: skip  # `support.retargeting` puts benchmarks on the path.


def off_m(result: Retargeted, model, qpos) -> np.ndarray:
    """Return distances of points from the truth, shape (t, k)."""
    names = result.recording.names
    return np.linalg.norm(locate(model, qpos, names) - locate(load_model(result.bundle), result.qpos, names), axis=-1)


def start(spec):
    """Return the average child of the same age and hands."""
    return mimoc.InfantSpec(mimoc=1, name="fitted", age_months=spec.age_months, scene=spec.scene).with_(
        body={"hands": spec.body.hands}
    )


@pytest.fixture(scope="module")
def seen():
    """Return a child, its motion, its model, and the fit to a recording with depth."""
    spec, qpos, model, recording = known(5, depth_noise_m=0.01)
    return spec, qpos, model, mimoc.retarget(recording, spec.age_months, start(spec))


def test_with_depth_joints_angles_and_lengths_come_back(seen):
    _, qpos, model, result = seen
    fitted = load_model(result.bundle)
    assert result.account.error_share < 0.01
    assert np.median(off_m(result, model, qpos)) < 0.01
    truth = lengths_of(model)
    errors = [abs(interval.value / truth[name] - 1) for name, interval in result.account.lengths_m.items()]
    assert np.median(errors) < 0.03
    off_rad, inside = [], []
    for index, name in enumerate(result.account.joints):
        off = np.abs(result.qpos[:, fitted.joint(name).qposadr[0]] - qpos[:, model.joint(name).qposadr[0]])
        sd = result.account.angle_sd_rad[:, index]
        off_rad.append(off[sd < np.radians(10)])
        inside.append(off < QUANTILE * sd)
    assert np.degrees(np.median(np.concatenate(off_rad))) < 8
    assert 0.75 < np.mean(inside) < 0.97


def test_no_limit_is_broken(seen):
    result = seen[-1]
    model = load_model(result.bundle)
    angles = result.qpos[:, model.jnt_qposadr[1:]]
    fitted = [model.joint(name).id - 1 for name in result.account.joints]
    assert (angles[:, fitted] >= model.jnt_range[1:][fitted, 0] - 1e-12).all()
    assert (angles[:, fitted] <= model.jnt_range[1:][fitted, 1] + 1e-12).all()
    bend = [result.qpos[:, model.joint(f"robot:hip_bend{i}").qposadr[0]] for i in (1, 2)]
    assert bend[0] == pytest.approx(bend[1])


def test_the_compiled_child_has_the_lengths_of_the_account(seen):
    result = seen[-1]
    lengths = lengths_of(load_model(result.bundle))
    assert {name: interval.value for name, interval in result.account.lengths_m.items()} == pytest.approx(
        {name: lengths[name] for name in result.account.lengths_m}
    )


def test_the_account_is_plain_data(seen):
    data = seen[-1].account.to_data()
    assert data["frames"] == 90
    assert data["size_is_known"] is True
    assert set(data["camera_height_m"]) == {"value", "low", "high"}
    assert all(isinstance(value, float) for value in data["angle_sd_deg"].values())


@pytest.mark.full
def test_with_one_camera_and_outliers_the_points_are_where_they_are_seen():
    """A few points are on the wrong side for some frames; size stays the average child's."""
    spec, _, _, recording = known(6, frames=48)
    positions = recording.positions.copy()
    left, right = (recording.names.index(f"{side}_ankle") for side in ("left", "right"))
    positions[30:36, [left, right]] = positions[30:36, [right, left]]
    result = mimoc.retarget(replace(recording, positions=positions), spec.age_months, start(spec))
    assert result.account.error_share < 0.012
    assert not result.account.size_is_known
    assert any("average child" in note for note in result.account.notes)
    clean = np.linalg.norm(result.fitted - recording.positions, axis=-1)[30:36, [left, right]]
    assert np.nanmedian(clean) < 0.1 * recording.trunk


@pytest.fixture(scope="module")
def filmed():
    """Return a child and what one camera sees of it, from which overall size is not known."""
    spec, _, _, recording = known(7, frames=12)
    return spec, replace(recording, depth_m=None)


def test_a_child_without_a_scale_is_compared_with_no_standard(filmed, tmp_path):
    spec, recording = filmed
    result = mimoc.retarget(recording, spec.age_months)
    assert any(note.startswith("scale not known") for note in result.account.notes)
    for bundle in (result.bundle, mimoc.build(result.spec)):
        assert who_percentiles(bundle.manifest.child) == {}
        assert any(note.startswith("scale not known") for note in bundle.manifest.notes)
        with pytest.raises(MimocError, match="no number of this bundle has 'who'"):
            find(bundle, "who")
        assert "scale not known" in explain(bundle, "child.length_cm").lines[1]
        assert describe_standards([bundle.manifest.child])["percentiles"] is None
    folder = mimoc.write_retargeted(result, tmp_path / "out")
    assert "scale not known" in (folder / "README.md").read_text()
    seen = replace(recording, positions=recording.positions.repeat(6, axis=0), confidence=np.ones((72, 21)))
    (folder / "points.npz").unlink()
    mimoc.write_points(seen, folder / "points.npz")
    assert any(note.startswith("scale not known") for note in measure_all(films_in(folder)).notes)
    page = mimoc.report(folder, tmp_path / "page.html", check=False).read_text()
    assert "Scale not known" in page
    assert not re.search("unusually|of 100 |WHO Child Growth", page)


@pytest.mark.full
def test_a_length_in_the_spec_fixes_the_scale(filmed):
    _, recording = filmed
    length_cm = 68.0
    spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=4, body={"individual": {"length_cm": length_cm}})
    result = mimoc.retarget(recording, spec=spec)
    child = result.bundle.manifest.child
    assert child.length_cm == pytest.approx(length_cm, rel=2e-3)
    assert result.spec.body.individual.length_cm == length_cm
    assert result.account.size_is_known
    assert who_percentiles(child)
    assert result.account.error_share < 0.02
    assert not any("average child" in note for note in result.account.notes)


@pytest.mark.full
def test_a_length_that_the_recording_contradicts_is_said():
    spec, _, _, recording = known(5, frames=12, depth_noise_m=0.01)
    true_cm = mimoc.build(spec).manifest.child.length_cm
    wrong = start(spec).with_(body={"individual": {"length_cm": round(true_cm * 0.85, 1)}})
    result = mimoc.retarget(recording, max(wrong.age_months - 1, 0), wrong)
    assert any(f"at {max(wrong.age_months - 1, 0):g} months" in note for note in result.account.notes)
    assert any("the recording gives a length of" in note for note in result.account.notes)


def test_an_age_is_never_assumed(filmed):
    with pytest.raises(RecordingError, match="how old the infant is, is not known; give age_months, or a spec"):
        mimoc.retarget(filmed[1])


@pytest.mark.full
def test_a_limb_that_is_not_seen_is_said_to_be_unseen():
    spec, _, _, recording = known(7, frames=20)
    hidden = [k for k, name in enumerate(recording.names) if name.startswith("left_") and name[5:] in ("wrist", "hand")]
    positions = recording.positions.copy()
    positions[:, hidden] = np.nan
    result = mimoc.retarget(replace(recording, positions=positions), spec.age_months, start(spec))
    assert "robot:left_elbow" not in result.account.joints or "robot:left_elbow" in result.account.unseen
    assert np.isnan(result.fitted[:, hidden]).all()


def test_ctrl_c_keeps_the_best_so_far():
    spec, _, _, recording = known(5, frames=24)
    steps = []

    def progress(done: int, total: int) -> None:
        steps.append((done, total))
        if len(steps) == 9:
            raise KeyboardInterrupt

    result = mimoc.retarget(recording, spec.age_months, start(spec), progress=progress)
    assert INTERRUPTED in result.account.notes
    assert result.qpos.shape[0] == 24
    assert steps[-1][0] == steps[-1][1]
    assert [done for done, _ in steps] == sorted(done for done, _ in steps)


@pytest.mark.full
def test_derivatives_are_computed_for_parts_of_the_frames(monkeypatch):
    spec, _, _, recording = known(5, frames=16, depth_noise_m=0.01)
    whole = mimoc.retarget(recording, spec.age_months, start(spec))
    for module in ("fitting", "uncertainty"):
        monkeypatch.setattr(f"mimoc.movement.retargeting.{module}.CHUNK", 7)
    assert fitting.CHUNK == 7
    parts = mimoc.retarget(recording, spec.age_months, start(spec))
    assert parts.qpos == pytest.approx(whole.qpos, abs=1e-5)
    assert parts.account.angle_sd_rad == pytest.approx(whole.account.angle_sd_rad, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: r.select([n for n in r.names if n != "neck"]), "there is no point neck|neck"),
        (lambda r: r.select(["neck", "left_hip", "right_hip"]), "3 points are too few"),
        (lambda r: r.window(0, 2), "2 frames are too few"),
        (lambda r: replace(r, positions=np.full_like(r.positions, np.nan)), "never seen"),
    ],
)
def test_a_recording_that_tells_too_little_is_refused(change, message):
    _, _, _, recording = known(5, frames=12)
    with pytest.raises(RecordingError, match=message) as error:
        mimoc.retarget(change(recording))
    assert "\n" not in str(error.value)


def test_no_infant_is_older_than_two_years():
    with pytest.raises(SpecError, match="age_months"):
        mimoc.retarget(known(5, frames=12)[-1], age_months=30)


@pytest.mark.full
@pytest.mark.parametrize("seed", range(20))
def test_motions_of_twenty_children_come_back(seed):
    spec, qpos, model, recording = known(seed, frames=150, depth_noise_m=0.01)
    result = mimoc.retarget(recording, spec.age_months, start(spec))
    assert result.account.error_share < 0.012
    assert np.median(off_m(result, model, qpos)) < 0.01


HEIGHT_M = 1.08


@pytest.fixture(scope="module")
def data_set(tmp_path_factory):
    """Return a folder with one sequence of 12 frames, in millimetres, as the data set has it."""
    _, qpos, model, _ = known(5, frames=12)
    names = [name for name in POINTS if name not in ("left_wrist", "right_wrist")]
    seen_m = (locate(model, qpos, names) - [0, 0, HEIGHT_M]) * [1, -1, -1]
    seen = known_motions.film(model, qpos, 30.0, names)
    folder = tmp_path_factory.mktemp("data") / "01"
    for kind, places in (("3D", 1000 * seen_m), ("2Ddep", np.dstack([seen.positions, 1000 * seen_m[..., 2]]))):
        (folder / f"joints_{kind}").mkdir(parents=True)
        for frame, rows in enumerate(places):
            lines = [f"{x} {y} {z} {JOINTS.index(POINTS[n])}" for n, (x, y, z) in zip(names, rows, strict=True)]
            (folder / f"joints_{kind}" / f"syn_joints_{kind}_{frame:05d}.txt").write_text("\n".join(lines))
    return folder.parent


@pytest.mark.full
def test_a_film_with_depth_is_some_millimetres_off(data_set):
    as_it_is, hips, laid = mini_rgbd.errors_m(data_set / "01", 9.0, 12, with_depth=True)
    assert laid < as_it_is < 0.02
    assert hips < 0.02


def test_turned_moved_and_scaled_points_are_laid_on_the_truth():
    draw = np.random.default_rng(0)
    truth = draw.normal(size=(4, len(MINI_RGBD_POINTS), 3))
    moved = 1.3 * truth[..., [1, 2, 0]] + [0.1, 0.2, 0.3]
    apart, _, laid = mini_rgbd.distances_m(moved, truth, list(MINI_RGBD_POINTS))
    assert laid == pytest.approx(np.zeros_like(laid), abs=1e-12)
    assert apart.mean() > 0.1
    shifted = mini_rgbd.distances_m(truth + np.array([0.1, 0, 0]), truth, list(MINI_RGBD_POINTS))
    assert shifted[0] == pytest.approx(0.1 * np.ones_like(apart))
    assert shifted[1] == pytest.approx(np.zeros_like(apart), abs=1e-12)


def test_mirrored_points_are_not_laid_on_the_truth():
    truth = np.random.default_rng(1).normal(size=(1, len(MINI_RGBD_POINTS), 3))
    assert mini_rgbd.distances_m(truth * [-1, 1, 1], truth, list(MINI_RGBD_POINTS))[2].mean() > 0.1
