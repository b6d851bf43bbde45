import colorsys
from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

from mimoc.compiler.toys.choosing import BRIGHTNESS, SATURATION, Toy, Toybox, choose_toys
from mimoc.components.toys.builtin import BUILTIN_TOYS
from mimoc.schema.toys import ToysSpec

USUAL = ToysSpec()
SIX = ToysSpec(count=(6, 6))


@cache
def chosen() -> list[tuple[Toy, ...]]:
    return [choose_toys(USUAL, seed, BUILTIN_TOYS) for seed in range(1000)]


def everything() -> list[Toy]:
    return [toy for toys in chosen() for toy in toys]


def evenly(values: list[float], low: float, high: float) -> bool:
    """Return whether values are inside a range and cover it evenly, by a chi-square test of ten bins."""
    assert low <= min(values) <= max(values) <= high
    return stats.chisquare(np.histogram(values, 10, (low, high))[0]).pvalue > 0.01


def hsv(toy: Toy, tint: str) -> tuple[float, float, float]:
    return colorsys.rgb_to_hsv(*toy.colours[tint][:3])


def test_each_count_of_the_range_is_alike_likely():
    counts = Counter(len(toys) for toys in chosen())
    assert set(counts) == {3, 4, 5, 6}
    assert stats.chisquare(list(counts.values())).pvalue > 0.01


def test_sizes_cover_their_range_evenly():
    assert evenly([toy.size_m for toy in everything()], 0.04, 0.12)


def test_turns_cover_the_circle_evenly():
    assert evenly([toy.yaw_rad for toy in everything()], 0, 2 * np.pi)


def test_every_toy_has_its_turn():
    counts = Counter(toy.model.name for toy in everything())
    assert set(counts) == set(BUILTIN_TOYS.names)
    assert stats.chisquare(list(counts.values())).pvalue > 0.01


def test_colours_have_any_hue_and_are_neither_pale_nor_dark():
    hues, saturations, brightnesses = zip(*(hsv(toy, "main") for toy in everything()), strict=True)
    assert evenly(hues, 0, 1)
    assert evenly(saturations, SATURATION[0] - 1e-3, SATURATION[1] + 1e-3)
    assert evenly(brightnesses, BRIGHTNESS[0] - 1e-3, BRIGHTNESS[1] + 1e-3)


def test_the_second_colour_is_about_opposite_the_first():
    for toy in everything():
        apart = abs(hsv(toy, "main")[0] - hsv(toy, "accent")[0])
        assert 0.41 < min(apart, 1 - apart) <= 0.5


def test_changing_one_aspect_changes_no_other():
    """More toys leave the first ones alone, and other sizes or another box leave colours and turns alone."""
    small = ToysSpec(count=(6, 6), size_cm=(2, 3))
    balls = Toybox(("ball",), BUILTIN_TOYS.load)
    for seed in range(50):
        six = choose_toys(SIX, seed, BUILTIN_TOYS)
        assert choose_toys(ToysSpec(count=(2, 2)), seed, BUILTIN_TOYS) == six[:2]
        for other in (choose_toys(small, seed, BUILTIN_TOYS), choose_toys(SIX, seed, balls)):
            assert [(toy.colours, toy.yaw_rad) for toy in other] == [(toy.colours, toy.yaw_rad) for toy in six]
        assert [toy.model for toy in choose_toys(small, seed, BUILTIN_TOYS)] == [toy.model for toy in six]
        assert [toy.size_m for toy in choose_toys(SIX, seed, balls)] == [toy.size_m for toy in six]


def test_another_seed_gives_other_toys():
    assert choose_toys(SIX, 1, BUILTIN_TOYS) != choose_toys(SIX, 2, BUILTIN_TOYS)


def test_there_may_be_none():
    assert choose_toys(ToysSpec(count=(0, 0)), 0, BUILTIN_TOYS) == ()


@pytest.mark.parametrize("name", BUILTIN_TOYS.names)
def test_a_toy_twice_as_large_weighs_eight_times_as_much(name):
    model = BUILTIN_TOYS.load(name)
    small, large = (Toy(model, size, 0.0, {}) for size in (0.05, 0.1))
    assert small.mass_kg == pytest.approx(model.volume * 0.05**3 * model.density_kg_m3)
    assert large.mass_kg == pytest.approx(8 * small.mass_kg)
    assert large.radius_m == pytest.approx(2 * small.radius_m)


def test_the_radius_of_a_ball_is_half_its_size():
    assert Toy(BUILTIN_TOYS.load("ball"), 0.1, 0.0, {}).radius_m == pytest.approx(0.05, rel=0.02)


def test_progress_counts_the_toys_that_are_loaded():
    told: list[tuple[int, int]] = []
    choose_toys(SIX, 1, replace(BUILTIN_TOYS, progress=lambda done, total: told.append((done, total))))
    assert told == [(done, 6) for done in range(6)]
