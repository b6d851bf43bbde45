"""Does growing help? What is compared, and what the page says of it."""

from collections import Counter

import pytest

from mimoc.studies.experiments.growing import AGES_MONTHS, QUICK_STEPS, STEPS, comparison, reaching, schedule_of
from mimoc.studies.experiments.learner import Learner, by_group
from mimoc.studies.notebook import page_text
from mimoc.training import Curve, Episode, Training

NUMBERS = {"steps": 1000, "seeds": 3, "balls": 2, "check_balls": 1}
NUMBERS |= dict.fromkeys(("reproduction", "training_seeds", "first_ball"), "")


def learner(schedule: str, seed: int, time_s: float, early_s: float, tmp_path) -> Learner:
    """Return an infant that takes so long to touch each ball, and so long at its first checkpoint."""
    reaches = [Episode(ball, 10, time_s, 90.0, True, None) for ball in range(2)]
    early = [Episode(0, 10, early_s, 10.0, False, None)]
    checks = {500: early, 1000: reaches[:1]}
    return Learner(schedule, seed, Training(Curve(), tmp_path, 0), reaches, checks)


@pytest.fixture
def page(tmp_path):
    """Return what writes the page for the times of each schedule, by seed."""

    def write(**times_s: list[tuple[float, float]]) -> str:
        learners = [
            learner(name, seed, *each, tmp_path) for name, times in times_s.items() for seed, each in enumerate(times)
        ]
        untrained = [Episode(0, 100, 3.0, 5.0, True, None), Episode(1, 1000, 10.0, -5.0, False, None)]
        return page_text("growing", **comparison(by_group(learners), untrained, (6, 12)), **NUMBERS)

    return write


FAST, SLOW, MIXED = (
    [(time, 5 * time) for time in times] for times in ((0.1, 0.2, 0.3), (0.4, 0.5, 0.6), (0.2, 0.4, 0.6))
)


def test_the_infant_is_of_the_oldest_age_and_matures():
    resolved = reaching(12.0).files["resolved.yaml"].decode().splitlines()
    assert "age_months: 12.0" in resolved
    assert "development: published" not in resolved


@pytest.mark.parametrize("steps", [STEPS, QUICK_STEPS])
def test_all_schedules_but_adult_have_the_same_ages_for_equally_long(steps):
    """Up to the one control step that a stage can be longer than another."""
    courses = ("grown", "reversed", "shuffled")
    counts = [Counter(map(schedule_of(name, 1, steps), range(steps))) for name in courses]
    assert [set(count) == set(counts[0]) for count in counts] == [True] * 3
    assert all(max(count.values()) - min(count.values()) <= 1 for count in counts)
    assert set(map(schedule_of("adult", 1, steps), range(steps))) == {AGES_MONTHS[1]}


def test_reaches_that_fail_count_with_their_whole_length(tmp_path):
    found = learner("grown", 0, 0.2, 1.0, tmp_path)
    assert found.time_s() == pytest.approx(0.2)
    assert found.check_times_s() == {500: 1.0, 1000: 0.2}
    assert found.time_over_checkpoints_s() == pytest.approx(0.6)


def test_the_page_says_that_growing_helped_only_if_every_seed_is_ahead(page):
    text = page(grown=FAST, adult=SLOW, reversed=SLOW, shuffled=SLOW)
    assert "**Growing helped here" in text
    assert "better than every other" in text
    assert "`grown` against `adult`, time to touch after training: better, -60%" in text


def test_the_page_says_that_growing_did_not_help_if_every_seed_is_behind(page):
    text = page(grown=SLOW, adult=FAST, reversed=SLOW, shuffled=MIXED)
    assert "**Growing did not help here" in text
    assert "is not shown by both measures" in text


def test_the_page_claims_nothing_if_the_seeds_overlap(page):
    text = page(grown=MIXED, adult=FAST, reversed=SLOW, shuffled=MIXED)
    assert "**No effect of growing is shown here" in text


def test_the_page_tells_gain_and_loss_apart(page):
    early_but_worse = [(time, 0.1) for time, _ in SLOW]
    text = page(grown=early_but_worse, adult=[(0.1, 9.0)] * 3, reversed=SLOW, shuffled=SLOW)
    assert (
        "**Growing helped with time to touch over all checkpoints, and harmed time to touch after training.**" in text
    )


def test_the_page_says_how_often_chance_would_part_the_seeds(page):
    """Of the 20 ways to deal six numbers to two groups of three, two part them."""
    assert "10% of such comparisons" in page(grown=FAST, adult=SLOW, reversed=SLOW, shuffled=SLOW)


def test_the_page_says_that_studies_disagree_and_how_little_of_its_steps_a_body_has_had(page):
    text = page(grown=FAST, adult=SLOW, reversed=SLOW, shuffled=SLOW)
    assert "Naya-Varela" in text
    assert "1/25" in text
    assert "random policy touches 50% of the balls" in " ".join(text.split())
