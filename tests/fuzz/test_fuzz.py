"""A few tries of each fuzzer; `make fuzz` makes thousands."""

import pytest
from fuzz.canaries import Canaries
from fuzz.fuzzing import FUZZERS, fuzzer, run_try
from fuzz.strange_infants import CANARIES
from support.full import FULL

SEED = 2026
LATER = {
    **dict.fromkeys(("honest_cohorts", "honest_specs"), FULL),
    **dict.fromkeys(("policies", "cohorts", "trainings"), pytest.mark.extras),
}
"""What takes long, and what trains."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=LATER.get(name, ())) for name in FUZZERS])
@pytest.mark.filterwarnings("ignore:the task of .* does not limit its episodes")
def test_nothing_that_strangers_change_breaks_mimoc(name, tmp_path):
    """It is used, or refused in clear lines, and no file outside of it is opened."""
    made, watch = fuzzer(name), Canaries(tmp_path / "outside", CANARIES)
    (tmp_path / "prepared").mkdir()
    prepared = made.prepare(tmp_path / "prepared")
    outcomes = []
    for number in range(made.short):
        (tmp_path / f"{number}").mkdir()
        outcomes.append(run_try(made, prepared, SEED, number, tmp_path / f"{number}", watch))
    watch.close()
    assert [outcome for outcome in outcomes if outcome.is_fault] == []
    assert {outcome.result for outcome in outcomes} >= ({"used"} if made.honest else {"used", "refused"})
