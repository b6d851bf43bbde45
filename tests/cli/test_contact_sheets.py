"""The ages that `mimoc render --ages` reads."""

import pytest

from mimoc.base.errors import MimocError
from mimoc.cli.contact_sheets import read_ages


def test_ages_are_read_in_months():
    assert read_ages("0, 2.5,24") == (0, 2.5, 24)


@pytest.mark.parametrize("text", ["", "old", "3,", "-1", "0,25", "nan"])
def test_what_is_no_list_of_ages_of_infants_is_refused(text):
    with pytest.raises(MimocError, match=r"is not a list of ages; give months from 0 to 24, as in 0,3,6,12,24"):
        read_ages(text)
