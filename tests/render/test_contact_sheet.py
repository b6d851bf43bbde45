"""Sheets of ages and poses: their pictures, captions and errors."""

import numpy as np
import pytest

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.render.picture_files import GAP_PX
from mimoc.render.picture_poses import poses_in_pictures
from mimoc.render.portrait import ALL, LARGEST, Framing, age_label, check_count, contact_sheet, portrait, read_poses

PX = 40


def cell(sheet, row, column, rows, columns):
    """Return one picture of a sheet, whose captions are at the top and at the left."""
    height, width, _ = sheet.shape
    top, left = height - (rows - row) * (PX + GAP_PX), width - (columns - column) * (PX + GAP_PX)
    return sheet[top : top + PX, left : left + PX]


def test_a_sheet_has_a_row_for_each_age_and_a_column_for_each_pose(bundle_at):
    infants, poses, done = [bundle_at(0), bundle_at(9)], ["supine", "standing", "crawling"], []
    sheet = contact_sheet(infants, poses, (PX, PX), progress=done.append)
    for row, infant in enumerate(infants):
        for column, pose in enumerate(poses):
            assert np.array_equal(cell(sheet, row, column, 2, 3), portrait(infant, pose, PX, PX)), pose
    assert done == [1, 2, 3, 4, 5, 6]


def test_in_one_pose_all_ages_are_in_one_row(bundle_at):
    infants = [bundle_at(0), bundle_at(9)]
    sheet = contact_sheet(infants, ["sitting"], (PX, PX), framing=Framing(crop="head"))
    assert sheet.shape[1] == 2 * (PX + GAP_PX) + GAP_PX
    for column, infant in enumerate(infants):
        wanted = portrait(infant, "sitting", PX, PX, framing=Framing(crop="head"))
        assert np.array_equal(cell(sheet, 0, column, 1, 2), wanted)


def test_infants_are_built_as_they_are_drawn(bundle_at):
    drawn = []

    def built():
        for age in (0, 9):
            yield bundle_at(age)
            drawn.append(age)

    contact_sheet(built(), ["supine"], (16, 16), progress=lambda done: drawn.append(f"picture {done}"))
    assert drawn == ["picture 1", 0, "picture 2", 9]


def test_poses_are_named_or_all(bundle_at):
    manifest = bundle_at(9).manifest
    assert read_poses(ALL, manifest) == list(poses_in_pictures(manifest))
    assert read_poses("prone, kicking", manifest) == ["prone", "kicking"]


@pytest.mark.parametrize("text", ["sit", "", "supine,,prone", "all,prone"])
def test_a_pose_that_is_none_is_refused(text, bundle_at):
    with pytest.raises(UnknownNameError, match="is not a pose"):
        read_poses(text, bundle_at(9).manifest)


def test_a_sheet_has_an_end():
    check_count(LARGEST, 1)
    with pytest.raises(MimocError, match=r"51 ages in 8 poses are 408 pictures; ask for at most 400"):
        check_count(51, 8)


def test_captions_say_ages_in_words():
    assert [age_label(age) for age in (0, 1, 2.5)] == ["0 months", "1 month", "2.5 months"]
