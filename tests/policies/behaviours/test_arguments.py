"""What can stand in the parentheses of a behaviour."""

import pytest

from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours.behaviour import Option, place_of, read_arguments
from mimoc.policies.spec import parse_policy
from mimoc.schema.kinds import POLICIES

OPTIONS = {"speed_m_s": Option(0.4, 0.05, 1.5)}


def test_words_numbers_and_defaults():
    given = read_arguments("reach_for", "toy, right, speed_m_s=0.3", OPTIONS, most_words=2)
    assert (given.words, given.numbers) == (("toy", "right"), {"speed_m_s": 0.3})
    assert read_arguments("reach_for", "", OPTIONS).numbers == {"speed_m_s": 0.4}


@pytest.mark.parametrize("text", ["(0.3, -1, .2), left", "0.3,-1,.2, left", " ( 0.3 ,-1, .2 ),left"])
def test_three_numbers_are_a_place_with_and_without_parentheses(text):
    place, side = read_arguments("reach_for", text, OPTIONS, most_words=2).words
    assert (place_of(place), side) == ((0.3, -1.0, 0.2), "left")
    assert place_of("toy") is None


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        ("toy, right, now", PolicyError, "'reach_for' does not take 'now'; it takes speed_m_s=0.4"),
        ("toy, speed=1", UnknownNameError, "'speed' is not a setting of 'reach_for'; did you mean 'speed_m_s'?"),
        ("toy, speed_m_s=9", PolicyError, "speed_m_s=9 is not possible; give a number from 0.05 to 1.5"),
        ("toy, speed_m_s=nan", PolicyError, "give a number from 0.05 to 1.5"),
        ("toy, speed_m_s=", PolicyError, "give a number from 0.05 to 1.5"),
    ],
)
def test_what_is_wrong_is_said(text, error, says):
    with pytest.raises(error) as caught:
        read_arguments("reach_for", text, OPTIONS, most_words=2)
    assert says in str(caught.value)


@pytest.mark.parametrize("word", ["(1, 2)", "(a, b, c)", "(1, 2, inf)", "(1, 2, 3, 4)"])
def test_a_place_has_three_finite_numbers(word):
    with pytest.raises(PolicyError, match="give x, y and z in metres"):
        place_of(word)


def test_parentheses_mean_the_same_as_a_colon():
    for text in ("look_at(toy)+reflexes(3)+zero", "look_at:toy+reflexes:3+zero"):
        assert [(part.label, part.argument) for part in parse_policy(text)] == [
            *(("look_at", "toy"), ("reflexes", "3"), ("zero", None))
        ]


def test_a_plus_in_parentheses_separates_nothing():
    assert [part.argument for part in parse_policy("look_at(+0.3, +1, 2)+zero")] == ["+0.3, +1, 2", None]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("sit(", "a parenthesis is open"),
        ("zero()", "takes nothing in parentheses; write zero"),
        ("look_at()", "nothing stands in the parentheses; write look_at:TARGET"),
        ("look_at", "write look_at:TARGET"),
    ],
)
def test_a_text_that_is_no_policy_says_what_to_write(text, says):
    with pytest.raises(PolicyError) as caught:
        parse_policy(text)
    assert says in str(caught.value)


def test_eight_behaviours_come_with_mimoc():
    own = {name for name in POLICIES if POLICIES[name].is_behaviour}
    assert own == {"hold", "sit", "prone", "hands_and_knees", "stand", "kick", "look_at", "reach_for"}
