import pytest

from mimoc.components.senses.vision.build import acuity_at
from mimoc.studies.experiments.acuity import PAPER_MONTHS, PROFILE, SHARES_OF_ACUITY, transfers


@pytest.mark.parametrize("age_months", PAPER_MONTHS)
def test_the_filter_leaves_what_the_law_says(age_months):
    found = list(transfers(age_months, acuity_at(age_months, PROFILE)))
    assert len(found) == len(SHARES_OF_ACUITY)
    for each in found:
        assert each.measured == pytest.approx(each.law, abs=0.002)


def test_gratings_are_about_as_fine_as_asked_for():
    for each, share in zip(transfers(6, 4.0), SHARES_OF_ACUITY, strict=True):
        assert each.frequency_cpd == pytest.approx(share * 4.0, abs=0.005)
        assert each.acuity_cpd == 4.0


def test_nothing_finer_than_acuity_is_seen():
    assert all(each.law == 0 and abs(each.measured) < 0.002 for each in transfers(2, 1.5) if each.frequency_cpd > 1.5)
