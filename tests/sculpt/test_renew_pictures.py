"""The program that draws the pictures of the documentation again."""

import re
from pathlib import Path

import pytest
import renew_pictures
from PIL import Image
from renew_pictures import PICTURES, beside, in_rows, spec

import mimoc

CHECKOUT = Path(__file__).parents[2]


def test_every_picture_with_a_recipe_is_small_and_shown_on_some_page():
    pages = [CHECKOUT / "README.md", *CHECKOUT.glob("docs/*.md"), *CHECKOUT.glob("examples/gallery/*.rst")]
    shown = {name for page in pages for name in re.findall(r"[\w-]+\.png", page.read_text(encoding="utf-8"))}
    assert set(PICTURES) - shown == set()
    for name, recipe in PICTURES.items():
        assert (CHECKOUT / "docs" / name).stat().st_size <= 1000 * recipe.most_kb


def test_recipes_know_all_tones_of_skin():
    tones = [looks["skin"] for looks in renew_pictures.LOOKS]
    assert len(tones) == len(set(tones)) == 6


def test_specs_that_recipes_write_are_read(tmp_path):
    commands = renew_pictures.Mimoc(CHECKOUT, tmp_path)
    loaded = mimoc.load_spec(spec(commands, "child", 3, body={"looks": {"hair": "red"}}))
    assert (loaded.age_months, loaded.body.looks.hair) == (3, "red")


def test_pictures_are_put_together_in_rows_and_side_by_side():
    red, blue = (Image.new("RGB", (30, 20), colour) for colour in ("red", "blue"))
    assert in_rows([red, blue, red], 2, gap=4).size == (64, 44)
    assert in_rows([red, blue], 2, ["a", "b"]).size == (64, 46)
    joined = beside(red, blue.resize((60, 40)), gap=0)
    assert joined.size == (60, 20)
    assert (joined.getpixel((10, 10)), joined.getpixel((50, 10))) == ((255, 0, 0), (0, 0, 255))


def test_a_picture_that_is_too_large_gets_fewer_colours_or_an_error(tmp_path, capsys):
    picture = Image.radial_gradient("L").convert("RGB").rotate(30)
    renew_pictures.write(tmp_path / "whole.png", picture, 400)
    with Image.open(tmp_path / "whole.png") as written:
        assert written.mode == "RGB"
    fewer = (tmp_path / "whole.png").stat().st_size // 1000
    renew_pictures.write(tmp_path / "few.png", picture, max(fewer - 1, 1))
    assert "few.png: 256 x 256" in capsys.readouterr().out
    with pytest.raises(SystemExit, match="more than 0; draw it smaller"):
        renew_pictures.write(tmp_path / "none.png", picture, 0)


def test_a_command_that_fails_is_shown(tmp_path):
    with pytest.raises(SystemExit, match="no-such-command"):
        renew_pictures.Mimoc(CHECKOUT, tmp_path)("no-such-command")
