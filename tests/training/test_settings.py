import pytest

from mimoc.base.errors import TrainingError, UnknownNameError
from mimoc.training.settings import HYPERPARAMETERS, TrainingSettings, parse


def settings(**changed):
    choices = {"algo": "ppo", "steps": 100_000, "seed": 0, "envs": 8, "checkpoint_every": 20_480, "hyper": {}}
    return TrainingSettings.choose(**{**choices, **changed})


def test_every_hyperparameter_has_a_value():
    for algo, known in HYPERPARAMETERS.items():
        assert settings(algo=algo).hyper.keys() == known.keys()
        assert all(each.low <= each.default <= each.high for each in known.values())


def test_intervals_and_the_end_are_whole_rollouts():
    assert settings().rollout_steps == 2048
    assert settings().end_of_interval(0) == 20_480
    assert settings(checkpoint_every=5000).end_of_interval(2048) == 8192
    assert settings().end_of_interval(98_304) == 100_352
    assert settings(algo="sac").end_of_interval(81_920) == 100_000


def test_settings_go_through_json():
    chosen = settings(hyper={"gamma": 0.9})
    assert TrainingSettings(**chosen.data()) == chosen


def test_all_differences_but_the_steps_are_named():
    assert settings(seed=2, steps=5).differences(settings(hyper={"gamma": 0.5})) == [
        "gamma 0.5, not 0.98",
        "seed 0, not 2",
    ]
    assert "algo ppo, not sac" in settings(algo="sac").differences(settings())


def test_the_options_give_the_same_settings():
    options = settings(hyper={"gamma": 0.9, "width": 32}).options()
    chosen = [options[place + 1] for place, option in enumerate(options) if option == "--set"]
    assert parse("ppo", chosen) == {"gamma": 0.9, "width": 32}


def test_assignments_set_hyperparameters():
    assert parse("ppo", ["gamma=0.99", "n_steps=1e2"]) == {"gamma": 0.99, "n_steps": 100}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gamma", "'gamma' is not an assignment; write NAME=NUMBER"),
        ("gamma=much", "'gamma=much' is not an assignment"),
        ("gamma=nan", "gamma: expected a number from 0 to 1, got nan"),
        ("n_steps=2.5", "n_steps: expected an integer from 2 to 1.04858e[+]06, got 2.5"),
        ("width=0", "width: expected an integer from 1 to 16384, got 0"),
    ],
)
def test_invalid_assignments_are_refused(text, said):
    with pytest.raises(TrainingError, match=said):
        parse("ppo", [text])


def test_each_algorithm_has_its_own_hyperparameters():
    with pytest.raises(UnknownNameError, match="'n_epochs' is not a hyperparameter of sac"):
        parse("sac", ["n_epochs=3"])
