import io
import itertools
import shlex
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import mimoc
from mimoc.base.errors import MimocError
from mimoc.cli.pictures import read_ages
from mimoc.components.senses.vision.build import acuity_at


@pytest.fixture
def see(invoke, here):
    return lambda arguments, infant: invoke("see", infant, *shlex.split(arguments))


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    def write(name, **keys):
        spec = {"mimoc": 1, "name": name, "age_months": 9, "scene": {"pose": "sitting"}, **keys}
        compiled = mimoc.build(mimoc.InfantSpec.model_validate(spec))
        return mimoc.write_bundle(compiled, tmp_path_factory.mktemp("bundles") / name)

    return write


@pytest.fixture(scope="module")
def blind(built) -> Path:
    return built("blind")


@pytest.fixture(scope="module")
def playing(built) -> Path:
    return built("playing", scene={"kind": "room", "seed": 1, "pose": "sitting", "toys": {"count": [6, 6]}})


def pixels(path: str) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(Path(path).read_bytes()))).astype(int)


def rows_of(sheet: np.ndarray, columns: int, size_px: int) -> list[np.ndarray]:
    """Return the two rows of pictures of a sheet, each shape (columns, size, size, 3)."""
    edges = range(sheet.shape[0] - 2 * (size_px + 6), sheet.shape[0], size_px + 6)
    left = sheet.shape[1] - columns * (size_px + 6)
    starts = range(left, sheet.shape[1], size_px + 6)
    return [np.stack([sheet[top : top + size_px, at : at + size_px] for at in starts]) for top in edges]


def test_it_draws_every_age_as_seen_and_foveated_beside_what_is_drawn(see, playing):
    code, out, err = see("-o seen.png --ages 1,4,12 --size 128", playing)
    assert (code, out, err) == (0, "seen.png\n", "")
    (*blurred, drawn), foveated = rows_of(pixels("seen.png"), 4, 128)
    lost = [np.abs(picture - drawn).mean() for picture in blurred]
    assert lost == sorted(lost, reverse=True)
    assert lost[0] > 1
    assert np.abs(foveated - [*blurred, drawn]).mean(axis=(1, 2, 3)).min() > 2


def test_ages_of_two_to_twelve_months_differ_visibly(see, playing):
    """As the command draws it when it is told nothing else: by several levels of grey where there are edges."""
    assert see("-o seen.png --ages 2,4,6,12", playing)[0] == 0
    pictures = rows_of(pixels("seen.png"), 5, 256)[0]
    for younger, older in itertools.pairwise(pictures):
        assert np.percentile(np.abs(younger - older), 99) > 5
    fine = acuity_at(12, "tac2")
    assert 2 * fine * 18 <= 256  # Two pixels for each cycle of the finest grating.


def test_profile_foveation_and_size_can_be_chosen(see, blind):
    sheets = []
    for options in (
        "",
        "--profile mayer1995",
        "--foveation 30",
        "--eye right",
        "--pose prone",
        "--down 0",
        "--fovy 60",
    ):
        assert see(f"-o seen.png --ages 2 --size 64 {options}", blind)[0] == 0
        sheets.append(pixels("seen.png"))
    for other in sheets[1:]:
        assert not np.array_equal(rows_of(sheets[0], 2, 64)[1], rows_of(other, 2, 64)[1])


def test_profile_and_foveation_are_the_infants_own(see, blind, built):
    own = built("seeing", senses={"vision": {"acuity_profile": "mimo_v2", "foveation": 12}})
    assert see("-o own.png --ages 2 --size 64", own)[0] == 0
    assert see("-o given.png --ages 2 --size 64 --profile mimo_v2 --foveation 12", blind)[0] == 0
    assert Path("own.png").read_bytes() == Path("given.png").read_bytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--ages one", "'one' is not a list of ages; give months from 0 to 36, as in 1,2.5,12"),
        ("--ages 1,99", "'1,99' is not a list of ages"),
        ("--eye middle", "'middle' is not a side; choose from left, right"),
        ("--pose sit", "'sit' is not a pose; did you mean 'sitting'?"),
        ("--profile mayer", "'mayer' is not a profile of acuity; did you mean 'mayer1995'?"),
    ],
)
def test_bad_input_ends_in_exit_code_2_with_one_line_and_nothing_written(options, message, see, blind):
    code, out, err = see(f"-o seen.png {options}", blind)
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert err.startswith(message)
    assert not Path("seen.png").exists()


def test_what_shows_nothing_is_said_in_one_note(see, blind, playing):
    """On its back, an infant without a room looks at the sky."""
    code, out, err = see("-o seen.png --pose supine --size 64", blind)
    written, note = out.splitlines()
    assert (code, written, err) == (0, "seen.png", "")
    assert note.startswith("note: the eye sees one plain surface")
    assert see("-o seen.png --pose sitting --size 64", playing) == (0, "seen.png\n", "")


def test_an_eye_that_an_infant_has_not_is_refused(see, built):
    code, _, err = see("-o seen.png", built("one_eyed", body={"remove": ["left_eye"]}))
    assert (code, err) == (2, "'eye_left' is not a camera of this infant; choose from eye_right\n")


def test_ages_of_a_sheet_are_read_in_months():
    assert read_ages("0, 2.5,24") == (0, 2.5, 24)


@pytest.mark.parametrize("text", ["", "old", "3,", "-1", "0,25", "nan"])
def test_what_is_no_list_of_ages_of_infants_is_refused(text):
    with pytest.raises(MimocError, match=r"is not a list of ages; give months from 0 to 24, as in 0,3,6,12,24"):
        read_ages(text)
