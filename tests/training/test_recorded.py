"""Trainings whose episodes are recorded."""

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import RecordingError, TrainingError

EVERY = 128


def facts(folder) -> list[tuple]:
    """Return what the episodes of a recording are."""
    found = mimoc.read_recording(folder)
    return [(each.infant, each.number, each.ended, each.actions.tobytes(), each.rewards.tobytes()) for each in found]


@pytest.mark.slow
def test_a_resumed_training_has_recorded_what_an_uninterrupted_one_has(learn, tmp_path):
    """What a killed interval has recorded is replaced, not repeated."""

    def stop(done: int, total: int) -> None:
        if done > 1.5 * EVERY:
            raise KeyboardInterrupt

    learn("whole", record=tmp_path / "recorded whole")
    with pytest.raises(KeyboardInterrupt):
        learn("parts", record=tmp_path / "recorded parts", progress=stop)
    cut = facts(tmp_path / "recorded parts")
    learn("parts", record=tmp_path / "recorded parts")
    whole = facts(tmp_path / "recorded whole")
    assert facts(tmp_path / "recorded parts") == whole
    assert 0 < len(cut) <= len(whole)
    assert all(each.difference is None for each in mimoc.replay_recording(tmp_path / "recorded whole"))


def test_another_training_in_the_same_folder_takes_nothing_away(learn, tmp_path):
    for name, seed in (("one", 1), ("other", 2), ("again", 1)):
        learn(name, steps=EVERY, seed=seed, record=tmp_path / "recorded")
    recording = mimoc.read_recording(tmp_path / "recorded")
    assert sum(episode.steps for episode in recording) == 3 * EVERY
    assert np.isfinite(recording[0].rewards).all()


def test_what_cannot_be_recorded_is_said_before_anything_is_written(learn, tmp_path):
    with pytest.raises(TrainingError, match="leave out --processes and --one-process"):
        learn("run", record=tmp_path / "recorded", processes=False)
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(RecordingError, match="the folder is not empty and no recording"):
        learn("run", record=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]
