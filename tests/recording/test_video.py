import sys
from fractions import Fraction

import numpy as np
import pytest

from mimoc.base.errors import MissingExtraError, OutputError
from mimoc.recording import video
from mimoc.recording.video import check_video, open_video


def pictures(count: int, height: int = 48, width: int = 64) -> list[np.ndarray]:
    """Return pictures of a bright bar that moves over a dark ground."""
    found = np.full((count, height, width, 3), 40, np.uint8)
    for number, picture in enumerate(found):
        picture[:, 8 * number % width :][:, :8] = (230, 60, 120)
    return list(found)


def write(path, shown, rate_hz=25):
    film = open_video(path, Fraction(rate_hz))
    for picture in shown:
        film.add(picture)
    return film.save()


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "FILM.GIF"])
def test_what_is_read_is_what_was_written(name, tmp_path, watch):
    """In this order, for as long, and nearly in these colours."""
    shown = pictures(7)
    file = write(tmp_path / name, shown)
    seen, ends_s = watch(file.rename(tmp_path / name.lower()))
    assert seen.shape == (7, 48, 64, 3)
    assert ends_s == pytest.approx([0.04 * number for number in range(1, 8)])
    assert np.abs(seen.astype(int) - shown).mean() < 4
    assert all(not np.array_equal(one, other) for one, other in zip(seen[1:], seen, strict=False))
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize("rate_hz", [7, 12, 30, 60])
def test_a_gif_keeps_time_at_any_rate(rate_hz, tmp_path, watch):
    """To the hundredth of a second that it can say, also in the long run."""
    _, ends_s = watch(write(tmp_path / "film.gif", pictures(40), rate_hz))
    assert ends_s == pytest.approx([number / rate_hz for number in range(1, 41)], abs=0.0051)


@pytest.mark.parametrize("size", [(47, 63), (33, 18)])
def test_odd_sizes_are_made_even_for_mp4(size, tmp_path, watch):
    seen, _ = watch(write(tmp_path / "film.mp4", pictures(3, *size)))
    assert seen.shape == (3, size[0] + size[0] % 2, size[1] + size[1] % 2, 3)


@pytest.mark.parametrize("codec", video.CODECS)
def test_each_codec_gives_an_mp4(codec, tmp_path, watch, monkeypatch):
    monkeypatch.setattr(video, "CODECS", (codec,))
    assert len(watch(write(tmp_path / "film.mp4", pictures(5)))[0]) == 5


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_a_film_that_is_discarded_leaves_what_was_there(name, tmp_path):
    (tmp_path / name).write_bytes(b"older")
    film = open_video(tmp_path / name, Fraction(25))
    film.add(pictures(1)[0])
    film.discard()
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(name, b"older")]


@pytest.mark.parametrize("name", ["film.avi", "film", "film.mp4.txt", ".gif"])
def test_other_names_are_no_videos(name, tmp_path):
    with pytest.raises(OutputError, match=r"not a supported video format; end the name in \.mp4 or \.gif$"):
        check_video(tmp_path / name)


def test_a_video_needs_a_folder_and_is_none(tmp_path):
    (tmp_path / "film.gif").mkdir()
    with pytest.raises(OutputError, match=r"film\.gif: this is a folder"):
        check_video(tmp_path / "film.gif")
    with pytest.raises(OutputError, match="there is no folder"):
        check_video(tmp_path / "nowhere" / "film.gif")


def test_without_pyav_there_are_only_gifs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(MissingExtraError, match=r"^av is not installed; run: pip install 'mimoc\[record\]'$"):
        check_video(tmp_path / "film.mp4")
    assert write(tmp_path / "film.gif", pictures(2)).stat().st_size


def test_a_gif_does_not_grow_without_end(tmp_path, monkeypatch):
    monkeypatch.setattr(video, "MAX_GIF_FRAMES", 3)
    with pytest.raises(OutputError, match=r"a GIF can have at most 3 frames; record fewer steps, or an \.mp4"):
        write(tmp_path / "film.gif", pictures(4))
