"""Toy vehicles, boats and planes; all face along x."""

from toys.shaping import board, box, egg, frustum, lathe, loft, move, pair, plate, rod, small_ball, turn
from toys.solids import SHELL, WOOD, block, capsule, sphere

from mimoc.base.geometry.rotations import Vec3
from mimoc.compiler.toys import Looks, Mesh, Solid, ToyModel, assemble


def wheels(
    x: tuple[float, ...], out: float, radius: float, width: float, segments: int = 16
) -> tuple[list[Mesh], list[Mesh]]:
    """Return tyres and hubs of pairs of wheels, with centres at the positions *x* and at y = ±*out*."""
    half = width / 2
    tread = [(0.88 * radius, -half), (radius, -0.6 * half), (radius, 0.6 * half), (0.88 * radius, half)]
    tyre = turn(lathe(tread, segments=segments), "x", -90)
    hub = turn(
        lathe([(0.0, 0.5 * half), (0.55 * radius, 0.9 * half), (0.45 * radius, 1.15 * half)], segments=12), "x", -90
    )
    tyres = [side for each in x for side in pair(move(tyre, (each, out, radius)))]
    return tyres, [side for each in x for side in pair(move(hub, (each, out, radius)))]


def axles(x: tuple[float, ...], out: float, radius: float, width: float) -> list[Solid]:
    """Return a capsule for each pair of wheels, so that each pair touches the floor at two points."""
    end = max(out + 0.7 * width - radius, 0.02)
    return [capsule((each, -end, radius), (each, end, radius), radius) for each in x]


def car() -> ToyModel:
    """Return a small car with four windows."""
    tyres, hubs = wheels((-0.28, 0.28), 0.21, 0.125, 0.09)
    looks: Looks = {
        "main": [
            box((1.0, 0.44, 0.19), (0, 0, 0.2), bevel=0.06),
            box((0.4, 0.34, 0.05), (-0.06, 0, 0.475), bevel=0.02),
            *(frustum((0.07, 0.43), (0.04, 0.36), 0.19, (x, 0, 0.28), lean) for x, lean in ((-0.05, 0), (-0.3, 0.06))),
        ],
        "accent": [box((0.05, 0.4, 0.05), (x, 0, 0.15), bevel=0.015) for x in (-0.49, 0.49)],
        "dark": [*tyres, frustum((0.62, 0.41), (0.38, 0.33), 0.18, (-0.06, 0, 0.28))],
        "light": [*hubs, *pair(egg((0.02, 0.05, 0.04), (0.49, 0.14, 0.22), segments=8, rows=4))],
    }
    solids = [
        *axles((-0.28, 0.28), 0.21, 0.125, 0.09),
        block((1.0, 0.42, 0.19), (0, 0, 0.2)),
        block((0.44, 0.36, 0.22), (-0.06, 0, 0.39)),
    ]
    return assemble("car", looks, solids, SHELL)


def truck() -> ToyModel:
    """Return a tipper that objects can be put into."""
    tyres, hubs = wheels((-0.3, 0.3), 0.2, 0.13, 0.1)
    floor, sides = (0.66, 0.46, 0.04), _tray(0.66, 0.46, 0.27, 0.2, -0.17)
    looks: Looks = {
        "main": [
            box((0.28, 0.44, 0.38), (0.35, 0, 0.37), bevel=0.03),
            box((0.1, 0.4, 0.14), (0.46, 0, 0.25), bevel=0.03),
        ],
        "accent": [box(floor, (-0.17, 0, 0.26)), *(box(size, at) for size, at in sides)],
        "dark": [
            *tyres,
            box((0.94, 0.24, 0.1), (-0.02, 0, 0.17)),
            box((0.02, 0.34, 0.14), (0.49, 0, 0.46)),
            *pair(box((0.14, 0.02, 0.13), (0.37, 0.22, 0.465))),
        ],
        "light": [*hubs, *pair(small_ball(0.035, (0.505, 0.13, 0.26))), box((0.03, 0.42, 0.06), (0.5, 0, 0.16), 0.01)],
    }
    solids = [
        *axles((-0.3, 0.3), 0.2, 0.13, 0.1),
        block((0.3, 0.44, 0.42), (0.36, 0, 0.35)),
        block(floor, (-0.17, 0, 0.26)),
        *(block(size, at) for size, at in sides),
    ]
    return assemble("truck", looks, solids, SHELL)


def bus() -> ToyModel:
    """Return a bus with a row of windows."""
    tyres, hubs = wheels((-0.29, 0.29), 0.16, 0.1, 0.08)
    looks: Looks = {
        "main": [box((1.0, 0.36, 0.4), (0, 0, 0.29), bevel=0.04)],
        "accent": [box((1.01, 0.37, 0.04), (0, 0, 0.24)), box((0.5, 0.2, 0.03), (0, 0, 0.49), bevel=0.01)],
        "dark": [
            *tyres,
            *(box((0.14, 0.37, 0.13), (x, 0, 0.37)) for x in (-0.37, -0.19, -0.01, 0.17)),
            box((0.12, 0.37, 0.26), (0.36, 0, 0.31)),
            box((0.02, 0.29, 0.15), (0.495, 0, 0.36)),
        ],
        "light": [*hubs, *pair(egg((0.015, 0.04, 0.03), (0.5, 0.12, 0.17), segments=8, rows=4))],
    }
    solids = [*axles((-0.29, 0.29), 0.16, 0.1, 0.08), block((1.0, 0.36, 0.4), (0, 0, 0.29))]
    return assemble("bus", looks, solids, SHELL)


def train() -> ToyModel:
    """Return a steam engine."""
    tyres, hubs = wheels((-0.3, -0.03, 0.24), 0.17, 0.11, 0.07, segments=12)
    boiler = _lying([(0.16, -0.16), (0.16, 0.37)], (0, 0, 0.37))
    hoops = [_lying([(0.168, x), (0.168, x + 0.03)], (0, 0, 0.37)) for x in (0.0, 0.2)]
    funnel = lathe([(0.05, 0.5), (0.05, 0.6), (0.085, 0.72), (0.085, 0.75)], (0.25, 0, 0), segments=12)
    looks: Looks = {
        "main": [boiler, box((0.3, 0.38, 0.44), (-0.29, 0, 0.4)), box((0.1, 0.3, 0.06), (0.43, 0, 0.16))],
        "accent": [
            box((0.86, 0.34, 0.08), (-0.02, 0, 0.18)),
            box((0.38, 0.44, 0.05), (-0.29, 0, 0.64), bevel=0.02),
            egg((0.07, 0.07, 0.08), (0.05, 0, 0.53), segments=10, rows=4),
            *hoops,
        ],
        "dark": [
            *tyres,
            funnel,
            _lying([(0.14, 0.36), (0.14, 0.39)], (0, 0, 0.37)),
            *pair(box((0.16, 0.02, 0.16), (-0.29, 0.185, 0.5))),
            frustum((0.06, 0.34), (0.16, 0.3), 0.14, (0.45, 0, 0.03), lean=-0.04),
        ],
        "light": [*hubs, small_ball(0.045, (0.39, 0, 0.37))],
    }
    solids = [
        *axles((-0.3, 0.24), 0.17, 0.11, 0.07),
        block((0.86, 0.34, 0.1), (0.03, 0, 0.17)),
        capsule((0.0, 0, 0.37), (0.22, 0, 0.37), 0.165),
        block((0.34, 0.4, 0.46), (-0.29, 0, 0.43)),
        capsule((0.25, 0, 0.5), (0.25, 0, 0.68), 0.07),
    ]
    return assemble("train", looks, solids, WOOD)


def tractor() -> ToyModel:
    """Return a tractor, whose rear wheels are the larger ones."""
    big_tyres, big_hubs = wheels((-0.22,), 0.24, 0.25, 0.14)
    tyres, hubs = wheels((0.33,), 0.2, 0.14, 0.1)
    posts = [rod((x, 0.13, 0.4), (x, 0.13, 0.76), 0.02, 6) for x in (-0.32, 0.0)]
    looks: Looks = {
        "main": [
            box((0.54, 0.24, 0.24), (0.21, 0, 0.34), bevel=0.04),
            box((0.44, 0.3, 0.12), (-0.2, 0, 0.36), bevel=0.03),
            box((0.46, 0.36, 0.05), (-0.16, 0, 0.79), bevel=0.02),
            *(post for each in posts for post in pair(each)),
        ],
        "accent": [*big_hubs, *hubs, box((0.14, 0.2, 0.16), (-0.25, 0, 0.46), bevel=0.03)],
        "dark": [
            *big_tyres,
            *tyres,
            rod((0.3, 0, 0.44), (0.3, 0, 0.64), 0.025, 8),
            box((0.02, 0.17, 0.15), (0.48, 0, 0.34)),
            move(turn(lathe([(0.075, 0.0), (0.075, 0.02)], segments=12), "y", -60), (0.0, 0, 0.54)),
        ],
        "light": pair(small_ball(0.03, (0.48, 0.1, 0.42))),
    }
    solids = [
        *axles((-0.22,), 0.24, 0.25, 0.14),
        *axles((0.33,), 0.2, 0.14, 0.1),
        block((0.56, 0.24, 0.24), (0.2, 0, 0.34)),
        block((0.44, 0.34, 0.06), (-0.16, 0, 0.79)),
        capsule((-0.3, 0, 0.4), (-0.3, 0, 0.76), 0.05),
    ]
    return assemble("tractor", looks, solids, SHELL)


def boat() -> ToyModel:
    """Return a steamer with a flat keel."""
    deck = [(-0.5, -0.16), (-0.42, -0.2), (0.1, -0.2), (0.34, -0.12), (0.5, 0.0)]
    outline = [*deck, *((x, -y) for x, y in deck[-2::-1])]
    keel = [(0.82 * x - 0.03, 0.72 * y) for x, y in outline]
    sides = [[(x, y, z) for x, y in line] for line, z in ((keel, 0.0), (outline, 0.19), (outline, 0.25))]
    looks: Looks = {
        "main": [loft(sides)],
        "accent": [
            plate([(1.03 * x, 1.06 * y) for x, y in outline], 0.19, 0.22),
            box((0.28, 0.26, 0.04), (-0.09, 0, 0.55), bevel=0.015),
            lathe([(0.075, 0.57), (0.068, 0.65)], (-0.12, 0, 0)),
        ],
        "dark": [
            lathe([(0.07, 0.65), (0.065, 0.72)], (-0.12, 0, 0)),
            *pair(egg((0.045, 0.02, 0.045), (-0.15, 0.115, 0.47), segments=10, rows=4)),
            *pair(egg((0.045, 0.02, 0.045), (-0.03, 0.115, 0.47), segments=10, rows=4)),
        ],
        "light": [
            box((0.46, 0.28, 0.14), (-0.12, 0, 0.31), bevel=0.02),
            box((0.26, 0.22, 0.2), (-0.09, 0, 0.45), bevel=0.02),
        ],
    }
    solids = [
        block((0.66, 0.34, 0.25), (-0.14, 0, 0.125)),
        capsule((0.1, 0, 0.16), (0.4, 0, 0.16), 0.09),
        block((0.42, 0.28, 0.2), (-0.12, 0, 0.3)),
        block((0.26, 0.24, 0.24), (-0.09, 0, 0.45)),
        capsule((-0.12, 0, 0.5), (-0.12, 0, 0.65), 0.07),
    ]
    return assemble("boat", looks, solids, SHELL)


def airplane() -> ToyModel:
    """Return a propeller plane that stands on three wheels."""
    hull = [(0.0, -0.46), (0.04, -0.45), (0.09, -0.1), (0.115, 0.1), (0.115, 0.3), (0.09, 0.39), (0.05, 0.42)]
    wing = [(0.2, 0.0), (0.17, 0.44), (0.11, 0.5), (0.02, 0.5), (-0.04, 0.44), (-0.06, 0.0)]
    span = [*wing, *((x, -y) for x, y in wing[-2:0:-1])]
    tail = [(0.4 * x - 0.42, 0.4 * y) for x, y in span]
    fin = [(-0.47, 0.26), (-0.28, 0.28), (-0.4, 0.5), (-0.47, 0.5)]
    tyres, _ = wheels((0.2,), 0.13, 0.06, 0.05)
    looks: Looks = {
        "main": [_lying(hull, (0, 0, 0.24)), board(fin, 0.035, bevel=0.1)],
        "accent": [
            plate(span, 0.2, 0.24, bevel=0.03),
            plate(tail, 0.26, 0.29, bevel=0.03),
            _lying([(0.05, 0.41), (0.04, 0.46), (0.0, 0.5)], (0, 0, 0.24), 12),
        ],
        "dark": [
            *tyres,
            *(board([(0.18, 0.03), (0.22, 0.03), (0.21, 0.22), (0.19, 0.22)], 0.03, (0, y, 0)) for y in (-0.1, 0.1)),
            small_ball(0.04, (-0.36, 0, 0.04)),
            rod((-0.36, 0, 0.05), (-0.36, 0, 0.22), 0.015, 6),
            egg((0.11, 0.075, 0.07), (0.09, 0, 0.335), segments=12, rows=6),
        ],
        "light": [move(turn(egg((0.015, 0.17, 0.035), segments=12, rows=4), "x", 25), (0.44, 0, 0.24))],
    }
    solids = [
        capsule((-0.3, 0, 0.26), (0.33, 0, 0.25), 0.1),
        block((0.2, 1.0, 0.04), (0.07, 0, 0.22)),
        block((0.09, 0.4, 0.03), (-0.4, 0, 0.275)),
        block((0.1, 0.03, 0.22), (-0.42, 0, 0.39)),
        sphere(0.06, (0.2, 0.13, 0.06)),
        sphere(0.06, (0.2, -0.13, 0.06)),
        sphere(0.04, (-0.36, 0, 0.04)),
        capsule((0.4, 0, 0.24), (0.45, 0, 0.24), 0.04),
    ]
    return assemble("airplane", looks, solids, WOOD)


def _tray(length: float, width: float, low: float, height: float, x: float) -> list[tuple[Vec3, Vec3]]:
    """Return size and centre of the four sides of a tray."""
    z, thin = low + height / 2, 0.04
    ends = [((thin, width, height), (x + side * (length - thin) / 2, 0.0, z)) for side in (-1, 1)]
    return [*ends, *(((length, thin, height), (x, side * (width - thin) / 2, z)) for side in (-1, 1))]


def _lying(profile: list[tuple[float, float]], at: Vec3, segments: int = 16) -> Mesh:
    """Return a surface of revolution about the x axis; see `lathe`."""
    return move(turn(lathe(profile, segments=segments), "y", 90), at)
