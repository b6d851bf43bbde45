"""Recordings of points that are changed by chance, in bytes, numbers, names and folders."""

import json
import warnings
from pathlib import Path
from shutil import copy, copytree
from types import MappingProxyType

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, pick
from fuzz.recordings import plant
from support import filmed

import mimoc
from mimoc.base.errors import BundleError
from mimoc.bundle.io import pack_arrays, unpack_arrays
from mimoc.motion.body_points import film
from mimoc.motion.point_recording import UPS, VIEWS
from mimoc.schema.kinds import FORMATS

FRAMES = 12
OPTIONS = MappingProxyType(
    {
        "format": (None, None, None, *FORMATS),
        "rate_hz": (30, 30, None, 0.0, -1, 1e300, float("nan")),
        "infant": (None, None, 0, 1, "1", -1, "x" * 99, "\n"),
        "names": (None, None, {"head": "nose"}, {"\0": "head"}),
        "view": VIEWS,
        "picture_px": (None, (1, 1), (10**6, 3)),
        "up": UPS,
        "min_score": (None, None, 0, 0.5, 1, -1, float("nan")),
    }
)
CELLS = "", "nan", "inf", "-1e308", "1e999", "x", '"', ",", ";", "\n", "0x10", "1,2", "9" * 400, "neck_x"


def prepare(folder: Path) -> list[Path]:
    seen, space = filmed.filmed(FRAMES, filmed.BODY_25_POINTS), filmed.in_space(FRAMES)
    around = filmed.in_space(FRAMES, filmed.BODY_25_POINTS)
    deep = film(filmed.kicking_model(), filmed.kicking(FRAMES), 30)
    return [
        filmed.write_openpose(seen, folder / "openpose", (seen,)),
        filmed.write_coco(seen, folder / "coco"),
        filmed.write_coco(seen, folder / "coco.json"),
        filmed.write_mini_rgbd(deep, folder / "flat"),
        filmed.write_mini_rgbd(space, folder / "space"),
        mimoc.write_points(seen, folder / "wide.csv"),
        filmed.write_pairs(filmed.filmed(FRAMES), folder / "pairs.csv"),
        mimoc.write_points(deep, folder / "points.npz"),
        filmed.write_c3d(space, folder / "markers.c3d"),
        filmed.write_mediapipe(seen, folder / "shares.csv"),
        filmed.write_mediapipe(seen, folder / "shares.json"),
        filmed.write_mediapipe(around, folder / "world.csv"),
        filmed.write_mediapipe(around, folder / "world.json"),
        filmed.write_deeplabcut({"0": seen}, folder / "individuals.csv"),
        filmed.write_categories({"adult": seen, "infant": seen}, folder / "categories.json"),
        filmed.write_mmpose(seen, folder / "named.json"),
        filmed.write_times(seen, np.cumsum([0.0, *[33, 17, 33] * 4][:FRAMES]), folder / "uneven.csv", "time_ms"),
    ]


def attempt(prepared: list[Path], generator: np.random.Generator, folder: Path) -> None:
    honest = pick(generator, prepared)
    place = folder / honest.name
    copytree(honest, place) if honest.is_dir() else copy(honest, place)
    for _ in range(1 if generator.random() < 0.7 else 2):
        change(generator, place, folder.parent / "outside")
    options = {name: pick(generator, values) for name, values in OPTIONS.items() if generator.random() < 0.1}
    read = mimoc.read_points(place, **{"rate_hz": 30, "picture_px": (640, 480), **options})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        read.filled()
    mimoc.write_points(read, folder / "again.npz")
    mimoc.write_points(read, folder / "again.csv")
    mimoc.read_points(folder / "again.npz", view="back" if read.unit == "px" else "front", up="z")


def change(generator: np.random.Generator, place: Path, outside: Path) -> None:
    """Change the content of a file, or put something else in its place."""
    among = [place, *sorted(place.rglob("*"))] if place.is_dir() and not place.is_symlink() else [place]
    files = [path for path in among if path.is_file() and not path.is_symlink()]
    if not files:  # Something else was put in its place.
        return
    path, kind = pick(generator, files), generator.random()
    if kind < 0.1 and path != place:  # What a user names may be a link.
        plant(generator, path, outside)
    elif kind < 0.15 and place.is_dir():
        copy(
            path, path.with_name(pick(generator, (f"9{path.name}", f"99999999{path.name}", f"x{path.name}", "a.json")))
        )
    elif path.suffix == ".json" and kind < 0.8:
        change_json(generator, path)
    elif path.suffix == ".npz" and kind < 0.8:
        change_arrays(generator, path)
    elif path.suffix in (".csv", ".txt") and kind < 0.8:
        change_cells(generator, path)
    else:
        path.write_bytes(changed_bytes(generator, path.read_bytes()))


def change_json(generator: np.random.Generator, path: Path) -> None:
    try:
        data = json.loads(path.read_bytes())
        path.write_text(json.dumps(changed_data(generator, data)), encoding="utf-8", errors="surrogateescape")
    except (ValueError, RecursionError, UnicodeEncodeError):  # It was changed before.
        path.write_bytes(changed_bytes(generator, path.read_bytes()))


def change_arrays(generator: np.random.Generator, path: Path) -> None:
    """Change what is said of arrays, or one in its shape, type or numbers."""
    try:
        arrays = dict(unpack_arrays(path.read_bytes()))
        about = json.loads(arrays["about"].tobytes())
    except (BundleError, KeyError, ValueError):  # It was changed before.
        return
    name = pick(generator, sorted(arrays))
    array, kind = arrays[name], int(generator.integers(5))
    if kind == 0 or name == "about":
        text = json.dumps(changed_data(generator, about)).encode(errors="replace")
        arrays["about"] = np.frombuffer(text, np.uint8)
    elif kind == 1:
        with np.errstate(invalid="ignore", over="ignore"):
            arrays[name] = array.astype(pick(generator, ("f4", "i8", "?", "u1")))
    elif kind == 2 and array.size:
        arrays[name] = array.astype(np.float64)
        arrays[name].flat[int(generator.integers(array.size))] = pick(generator, (np.nan, np.inf, -1e308, 1e9, 0))
    elif kind == 3:
        arrays[name] = pick(generator, (array[:0], array[:1], array[..., :1], array[0], array.T, array[:, :0]))
    else:
        del arrays[name]
    path.write_bytes(pack_arrays(arrays))


def change_cells(generator: np.random.Generator, path: Path) -> None:
    """Put strange cells in place of some, in a row or a column, or cut a row."""
    separator = " " if path.suffix == ".txt" else pick(generator, (",", ";"))
    rows = [row.split(separator) for row in path.read_text(encoding="utf-8", errors="replace").split("\n")]
    row, cell = pick(generator, rows), pick(generator, CELLS)
    column = int(generator.integers(len(row)))
    for other in rows if generator.random() < 0.3 else [row]:
        other[column : column + int(generator.integers(1, 3))] = [cell]
    path.write_text("\n".join(separator.join(row) for row in rows), encoding="utf-8", errors="replace")


FUZZER = Fuzzer(prepare, attempt, short=60)
