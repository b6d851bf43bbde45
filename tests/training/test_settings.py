import pytest

from mimoc.errors import TrainingError, UnknownNameError
from mimoc.training import hyper
from mimoc.training.settings import Settings


def settings(**changed):
    choices = {"algo": "ppo", "steps": 100_000, "seed": 0, "envs": 8, "checkpoint_every": 20_480, "hyper": {}}
    return Settings.choose(**{**choices, **changed})


def test_every_hyper_parameter_has_a_value():
    for algo, knobs in hyper.KNOBS.items():
        assert settings(algo=algo).hyper.keys() == knobs.keys()
        assert all(knob.low <= knob.default <= knob.high for knob in knobs.values())


def test_intervals_and_the_end_are_whole_rounds():
    assert settings().round_steps == 2048
    assert settings().end_of_interval(0) == 20_480
    assert settings(checkpoint_every=5000).end_of_interval(2048) == 8192
    assert settings().end_of_interval(98_304) == 100_352
    assert settings(algo="sac").end_of_interval(81_920) == 100_000


def test_settings_go_through_json():
    chosen = settings(hyper={"gamma": 0.9})
    assert Settings.from_data(chosen.data()) == chosen


def test_differences_are_named_but_for_the_steps():
    assert settings(seed=2, steps=5).differences(settings(hyper={"gamma": 0.5})) == [
        "gamma 0.5, not 0.98",
        "seed 0, not 2",
    ]
    assert "algo ppo, not sac" in settings(algo="sac").differences(settings())


def test_the_options_say_the_same():
    told = settings(hyper={"gamma": 0.9, "width": 32}).options()
    chosen = [told[place + 1] for place, option in enumerate(told) if option == "--set"]
    assert hyper.read("ppo", chosen) == {"gamma": 0.9, "width": 32}


def test_texts_choose_hyper_parameters():
    assert hyper.read("ppo", ["gamma=0.99", "n_steps=1e2"]) == {"gamma": 0.99, "n_steps": 100}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gamma", "'gamma' sets nothing; write a name and a number"),
        ("gamma=much", "'gamma=much' sets nothing"),
        ("gamma=nan", "gamma: nan will not do"),
        ("n_steps=2.5", "n_steps: 2.5 will not do; give a whole number"),
        ("width=0", "width: 0 will not do; give a whole number from 1"),
    ],
)
def test_texts_that_choose_nothing_are_refused(text, said):
    with pytest.raises(TrainingError, match=said):
        hyper.read("ppo", [text])


def test_each_algorithm_has_its_own():
    with pytest.raises(UnknownNameError, match="'n_epochs' is not a hyper-parameter of sac"):
        hyper.read("sac", ["n_epochs=3"])
