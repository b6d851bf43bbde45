"""From values to measures, and what is wrong with those of others."""

from dataclasses import replace

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import KindError
from mimoc.base.quantities import Quantity
from mimoc.base.quantities.motion import HIP_PATH
from mimoc.runtime.quantities.measuring import REDUCERS, Outcome, StepMeasures, measure
from mimoc.runtime.quantities.motion import hip_path_m

EPISODES = (Outcome(1.5, 10, True, 0.1), Outcome(-0.5, 30, False, None))


def test_what_came_of_episodes_is_reduced_by_quantity():
    assert measure("episode", "run", EPISODES) == {
        "return": 0.5,
        "success": 0.5,
        "time_to_success_s": 0.1,
        "episodes": 2,
    }


def test_means_of_nothing_are_none_and_counts_zero():
    assert set(measure("episode", "train", ()).values()) == {None, 0}


def test_a_path_is_as_long_as_its_pieces():
    assert REDUCERS["path"]([np.zeros(3), np.array([3.0, 4.0, 0.0]), np.array([3.0, 4.0, 1.0])]) == 6.0


def test_a_step_is_read_as_the_infant_is_then_also_after_it_has_grown():
    heights_m = []
    with mimoc.make(mimoc.InfantSpec(mimoc=1, name="infant", age_months=9)) as opened:
        env = opened.unwrapped
        opened.reset(seed=0)
        measures = StepMeasures(env, "run")
        for age_months in (9, 12):
            env.grow(to=age_months)
            *_, info = env.step(env.action_space.sample())
            assert measures.read(info)["head_height_m"] == env.data.body("head").xipos[2]
            measures.add(info)
            heights_m.append(float(env.data.body("head").xipos[2]))
    assert measures.measures()["head_height_m"] == max(heights_m)


def test_a_quantity_that_measures_more_than_a_number_is_refused_in_one_line(open_env, registered):
    places = replace(HIP_PATH, name="hip_place_m", reduce="mean", term=hip_path_m)
    message = r"^'hip_place_m' measures an array of shape \(3,\) of an infant; return a number, or .*'path'$"
    with registered(places), pytest.raises(KindError, match=message):
        StepMeasures(open_env(), "run")


def test_a_quantity_over_what_has_no_such_field_is_refused_in_one_line(registered):
    smiles = Quantity("smiles", "Smiles", over="episode", steps=("run",))
    message = r"^the quantity 'smiles' is over episode: Outcome, which has no 'smiles'; name a field of it$"
    with registered(smiles), pytest.raises(KindError, match=message):
        measure("episode", "run", EPISODES)


def test_points_have_no_column_in_a_recording(open_env, registered):
    way = replace(HIP_PATH, name="way_m", term=hip_path_m, steps=("record",))
    with registered(way):
        assert StepMeasures(open_env(), "record").read({}) == {}
