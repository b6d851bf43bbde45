"""Labels that others give to points mean mimoc's points."""

import pytest
from support import filmed

from mimoc.motion.labels import known_name
from mimoc.motion.points import POINTS
from mimoc.motion.read_openpose import BODY_25


@pytest.mark.parametrize("name", POINTS)
def test_each_name_means_itself_however_it_is_written(name):
    side, _, part = name.partition("_")
    words = [name, name.upper(), name.replace("_", " "), name.title().replace("_", "")]
    if side in ("left", "right"):
        words += [f"{part}_{side}", f"{side[0]}_{part}", f"{part}.{side[0]}", f"Baby 2:{side[0].upper()}{part.title()}"]
    assert {word: known_name(word) for word in words} == dict.fromkeys(words, name)


def test_every_label_of_body_25_is_a_point():
    assert "" not in filmed.BODY_25_POINTS
    assert len({*filmed.BODY_25_POINTS}) == len(BODY_25) == 25


@pytest.mark.parametrize("label", ["", "left", "l", "marker", "12", "spine", "left_left_hip", "hipp"])
def test_other_words_mean_no_point(label):
    assert known_name(label) == ""
