"""Movement columns are what MuJoCo's data say, by names that say their units."""

import csv
from pathlib import Path

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import RecordingError, UnknownNameError
from mimoc.base.kinds import function_of
from mimoc.motion.body_points import film
from mimoc.movement.measured import measure_movement, measure_sides
from mimoc.movement.measures import movement_units
from mimoc.recording.movement_columns import MovementReader, groups_named
from mimoc.schema.kinds import MOVEMENT_GROUPS

STEPS = 40


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> tuple[Path, np.ndarray]:
    """Return a recording in several parts, of an infant that grows, and its keypoints at each row."""
    folder = tmp_path_factory.mktemp("movement") / "kept"
    spec = {"mimoc": 1, "name": "kim", "age_months": 9, "senses": {}, "scene": {"pose": "sitting"}}
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), folder, part_rows=16) as env:
        env.action_space.seed(0)
        env.reset(seed=0)
        keypoints = [env.unwrapped.keypoints()]
        for step in range(STEPS):
            if step == STEPS - 5:
                env.unwrapped.grow(to=10)
            env.step(env.action_space.sample())
            keypoints.append(env.unwrapped.keypoints())
    return folder, np.array(keypoints)


@pytest.fixture(scope="module")
def tables(recorded, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("exported") / "csv"
    mimoc.export_recording(recorded[0], "csv", out)
    return out


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_table_has_the_keypoints_to_the_last_digit_of_single_precision(recorded, tables):
    rows, keypoints = rows_of(tables / "movement.csv"), recorded[1].astype(np.float32)
    assert [row["step"] for row in rows] == [str(step) for step in range(STEPS + 1)]
    for name, index in (("nose", 0), ("right_wrist", 4), ("left_big_toe", 19), ("right_heel", 24)):
        for axis, letter in enumerate("xyz"):
            column = [np.float32(row[f"{name}_{letter}_m"]) for row in rows]
            assert column == keypoints[:, index, axis].tolist()


def swinging(rate_hz: float, swings_hz: float, sway: float) -> dict[str, np.ndarray]:
    """Return columns of 10 s of an infant that travels and turns, whose right hand swings by half a trunk of .2 m."""
    times_s = np.arange(round(10 * rate_hz)) / rate_hz
    turn = 0.3 * times_s
    along, across = (np.stack([f(turn), g(turn), 0 * turn], axis=1) for f, g in ((np.cos, np.sin), (np.sin, np.cos)))
    across *= (-1, 1, 1)
    middle = np.stack([sway * times_s, 0 * times_s, 0.05 + 0 * times_s], axis=1)
    swing = 0.05 * np.cos(2 * np.pi * swings_hz * times_s)[:, None]
    tremor = 0.001 * np.sin(2 * np.pi * 13 * times_s)[:, None]
    places = {"neck": middle + 0.2 * along, "left_hip": middle + 0.04 * across, "right_hip": middle - 0.04 * across}
    hands = {"right_hand": middle + 0.1 * along + (swing + tremor) * across, "left_hand": middle + 0.1 * along}
    feet = {f"{side}_foot": middle - 0.2 * along for side in ("left", "right")}
    named = {**places, **hands, **feet}
    columns = {f"{name}_{axis}_m": at[:, index] for name, at in named.items() for index, axis in enumerate("xyz")}
    return {"time_s": times_s, **columns}


@pytest.mark.parametrize("rate_hz", [40.0, 100.0, 200.0])
def test_movement_units_depend_neither_on_the_rate_nor_on_travel_and_tremor(rate_hz):
    """Each swing there and back has two maxima of the speed."""
    from mimoc.base.quantities import QUANTITIES

    units = {}
    for side in ("left", "right"):
        compute = function_of(QUANTITIES[f"{side}_hand_movement_units"].compute, f"{side}_hand_movement_units")
        units[side] = compute(swinging(rate_hz, 1.0, 0.05))
    assert units == {"left": 0, "right": 20}


def test_measures_of_recordings_and_of_films_count_movement_units_alike(tmp_path):
    spec = {"mimoc": 1, "name": "kim", "age_months": 3, "senses": {}, "scene": {"kind": "flat", "pose": "supine"}}
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), tmp_path / "kept") as env:
        env.reset(seed=0)
        qpos, swing = [env.unwrapped.data.qpos.copy()], np.zeros(env.action_space.shape)
        for step in range(800):
            swing[:] = 0.3 * np.sin(2 * np.pi * 1.2 * step * 0.01)
            env.step(swing.astype(np.float32))
            qpos.append(env.unwrapped.data.qpos.copy())
        seen = film(env.unwrapped.model, np.array(qpos), 100.0)
    measured = mimoc.measure_recordings(tmp_path / "kept")
    assert measure_movement(seen)["hand_units_per_min"] > 60
    for side, values in measure_sides(seen).items():
        for part in ("hand", "foot"):
            filmed = values[f"{part}_units_per_min"] * 8.01 / 60
            assert measured[f"{side}_{part}_movement_units"][0] == pytest.approx(filmed, rel=0.2, abs=1.5)


def test_the_dictionary_says_what_every_column_of_every_table_is(tables):
    entries = rows_of(tables / "columns.csv")
    known = {(entry["table"], entry["name"]) for entry in entries}
    for path in sorted(tables.glob("*.csv")):
        kind = "INFANT-EPISODE" if path.stem == "0000-000000" else path.stem
        if path.name != "columns.csv":
            assert {(kind, name) for name in rows_of(path)[0]} <= known
    assert all(entry["about"] for entry in entries)
    assert all(entry["source"] and entry["frame"] for entry in entries if entry["name"].endswith("_m_s"))


def test_tables_of_parquet_have_the_same_columns(recorded, tables, tmp_path):
    import pyarrow.parquet as pq

    mimoc.export_recording(recorded[0], "parquet", tmp_path / "out")
    table, rows = pq.read_table(tmp_path / "out" / "movement.parquet"), rows_of(tables / "movement.csv")
    assert table.column_names == list(rows[0])
    assert table.column("left_hand_touches").to_pylist() == [row["left_hand_touches"] for row in rows]


def test_recordings_with_movement_columns_come_out_again(recorded):
    assert [replayed.difference for replayed in mimoc.replay_recording(recorded[0])] == [None]


@pytest.mark.parametrize(("groups", "names"), [((), set()), (("gaze",), {"gaze_x_m", "gaze_at"})])
def test_only_the_chosen_columns_are_recorded(groups, names, tmp_path):
    spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=1, senses={})
    with mimoc.Recorder(mimoc.make(spec), tmp_path / "kept", movement=groups) as env:
        env.reset(seed=0)
        env.step(env.action_space.sample())
    movement = mimoc.read_recording(tmp_path / "kept")[0].movement
    assert names <= set(movement)
    assert all(name.startswith("gaze") for name in movement)
    mimoc.export_recording(tmp_path / "kept", "csv", tmp_path / "csv")
    assert (tmp_path / "csv" / "movement.csv").exists() == bool(groups)
    with pytest.raises(
        RecordingError, match=r"no episode has what 'left_foot_path_m' needs; record it with 'mimoc run"
    ):
        mimoc.measure_recordings(tmp_path / "kept", ["left_foot_path_m"])


def test_a_group_that_there_is_not_is_refused_before_anything_is_written(tmp_path):
    env = mimoc.make(mimoc.InfantSpec(mimoc=1, name="kim", age_months=1, senses={}))
    with pytest.raises(UnknownNameError, match="'keypoint' is not a group of movement columns; did you mean"):
        mimoc.Recorder(env, tmp_path / "kept", movement=["keypoint"])
    assert not (tmp_path / "kept").exists()
    env.close()


@pytest.mark.parametrize("text", ["name,unit\nnose_x_m,m\n", "name,unit,about,frame,source\nnose_x_m\n", "\xff\x00"])
def test_a_damaged_dictionary_is_refused_in_one_line(recorded, text, tmp_path, monkeypatch):
    from shutil import copytree

    copytree(recorded[0], tmp_path / "kept")
    (tmp_path / "kept" / "columns.csv").write_bytes(text.encode("latin-1"))
    with pytest.raises(RecordingError, match=r"columns\.csv: "):
        mimoc.export_recording(tmp_path / "kept", "csv", tmp_path / "csv")


def test_a_unit_rises_and_falls():
    assert movement_units(np.array([0, 0.5, 0, 0.5, 0.45, 0.51, 0])).tolist() == [1, 5]
    assert not any(len(movement_units(np.array(speed))) for speed in ([0, 0.2, 0], [0, 0.5], [0.5] * 9))


def test_recordings_are_measured_by_the_command(recorded, invoke, tmp_path):
    code, out, err = invoke("measure", recorded[0].parent, "right_hand_path_m", "-o", tmp_path / "out.csv")
    assert (code, out, err) == (0, f"{tmp_path / 'out.csv'}\n", "")
    (row,) = rows_of(tmp_path / "out.csv")
    movement = mimoc.read_recording(recorded[0])[0].movement
    points_m = np.stack([movement[f"right_hand_{axis}_m"] for axis in "xyz"], axis=1).astype(float)
    path_m = np.linalg.norm(np.diff(points_m, axis=0), axis=1).sum()
    assert (row["recording"], row["infant"], row["episode"], row["seconds"]) == ("kept", "0", "0", "0.4")
    assert float(row["right_hand_path_m"]) == pytest.approx(path_m)
    assert "left_hand_straightness" in invoke("measure", "--list").out
    assert "Left foot: path" in invoke("measure", recorded[0]).out


SUFFIXES = {"m": "_m", "m/s": "_m_s", "N": "_n", "N m": "_nm", "°": "_deg", "": ""}
SPECS = {
    "lying": {"age_months": 1},
    "sitting": {"age_months": 9, "scene": {"pose": "sitting"}, "actuation": {"model": "muscle"}},
    "one arm": {"age_months": 6, "body": {"remove": ["right_lower_arm"]}},
}


@pytest.fixture(scope="module", params=SPECS)
def env(request):
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "senses": {}, **SPECS[request.param]})
    with mimoc.make(spec) as opened:
        opened.reset(seed=0)
        opened.action_space.seed(0)
        for _ in range(20):
            opened.step(opened.action_space.sample())
        yield opened.unwrapped


def test_names_are_unique_and_end_with_their_units(env):
    columns = MovementReader(env).columns
    assert len({column.name for column in columns}) == len(columns)
    for column in columns:
        suffix = SUFFIXES[column.unit]
        ends = [other for other in SUFFIXES.values() if other and column.name.endswith(other)]
        assert suffix == max(ends, key=len, default=""), column
        assert all((column.about, column.source)), column
        assert not (column.is_text and column.unit)


def test_keypoints_are_those_of_the_environment_to_the_bit(env):
    values = [*MovementReader(env, ("keypoints",)).read().values()]
    assert np.array_equal(values, env.keypoints().reshape(-1), equal_nan=True)


def test_velocities_are_those_of_the_jacobian(env):
    """Of the whole body too: sum of m_i J_i qvel over the mass."""
    mujoco.mj_forward(env.model, env.data)
    values = MovementReader(env, ("parts",)).read()
    root = env.model.body(env.manifest.root_body).id
    bodies = [body for body in range(1, env.model.nbody) if env.model.body_rootid[body] == root]
    moved, jacobian = np.zeros(3), np.empty((3, env.model.nv))
    for body in bodies:
        mujoco.mj_jacBodyCom(env.model, env.data, jacobian, None, body)
        moved += env.model.body_mass[body] * (jacobian @ env.data.qvel)
    moved /= env.model.body_mass[bodies].sum()
    assert [values[f"body_velocity_{axis}_m_s"] for axis in "xyz"] == pytest.approx(moved)
    assert values["body_speed_m_s"] == pytest.approx(np.linalg.norm(moved))
    assert [values[f"body_{axis}_m"] for axis in "xyz"] == pytest.approx(env.data.subtree_com[root])


def test_forces_are_those_of_mujocos_contacts(env):
    """Each contact counts on both sides, none within a part, and what is fixed carries the body."""
    values = MovementReader(env, ("contacts",)).read()
    ground, force = np.zeros(3), np.empty(6)
    for index, contact in enumerate(env.data.contact):
        bodies = env.model.geom_bodyid[contact.geom]
        if 0 in bodies and bodies.any():
            mujoco.mj_contactForce(env.model, env.data, index, force)
            ground += (1 if bodies[0] == 0 else -1) * (contact.frame.reshape(3, 3).T @ force[:3])
    assert [values[f"ground_reaction_{axis}_n"] for axis in "xyz"] == pytest.approx(ground)
    loads = [value for name, value in values.items() if name.endswith("_ground_z_n")]
    assert sum(loads) == pytest.approx(ground[2])
    for name, text in values.items():
        if name.endswith("_touches"):
            part = name.removesuffix("_touches")
            assert bool(text) == (values[f"{part}_contact_n"] > 0)
            assert part not in text.split("; ")


def test_the_gaze_point_lies_on_the_line_of_sight(env):
    values = MovementReader(env, ("gaze",)).read()
    towards = np.array([values[f"gaze_direction_{axis}"] for axis in "xyz"])
    assert np.linalg.norm(towards) == pytest.approx(1)
    if values["gaze_at"]:
        eyes_m = np.mean([env.data.camera(eye.camera).xpos for eye in env.manifest.anatomy.eyes], axis=0)
        point_m = np.array([values[f"gaze_{axis}_m"] for axis in "xyz"])
        assert point_m == pytest.approx(eyes_m + values["gaze_distance_m"] * towards)
    else:
        assert np.isnan(values["gaze_x_m"])


def test_many_moments_at_once_are_those_of_each(env):
    reader, samples, alone = MovementReader(env), [], []
    for _ in range(5):
        env.step(env.action_space.sample())
        reader.add(samples, 5)
        alone.append(reader.read())
    (kept,) = samples
    numbers, texts = kept.values()
    for row, names, values in zip(numbers, texts, alone, strict=True):
        expected = [*values.values()]
        assert row.tolist() == pytest.approx(expected[: len(row)], rel=1e-12, nan_ok=True)
        assert [*names] == expected[len(row) :]


def test_groups_are_chosen_by_name_in_the_order_of_the_table():
    assert groups_named("contacts, keypoints") == ("keypoints", "contacts")
    assert (groups_named("all"), groups_named("none")) == (tuple(MOVEMENT_GROUPS), ())
    with pytest.raises(UnknownNameError, match="'gase' is not a group of movement columns; did you mean 'gaze'"):
        groups_named("gase")
