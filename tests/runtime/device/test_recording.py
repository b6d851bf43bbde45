"""Infants on a device are recorded: what is commanded, observed and earned, and where they are."""

import numpy as np
import pytest
from support.devices import CLOSE, DEVICE

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.recording.movement_columns import MovementReader

SPEC = {"mimoc": 1, "name": "reaching", "age_months": 18, "senses": {"proprioception": {}}, "task": {"kind": "reach"}}
GROUPS = ("keypoints", "parts", "joints")
STEPS = 4


@pytest.fixture(scope="module")
def lived(tmp_path_factory):
    """Return the folder of a recording of two infants on a device, and what was told."""
    spec = mimoc.InfantSpec.model_validate(SPEC).with_(task={"steps": STEPS})
    folder, rng = tmp_path_factory.mktemp("recordings") / "device", np.random.default_rng(0)
    with mimoc.Recorder(mimoc.make_vec(spec, num_envs=2, device=DEVICE, starts=2), folder, part_rows=3) as envs:
        told = [envs.reset(seed=1)]
        for _ in range(STEPS + 2):
            actions = rng.uniform(-1, 1, envs.action_space.shape).astype(np.float32)
            told.append((actions, *envs.step(actions)))
    return folder, spec, told


def test_rows_are_what_step_returned(lived):
    folder, _, (first, *steps) = lived
    recording = mimoc.read_recording(folder)
    assert [(one.infant, one.steps, one.ended) for one in recording] == [
        (0, STEPS, "truncated"),
        (0, 1, "closed"),
        (1, STEPS, "truncated"),
        (1, 1, "closed"),
    ]
    for world in range(2):
        episode, again = recording.of_infant(world)
        seen = [first[0]["proprioception"][world], *(step[1]["proprioception"][world] for step in steps)]
        assert np.array_equal(episode.observations["proprioception"], seen[: STEPS + 1])
        assert np.array_equal(again.observations["proprioception"], seen[STEPS + 1 :])
        assert np.array_equal(episode.actions, [step[0][world] for step in steps[:STEPS]])
        assert episode.rewards.tolist() == [float(step[2][world]) for step in steps[:STEPS]]
        assert episode.seed == 1 + world


def test_movement_is_that_of_the_same_infant_on_the_cpu(lived):
    folder, spec, (_, *steps) = lived
    episode = mimoc.read_recording(folder)[0]
    env = mimoc.make(spec).unwrapped
    env.reset(seed=1)
    reader = MovementReader(env, GROUPS)
    for row in range(STEPS + 1):
        if row:
            env.step(steps[row - 1][0][0])
        values = np.array([*reader.read().values()])
        recorded = np.array([episode.movement[column.name][row] for column in reader.columns])
        assert recorded == pytest.approx(values, rel=1e-3, abs=CLOSE, nan_ok=True)
    assert not {"gaze_x_m", "left_hand_contact_n"} & set(episode.movement)


def test_it_cannot_be_replayed_and_says_why(lived):
    with pytest.raises(RecordingError, match="cannot be replayed: recorded on a device, without states"):
        list(mimoc.replay_recording(lived[0]))
