"""Labels that others give to points mean mimoc's points."""

from dataclasses import replace

import numpy as np
import pytest
from support import filmed

import mimoc
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


def test_markers_around_a_point_have_it_in_their_middle_unless_it_is_named(tmp_path):
    kicking = filmed.filmed(20)
    shift = np.zeros((20, 14, 2))
    shift[:, kicking.names.index("left_hand")] = 10
    around = [replace(kicking, positions=kicking.positions + sign * shift) for sign in (-1, 1)]
    hands = [one.path("left_hand") for one in around]
    others = kicking.select([name for name in kicking.names if name not in ("left_hand", "head")])
    labels = (*others.names, "LWRA", "LWRB", "head", "LFHD")
    head = kicking.path("head")
    positions = np.concatenate([others.positions, np.stack([*hands, head, head + 50], axis=1)], axis=1)
    table = replace(kicking, names=labels, positions=positions, confidence=np.ones((20, len(labels))))
    read = mimoc.read_points(mimoc.write_points(table, tmp_path / "a.csv"))
    assert np.allclose(read.path("left_wrist"), kicking.path("left_hand"))
    assert np.array_equal(read.path("head"), head)
    assert read.notes == ("left_wrist is taken to be at LWRA, LWRB", "left out: LFHD")
