"""Infants that share a world are recorded each by itself, and simulated again together."""

import json
import shutil

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc.base.errors import RecordingError, UnknownNameError

STEPS = 9


@pytest.fixture(scope="module")
def bundle():
    """Return two infants side by side, with noise and delays."""
    disturbed = {"delays": {"preset": "physiological"}, "noise": {"motor": 0.1, "proprioception_deg": 1.0}}
    return world(anna=ANNA | disturbed, ben=BEN | disturbed)


def actions(env, rng):
    return {name: rng.uniform(-1, 1, env.action_space(name).shape).astype(np.float32) for name in env.agents}


def differences(folder, **options) -> list[str]:
    return [str(one) for one in mimoc.replay_recording(folder, **options) if one.difference]


@pytest.fixture(scope="module")
def lived(bundle, tmp_path_factory):
    """Return the folder of a recording of three episodes, and what was told in the first.

    Meanwhile, one infant grows, gets another arousal and expression and is pushed, and a state is restored.
    """
    folder, rng, told = tmp_path_factory.mktemp("recordings") / "lived", np.random.default_rng(0), []
    with mimoc.Recorder(mimoc.make_parallel(bundle), folder, part_rows=4, states_every=3) as env:
        told.append(env.reset(seed=3, options={"anna": {"pose": "sitting", "arousal": 0.5}}))
        for step in range(STEPS):
            if step == 2:
                env.infants["ben"].set_arousal(1.5)
                env.infants["anna"].set_expression("happy")
            if step == 4:
                env.data.qvel[:] += 0.1
            if step == 6:
                env.grow({"ben": 3.5})
            given = actions(env, rng)
            told.append((given, *env.step(given)))
        env.reset(options={"ben": {"age_months": 4.0}})
        env.step(actions(env, rng))
        state = env.get_state()
        env.step(actions(env, rng))
        env.set_state(state)
        env.step(actions(env, rng))
    return folder, told


@pytest.mark.parametrize("name", ["anna", "ben"])
def test_the_rows_of_each_infant_are_what_step_returned(name, lived):
    folder, ((observations, _), *steps) = lived
    episode = mimoc.read_recording(folder).of_infant(name)[0]
    for sense, readings in episode.observations.items():
        seen = np.stack([observations[name][sense], *(step[1][name][sense] for step in steps)])
        assert (readings.dtype, readings.tobytes()) == (seen.dtype, seen.tobytes())
    assert np.array_equal(episode.actions, [step[0][name] for step in steps])
    assert episode.rewards.tolist() == [step[2][name] for step in steps]
    assert episode.infos["age_months"].tolist() == [step[5][name]["age_months"] for step in steps]


def test_all_comes_out_again_to_the_bit(lived):
    assert differences(lived[0]) == []
    assert differences(lived[0], infant="ben", episode=1) == []


def test_the_bundle_and_the_states_of_a_world_are_kept_once(lived, bundle):
    recording = mimoc.read_recording(lived[0])
    about = [(infant.name, infant.world) for infant in recording.description.infants]
    assert about == [("anna", 0), ("ben", 0)]
    assert [folder.name for folder in (lived[0] / "bundles").iterdir()] == [recording[0].bundle_digest[7:23]]
    assert recording.whole_bundle().files == bundle.files
    assert recording.bundle(1).manifest.root_body == "ben_hip"
    for first, second in zip(recording.of_infant("anna"), recording.of_infant("ben"), strict=True):
        assert recording.run_of(second) == (first, second)
        assert second.start == {}
        assert list(first.start["infants"]) == ["anna", "ben"]
        assert not second.states
    assert [*recording[0].states] == [3, 6, 9]


def test_a_restored_state_begins_an_episode(lived):
    anna = mimoc.read_recording(lived[0]).of_infant("anna")
    assert [(episode.steps, episode.ended, episode.before is None) for episode in anna] == [
        (STEPS, "reset", False),
        (2, "reset", False),
        (1, "closed", True),
    ]


@pytest.mark.parametrize("infant", [0, 1])
def test_another_action_of_either_leads_elsewhere(infant, lived, tmp_path):
    folder = shutil.copytree(lived[0], tmp_path / "copy")
    path = folder / "episodes" / f"{infant:04d}-000000.parquet"
    table = pq.read_table(path)
    rows = table.column("action").to_pylist()
    rows[1] = [-value for value in rows[1]]
    place = table.column_names.index("action")
    kind = table.schema.field("action")
    pq.write_table(table.set_column(place, kind, pa.array(rows, kind.type)), path)
    assert any(line.startswith(f"infant {infant}, episode 0, step ") for line in differences(folder, episode=0))


def test_one_whose_episode_ends_has_fewer_rows_and_stays_in_the_world(bundle, tmp_path):
    class Short(mimoc.Task):
        """Ends after some steps."""

        def judge(self, data, action, effort):
            return mimoc.Verdict({"reward": float(data.qpos[0])})

    tasks = {"anna": Short(steps=3)}
    env = mimoc.make_parallel(bundle, tasks=tasks)
    with pytest.warns(UserWarning, match="object of a script's own"):
        recorder = mimoc.Recorder(env, tmp_path / "w")
    with recorder:
        rng = np.random.default_rng(1)
        recorder.reset(seed=0)
        for step in range(6):
            if step == 4:
                recorder.infants["anna"].set_arousal(0.0)
            recorder.step(actions(recorder, rng))
    anna, ben = mimoc.read_recording(tmp_path / "w")
    assert [(anna.steps, anna.ended), (ben.steps, ben.ended)] == [(3, "truncated"), (6, "closed")]
    assert differences(tmp_path / "w", task={"anna": Short(steps=3)}) == []
    with pytest.raises(RecordingError, match="recorded with task of a script's own"):
        mimoc.replay_recording(tmp_path / "w", task={"ben": Short(steps=3)})


def test_a_batch_of_worlds_is_recorded_by_world(bundle, tmp_path):
    rng = np.random.default_rng(2)
    with mimoc.Recorder(mimoc.make_vec(bundle, num_envs=4, max_episode_steps=3), tmp_path / "batch") as envs:
        observed, _ = envs.reset(seed=5)
        for _ in range(5):
            envs.step(rng.uniform(-1, 1, envs.action_space.shape).astype(np.float32))
    recording = mimoc.read_recording(tmp_path / "batch")
    assert [infant.world for infant in recording.description.infants] == [0, 0, 1, 1]
    for row in range(4):
        assert np.array_equal(recording.of_infant(row)[0].observations["touch"][0], observed["touch"][row])
    assert {one.steps for one in recording if one.number == 0} == {3}
    assert differences(recording) == []
    with pytest.raises(RecordingError, match="several infants are named 'ben'; give the number"):
        recording.of_infant("ben")
    with pytest.raises(UnknownNameError, match="'bem' is not a name of an infant of this recording; did you mean"):
        recording.of_infant("bem")


def test_columns_name_the_parts_of_others_by_their_infants(bundle, tmp_path):
    """Own parts have the names that they have alone; those of others begin with the names of these."""
    with mimoc.Recorder(mimoc.make_parallel(bundle), tmp_path / "near") as env:
        env.reset(seed=0)
        root = env.model.jnt_qposadr[env.model.body("ben_hip").jntadr[0]]
        env.data.qpos[root : root + 3] = env.data.body("anna_hip").xpos
        env.data.qpos[root + 2] += 0.15
        for _ in range(20):
            env.step({name: 0 * env.action_space(name).sample() for name in env.agents})
    anna, ben = mimoc.read_recording(tmp_path / "near")
    assert anna.described.movement == ben.described.movement
    touching = [texts for name, texts in anna.movement.items() if name.endswith("_touches")]
    touched = {thing for texts in touching for text in texts for thing in text.split("; ")}
    assert any(thing.startswith("ben_") for thing in touched)
    assert not any(thing.startswith("anna_") for thing in touched)
    table = mimoc.contacts_and_gaze(tmp_path / "near")
    rows = [*zip(*table.values(), strict=True)]
    mirrored = {row[2:7] + row[7:]: row for row in rows}
    for _, _, who, does, part, other, other_part, *lasted in rows:
        if does == "touches":  # Who is touched touches: the same parts, for as long.
            assert (other, does, other_part, who, part, *lasted) in mirrored
    assert sum(row[7] for row in rows if row[3] == "touches") > 0


def test_where_nobody_shares_a_world_there_is_no_table(lived, tmp_path):
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(BEN)), tmp_path / "alone") as env:
        env.reset(seed=0)
    with pytest.raises(RecordingError, match="no world of several infants is recorded here"):
        mimoc.contacts_and_gaze(tmp_path / "alone")


def test_a_change_of_an_infant_that_is_not_there_is_one_line(lived, tmp_path):
    folder = shutil.copytree(lived[0], tmp_path / "copy")
    path = folder / "episodes" / "0000-000000.json"
    sidecar = json.loads(path.read_text())
    sidecar["changes"][0]["infant"] = 7
    path.write_text(json.dumps(sidecar))
    with pytest.raises(RecordingError, match=r"0000-000000\.json: a state or a change is damaged"):
        differences(folder, episode=0)


def test_of_a_world_that_was_killed_what_all_infants_have_comes_out_again(lived, tmp_path):
    """Of one of them, a part more was written than of the other."""
    folder = shutil.copytree(lived[0], tmp_path / "copy")
    for name in ("0000-000000.0002", "0001-000000.0002", "0001-000000.0001"):
        for path in (folder / "episodes").glob(f"{name}.*"):
            path.unlink()
    anna, ben = mimoc.replay_recording(folder, episode=0)
    assert (anna.episode.ended, anna.episode.steps, ben.episode.steps) == ("unfinished", 7, 3)
    assert [(one.difference, one.steps) for one in (anna, ben)] == [(None, 3)] * 2
