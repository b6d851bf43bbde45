"""Paint the pictures that ship with mimoc: `python sculpt/make_pictures.py`, or `.ci/task pictures`."""

from collections.abc import Iterator, Mapping

import numpy as np
from pictures import adult, cloth, cubes, face, floors, walls
from pictures.inks import Painted, with_palette

from mimoc.compiler.looks.pictures import FOLDER, INKS, MIXTURES, encode_palette_png
from mimoc.compiler.looks.wallpaper import CEILINGS, FLOORS, PICTURES, WALLS
from mimoc.schema.body import ADULT_EXPRESSIONS, EXPRESSIONS

HEAD_BREADTH = 0.863
"""Breadth of a head relative to the diameter of a circle with its circumference: .871 at birth, .859 at 24 months
(AnthroKids)."""
CUBE_COLOURS = 96  # Of a texture of a solid.


def main() -> None:
    """Write all pictures and their mixtures of inks, and remove those that are not painted any more."""
    FOLDER.mkdir(exist_ok=True)
    for path in FOLDER.glob("*.png"):
        path.unlink()
    pictures = dict(paint_pictures())
    for name, picture in pictures.items():
        (FOLDER / f"{name}.png").write_bytes(picture.png if isinstance(picture, Painted) else picture)
    mixtures = {name: picture.mixtures for name, picture in pictures.items() if isinstance(picture, Painted)}
    write_mixtures(mixtures)


def write_mixtures(mixtures: Mapping[str, np.ndarray]) -> None:
    """Write the mixtures of inks in the palettes of pictures."""
    np.savez_compressed(FOLDER / MIXTURES, inks=np.array(INKS), **dict(mixtures))


def paint_pictures() -> Iterator[tuple[str, bytes | Painted]]:
    """Yield the name of each picture, and its PNG or, if its colours are a spec's, what it was painted with."""
    for table, module in ((FLOORS, floors), (CEILINGS, floors), (WALLS, walls), (PICTURES, walls)):
        for name, wallpaper in table.items():
            yield wallpaper.name, encode_palette_png(getattr(module, name)())
    for name in EXPRESSIONS:
        yield f"face_{name}", with_palette(cubes.draw_face(name, HEAD_BREADTH), CUBE_COLOURS)
        yield f"face_round_{name}", with_palette(cubes.draw_face(name), CUBE_COLOURS)
        yield f"skin_face_{name}", face.paint_face(name)
    for name in ADULT_EXPRESSIONS:
        yield f"adult_face_{name}", encode_palette_png(adult.draw_adult(name))
    yield "eye", with_palette(cubes.draw_eye(), CUBE_COLOURS)
    yield "ear", with_palette(cubes.draw_ear(), CUBE_COLOURS)
    yield "stripes", with_palette(cubes.draw_stripes(), CUBE_COLOURS)
    yield "skin_body", cloth.paint_skin()
    yield "skin_hair", cloth.paint_hair()
    yield "skin_shirt", cloth.paint_top()
    yield "skin_trousers", cloth.paint_bottom()


if __name__ == "__main__":
    main()
