"""Paint the pictures that ship with mimoc: `python sculpt/make_pictures.py`, or `make pictures`."""

from collections.abc import Iterator

from pictures import adult, ceilings, cloth, cubes, floors, framed, skin, walls
from pictures.expressions import FACES

from mimoc.looks.appearance import TOP
from mimoc.looks.pictures import FOLDER, encode_palette_png, encode_png
from mimoc.looks.wallpaper import CEILINGS, FLOORS, PICTURES, WALLS

HEAD_BREADTH = 0.863
"""Breadth of a head relative to the diameter of a circle with its circumference: .871 at birth, .859 at 24 months
(AnthroKids)."""


def main() -> None:
    """Write all pictures, and remove those that are not painted any more."""
    FOLDER.mkdir(exist_ok=True)
    for path in FOLDER.glob("*.png"):
        path.unlink()
    for name, png in paint_pictures():
        (FOLDER / f"{name}.png").write_bytes(png)


def paint_pictures() -> Iterator[tuple[str, bytes]]:
    """Yield the name and the PNG of each picture."""
    for table, module in ((FLOORS, floors), (CEILINGS, ceilings), (WALLS, walls), (PICTURES, framed)):
        for name, wallpaper in table.items():
            yield wallpaper.name, encode_palette_png(getattr(module, name)())
    for name in FACES:
        yield f"face_{name}", encode_png(cubes.draw_face(name, HEAD_BREADTH))
        yield f"face_round_{name}", encode_png(cubes.draw_face(name))
        yield f"skin_face_{name}", skin.paint_face(name)
        yield f"adult_face_{name}", encode_palette_png(adult.draw_adult(name))
    yield "eye", encode_png(cubes.draw_eye())
    yield "ear", encode_png(cubes.draw_ear())
    yield "stripes", encode_png(cubes.draw_stripes(TOP, cloth.TOP_STRIPE))
    yield "skin_body", encode_png(skin.paint_skin())
    yield "skin_shirt", encode_png(cloth.paint_top())
    yield "skin_trousers", encode_png(cloth.paint_bottom())


if __name__ == "__main__":
    main()
