import csv
import shutil
from pathlib import Path

import numpy as np
import pytest

from mimoc.base.errors import DataError
from mimoc.fits import load_tables, tables
from mimoc.fits.standards import SEXES

FIRST_DAYS = {"length_cm": 0, "weight_kg": 0, "head_circumference_cm": 0, "arm_circumference_cm": 91}


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    copy = tmp_path / "data"
    shutil.copytree(tables.data_folder(), copy)
    monkeypatch.setattr(tables, "data_folder", lambda: copy)
    return copy


def reload() -> tables.GrowthTables:
    return load_tables.__wrapped__()


def test_every_table_ships_with_mimoc():
    assert tables.data_files().keys() == {
        "anthrokids.csv",
        "anthrokids_published_fits.csv",
        "postures.csv",
        *(f"who/{file}" for file in tables.WHO_FILES.values()),
    }


def test_tables_are_read_wherever_they_lie(folder):
    assert reload().anthrokids == load_tables().anthrokids
    assert reload().published == load_tables().published


def test_anthrokids_has_26_measurements_in_eight_age_groups():
    """But `rump_sole_length`, which the survey of children does not have."""
    groups = {name: len(means) for name, means in load_tables().anthrokids.items()}
    assert groups.pop("rump_sole_length") == 7
    assert len(groups) == 25
    assert set(groups.values()) == {8}


def test_age_groups_follow_one_another_without_gaps():
    for name, means in load_tables().anthrokids.items():
        starts = [mean.first_month for mean in means[1:]]
        assert starts == [mean.last_month + 1 for mean in means[:-1]], name


def test_a_group_mean_knows_its_line():
    lines = tables.data_files()["anthrokids.csv"].decode().splitlines()
    for name, means in load_tables().anthrokids.items():
        for mean in means:
            row = next(csv.reader([lines[mean.line - 1]]))
            assert (row[0], float(row[4])) == (name, mean.mean_cm)


def test_published_fits_are_in_centimetres():
    """The finger diameters are published in millimetres."""
    published = load_tables().published
    assert len(published) == 18
    assert 0.5 < published["thumb_diameter"](12) < 2
    assert 0.5 < published["middle_finger_diameter"](12) < 2


@pytest.mark.parametrize("indicator", tables.WHO_FILES)
@pytest.mark.parametrize("sex", SEXES)
def test_who_knows_every_day_of_two_years(indicator, sex):
    table = load_tables().who[indicator].tables[sex]
    assert table[:, 0].tolist() == list(range(FIRST_DAYS[indicator], 731))
    assert np.isfinite(table).all()
    assert (table[:, 2:] > 0).all()


def test_every_shipped_number_is_finite_and_in_centimetres():
    """No length of a child of up to three and a half years is over 110 cm."""
    means_cm = [mean.mean_cm for means in load_tables().anthrokids.values() for mean in means]
    assert all(1 < mean_cm < 110 for mean_cm in means_cm)
    for curve in load_tables().published.values():
        assert np.isfinite([curve.a, curve.b_months, curve.c]).all()


def test_missing_tables_are_a_data_error(tmp_path, monkeypatch):
    monkeypatch.setattr(tables, "__file__", str(tmp_path / "mimoc" / "fits" / "tables.py"))
    with pytest.raises(DataError, match="install mimoc again"):
        tables.data_folder()


DAMAGE = {
    "a word for a number": ("anthrokids.csv", lambda text: text.replace("10.2", "ten")),
    "not a number": ("anthrokids.csv", lambda text: text.replace("10.2", "nan")),
    "a column gone": ("anthrokids.csv", lambda text: text.replace("first_month", "month")),
    "a column twice": ("anthrokids.csv", lambda text: text.replace("survey", "mean")),
    "a row twice": ("anthrokids.csv", lambda text: text + text.splitlines()[1] + "\n"),
    "two curves of one measurement": ("anthrokids_published_fits.csv", lambda text: text + text.splitlines()[1] + "\n"),
    "cut off in a row": ("anthrokids_published_fits.csv", lambda text: text[: text.index("calf") + 8]),
    "an empty file": ("who/length_for_age.csv", lambda text: ""),
    "girls gone": ("who/weight_for_age.csv", lambda text: text[: text.index("female")]),
    "a word in WHO's": ("who/head_circumference_for_age.csv", lambda text: text.replace("34.4618", "x")),
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.filterwarnings("ignore:.*input contained no data")
def test_a_damaged_table_is_a_data_error_that_names_it(damage, folder):
    file, change = DAMAGE[damage]
    path = folder / file
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(DataError, match=path.name):
        reload()


@pytest.mark.parametrize("file", ["anthrokids_published_fits.csv", "who/arm_circumference_for_age.csv"])
def test_a_single_missing_table_is_a_data_error_that_names_it(file, folder):
    (folder / file).unlink()
    with pytest.raises(DataError, match=Path(file).name):
        reload()


def test_tables_cannot_be_changed_by_accident():
    with pytest.raises(TypeError):
        load_tables().anthrokids["head_circumference"] = ()  # type: ignore[index]
