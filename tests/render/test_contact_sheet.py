"""Sheets of ages and poses: their pictures, captions and errors."""

import numpy as np
import pytest

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.render.picture_files import FONT_PX, GAP_PX, tile_pictures
from mimoc.render.picture_poses import poses_in_pictures
from mimoc.render.portrait import (
    ALL,
    MAX_PICTURES,
    Framing,
    age_label,
    check_count,
    contact_sheet,
    portrait,
    read_poses,
)

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
    check_count(MAX_PICTURES, 1)
    with pytest.raises(MimocError, match=r"51 ages in 8 poses are 408 pictures; ask for at most 400"):
        check_count(51, 8)


def test_captions_say_ages_in_words():
    assert [age_label(age) for age in (0, 1, 2.5)] == ["0 months", "1 month", "2.5 months"]


PLAIN = [[np.full((40, 60, 3), 10 * row + column, np.uint8) for column in range(3)] for row in range(2)]


def find(sheet, picture):
    """Return the row and column of the only place of a sheet where a picture stands."""
    height, width, _ = picture.shape
    places = [
        (row, column)
        for row in range(sheet.shape[0] - height + 1)
        for column in range(sheet.shape[1] - width + 1)
        if (sheet[row, column] == picture[0, 0]).all()
        and np.array_equal(sheet[row : row + height, column : column + width], picture)
    ]
    assert len(places) == 1
    return places[0]


def test_every_picture_is_on_the_sheet_whole_and_in_its_place():
    sheet = tile_pictures(PLAIN, ["one", "two", "three"], ["above", "below"])
    places = np.array([[find(sheet, picture) for picture in row] for row in PLAIN])
    assert (np.diff(places[..., 0], axis=0) == 40 + GAP_PX).all()
    assert (np.diff(places[..., 1], axis=1) == 60 + GAP_PX).all()
    assert (np.diff(places[..., 0], axis=1) == 0).all()
    assert sheet.dtype == np.uint8


def test_without_captions_there_is_only_a_narrow_border():
    assert tile_pictures(PLAIN).shape == (2 * (40 + GAP_PX) + GAP_PX, 3 * (60 + GAP_PX) + GAP_PX, 3)


def test_rows_may_be_of_different_lengths():
    sheet = tile_pictures([PLAIN[0], PLAIN[1][:1]])
    assert (sheet[-40 - GAP_PX :, 60 + 2 * GAP_PX :] == 255).all()
    assert find(sheet, PLAIN[1][0])


@pytest.mark.parametrize(
    "caption", ["a", "twelve months", "so long that it cannot stand above a picture as narrow as this"]
)
def test_captions_stand_above_their_own_column(caption):
    sheet = tile_pictures(PLAIN, ["", caption, ""])
    top, left = find(sheet, PLAIN[0][1])
    ink = np.argwhere((sheet[:top] < 200).all(axis=-1))
    assert len(ink)
    assert left <= ink[:, 1].min() <= ink[:, 1].max() < left + 60
    assert abs(ink[:, 1].mean() - (left + 30)) < 6


def test_captions_of_rows_run_upwards_on_their_left():
    sheet = tile_pictures(PLAIN, rows=["", "l........."])
    top, left = find(sheet, PLAIN[1][0])
    ink = np.argwhere((sheet[:, :left] < 128).all(axis=-1))
    assert top <= ink[:, 0].min() <= ink[:, 0].max() < top + 40
    tall = [ink[ink[:, 0] == row, 1] for row in (ink[:, 0].max(), ink[:, 0].min())]
    assert np.ptp(tall[0]) > np.ptp(tall[1])


def test_letters_grow_with_the_pictures_within_reason():
    def letters_px(height):
        pictures = [[np.zeros((height, 400, 3), np.uint8)]]
        sheet = tile_pictures(pictures, ["l"])
        above = sheet[: find(sheet, pictures[0][0])[0]]
        return np.ptp(np.argwhere((above < 200).all(axis=-1))[:, 0])

    assert letters_px(20) == letters_px(100) < letters_px(250) < letters_px(600) == letters_px(800) <= FONT_PX[1]
