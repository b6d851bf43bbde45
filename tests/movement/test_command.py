"""`mimoc movement`."""

import json
import re
from dataclasses import replace

import pytest
from support import filmed
from support.moving import restless

from mimoc.motion.reading import write_points

SPEC = "mimoc: 1\nname: three\nage_months: 3\nsenses: {proprioception: {}}\nscene: {pose: supine}\n"


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch, folder):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "three.yaml").write_text(SPEC)
    return tmp_path


def test_a_recording_is_measured(invoke):
    code, out, err = invoke("movement", "filmed/infant0.npz")
    assert (code, err) == (0, "")
    assert "Hand: speed, median [trunk/s]" in out
    assert "distance" not in out
    assert "Hands: distance" not in out


def test_what_files_do_not_say_is_an_option_that_messages_name(invoke, place):
    seen = restless(0, 4.0)
    table = write_points(replace(seen, positions=seen.positions * [-1, 1]), place / "film.csv").read_text()
    (place / "film.csv").write_text(re.sub("^([^,]*),[^,]*,", r"\1,", table, flags=re.MULTILINE))  # Without times.
    assert invoke("movement", "film.csv").err.endswith("say how many frames a second the camera took: --rate 30\n")
    assert "give --view back, if" in invoke("movement", "film.csv", "--rate", "30").err
    assert invoke("movement", "film.csv", "--rate", "30", "--view", "mirrored").code == 0


@pytest.mark.full
def test_shares_of_a_picture_and_axes_of_space_are_asked_about_by_options(invoke, place):
    filmed.write_mediapipe(filmed.filmed(300, filmed.BODY_25_POINTS), place / "shares.csv")
    assert "give the size of the picture, --picture 1920,1080" in invoke("movement", "shares.csv", "--rate", "30").err
    assert invoke("movement", "shares.csv", "--rate", "30", "--picture", "640x480").code == 0
    assert "'big' is not the size of a picture" in invoke("movement", "shares.csv", "--picture", "big").err
    space = filmed.in_space(300)
    write_points(replace(space, positions=space.positions * [1, -1, -1]), place / "space.npz")
    assert "or --up -z if that axis points upwards" in invoke("movement", "space.npz").err
    assert invoke("movement", "space.npz", "--up", "-z").code == 0
    assert "'w' is not a choice of the axis" in invoke("movement", "space.npz", "--up", "w").err


def test_a_label_that_says_nothing_is_named_by_an_option(invoke, place):
    table = write_points(restless(0, 4.0), place / "film.csv").read_text()
    (place / "film.csv").write_text(table.replace("left_hip_", "p7_"))
    assert "name its points: --name label=left_hip" in invoke("movement", "film.csv").err
    assert invoke("movement", "film.csv", "--name", "p7=left_hip").code == 0
    assert invoke("movement", "film.csv", "--name", "p7").err.endswith("write it as p7=left_foot\n")


def test_points_that_are_unsure_are_left_out_or_not_by_an_option(invoke, place):
    seen = restless(0, 4.0)
    write_points(replace(seen, confidence=seen.confidence * 0.2), place / "film.csv")
    said = "has a confidence below 0.3 at 100% of its points; if they can be trusted: --min-score 0\n"
    assert invoke("movement", "film.csv").err.endswith(said)
    assert invoke("movement", "film.csv", "--min-score", "0.2").code == 0
    assert invoke("movement", "film.csv", "--min-score", "2").code == 2


def test_all_measures_are_printed_on_request(invoke):
    assert "Hands: distance [trunk]" in invoke("movement", "filmed/infant0.npz", "--full").out


@pytest.mark.full
def test_infants_are_compared_with_real_ones(invoke, place):
    code, out, _ = invoke("movement", "filmed", "--against", "real", "--json", "out.json", "--plot", "out.png")
    assert code == 0
    assert "distance of the mean to 12 real infants (MINI-RGBD): " in out
    assert "told apart in windows of 8 s: about " in out
    assert out.endswith("out.json\nout.png\n")
    assert json.loads((place / "out.json").read_text())["against"]["infants"] == 12


def test_every_number_has_a_spread_and_its_n(invoke, place):
    impaired = SPEC.replace("name: three", "name: impaired\nimpairments: {preset: hemiparesis, side: left}")
    (place / "impaired.yaml").write_text(impaired)
    simulated = ("--policy", "random", "--seeds", "0:2", "--seconds", "2", "--beside", "healthy", "--against", "real")
    for arguments in (("filmed", "--against", "real"), ("filmed/infant0.npz",), ("impaired.yaml", *simulated)):
        code, out, _ = invoke("movement", *arguments)
        assert code == 0
        headings = [cell.strip() for cell in out.splitlines()[2].split("┃")[1:-1]]
        assert ("healthy" in headings) == ("--beside" in arguments)
        rows = [line.split("│")[1:-1] for line in out.splitlines() if line.startswith("│")]
        assert len(rows) == 21
        for heading, *cells in zip(headings, *rows, strict=True):
            for cell in map(str.strip, cells):
                if heading not in ("measure", "z") and cell:
                    assert re.fullmatch(r"-?[\d.]+ ± [\d.]+ \(\d+\)", cell), (heading, cell)


@pytest.mark.full
def test_the_same_command_writes_the_same(invoke, place):
    written = []
    for name in ("a.json", "b.json"):
        invoke("movement", "filmed", "--against", "real", "--json", name)
        written.append((place / name).read_bytes())
    assert written[0] == written[1]


def test_infants_are_compared_with_recordings_of_ones_own(invoke):
    out = invoke("movement", "filmed", "--against", "filmed").out
    assert "distance of the mean to 3 recordings: 0.00" in out
    assert "told apart in windows of 8 s: 0." in out


@pytest.mark.full
def test_a_spec_is_simulated_and_drawn(invoke, place):
    options = ("--policy", "random", "--seeds", "0:2", "--seconds", "3", "--gif", "two.gif", "--phase", "two.png")
    code, out, _ = invoke("movement", "three.yaml", *options)
    assert code == 0
    assert "2 infants" in out
    assert out.endswith("two.png\ntwo.gif\n")
    assert (place / "two.gif").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nowhere",), "nowhere: does not exist; name a recording"),
        (("three.yaml",), "say how it moves with --policy"),
        (("three.yaml", "--policy", "rnadom"), "rnadom"),
        (("filmed", "--against", "nowhere"), "nowhere: does not exist; compare with `real`"),
        (("filmed", "--against", "filmed/infant0.npz"), "one infant is no sample"),
        (("filmed", "--plot", "a.txt"), "not a supported format for plots"),
        (("filmed", "--gif", "a.txt"), "not a supported video format"),
        (("filmed", "--json", "no/a.json"), "there is no folder no"),
        (("filmed", "--phase", "a.png", "--json", "a.json"), "--phase needs angles"),
        (("three.yaml", "--policy", "random", "--seeds", "2:1"), "is a range of 0 seeds"),
        (("three.yaml", "--policy", "random", "--rate", "30"), "--rate says how points are read"),
        (
            ("three.yaml", "--policy", "random", "--against", "real", "--view", "back"),
            "--view says how points are read",
        ),
        (("filmed", "--seeds", "0:2"), "--seeds is for an infant that is simulated"),
        (("filmed", "--against", "real", "--seconds", "5"), "--seconds is for an infant that is simulated"),
        (("filmed", "--beside", "healthy"), "--beside is for an infant that is simulated"),
    ],
)
def test_what_is_wrong_is_one_line_and_nothing_is_written(invoke, place, arguments, message):
    before = sorted(place.rglob("*"))
    code, _, err = invoke("movement", *arguments)
    assert (code, len(err.strip().splitlines())) == (2, 1), err
    assert message in err
    assert sorted(place.rglob("*")) == before
