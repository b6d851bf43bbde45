"""Balls, a drum, a hammer and other playthings."""

import math

from toys.shaping import ball as globe, box, lathe, loft, move, pair, ring, rod, small_ball, turn
from toys.solids import POLYPROPYLENE, SHELL, TENNIS_BALL, WOOD, block, capsule, cylinder, hoop, sphere

from mimoc.compiler.toys import Looks, Mesh, ToyModel, assemble

MANY = 24  # Corners of circles that are seen from close up.


def ball() -> ToyModel:
    """Return a ball of six panels."""
    panels = [_panel(math.tau * k / 6) for k in range(6)]
    looks: Looks = {
        "main": panels[0::3],
        "light": panels[1::3],
        "accent": panels[2::3],
    }
    return assemble("ball", looks, [sphere(0.5)], TENNIS_BALL)


def drum() -> ToyModel:
    """Return a drum with two sticks upon it."""
    hooks = [
        (0.465 * math.cos(a), 0.465 * math.sin(a), z)
        for a, z in ((math.tau * k / 12, (0.1, 0.5)[k % 2]) for k in range(12))
    ]
    cords = [rod(a, b, 0.014, 4) for a, b in zip(hooks, hooks[1:] + hooks[:1], strict=True)]
    sticks = [((-0.3, -0.12, 0.65), (0.36, 0.14, 0.65)), ((-0.3, 0.16, 0.65), (0.38, -0.1, 0.65))]
    looks: Looks = {
        "main": [lathe([(0.45, 0.02), (0.45, 0.58)], segments=MANY)],
        "accent": [
            lathe([(0.44, z), (0.485, z), (0.485, z + 0.08), (0.44, z + 0.08)], segments=MANY, closed=True)
            for z in (0.0, 0.53)
        ],
        "light": [*cords, lathe([(0.44, 0.6), (0.435, 0.62)], segments=MANY)],
        "dark": [mesh for a, b in sticks for mesh in (rod(a, b, 0.022, 6), small_ball(0.045, b))],
    }
    solids = [cylinder((0, 0, 0), (0, 0, 0.615), 0.48), *(capsule(a, b, 0.024) for a, b in sticks)]
    return assemble("drum", looks, solids, SHELL)


def hammer() -> ToyModel:
    """Return a mallet that lies on its head and on the end of its handle."""
    head, grip, length = 0.14, 0.04, 0.78
    lean = math.asin((head - grip) / length)
    end = (-length * math.cos(lean), 0.0, grip)
    near, far = (end[0] * 0.62, 0.0, head + (grip - head) * 0.62), (end[0] * 0.98, 0.0, head + (grip - head) * 0.98)
    bands = [
        lathe([(0.13, z - 0.07), (0.14, z - 0.05), (0.14, z + 0.05), (0.13, z + 0.07)], segments=20)
        for z in (-0.16, 0.16)
    ]
    looks: Looks = {
        "main": [_sideways(band, head) for band in bands],
        "accent": [_sideways(lathe([(0.11, -0.12), (0.11, 0.12)], segments=20), head), rod(near, far, grip, 12)],
        "light": [rod((0.0, 0.0, head), end, 0.032, 12)],
    }
    solids = [cylinder((0, -0.23, head), (0, 0.23, head), head), capsule((-0.1, 0, head - 0.0128), end, grip)]
    return assemble("hammer", looks, solids, WOOD)


def key() -> ToyModel:
    """Return a key for teething, flat on the floor."""
    teeth = [box((0.07, 0.14, 0.08), (0.33, -0.1, 0.06), 0.015), box((0.07, 0.1, 0.08), (0.2, -0.08, 0.06), 0.015)]
    looks: Looks = {
        "main": [ring(0.17, 0.06, (-0.27, 0, 0.06))],
        "accent": [rod((-0.1, 0, 0.06), (0.4, 0, 0.06), 0.055), *teeth, ring(0.05, 0.035, (-0.07, 0, 0.06), 14, 8)],
    }
    solids = [
        *hoop(0.17, 0.055, (-0.27, 0, 0.065), sides=6, low=(3,)),
        capsule((-0.1, 0, 0.065), (0.4, 0, 0.065), 0.055),
        capsule((0.33, -0.13, 0.055), (0.33, 0.0, 0.055), 0.055),
        capsule((0.2, -0.08, 0.06), (0.2, 0.0, 0.06), 0.045),
    ]
    return assemble("key", looks, solids, POLYPROPYLENE)


def chess_piece() -> ToyModel:
    """Return a pawn."""
    foot = [(0.28, 0.0), (0.3, 0.02), (0.3, 0.08), (0.26, 0.12), (0.24, 0.18), (0.16, 0.26), (0.11, 0.42), (0.09, 0.6)]
    collar = [(0.17, 0.63), (0.18, 0.65), (0.17, 0.67), (0.08, 0.69)]
    looks: Looks = {
        "main": [lathe([*foot, *collar], segments=MANY), globe(0.175, (0, 0, 0.825), segments=20, rows=10)],
        "accent": [lathe([(0.3, 0.03), (0.315, 0.04), (0.315, 0.07), (0.3, 0.08)], segments=MANY)],
        "dark": [lathe([(0.27, 0.0), (0.29, 0.005), (0.29, 0.02)], segments=MANY)],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.14), 0.3),
        capsule((0, 0, 0.2), (0, 0, 0.6), 0.13),
        sphere(0.175, (0, 0, 0.825)),
    ]
    return assemble("chess_piece", looks, solids, WOOD)


def robot() -> ToyModel:
    """Return a robot with an antenna."""
    dial = turn(lathe([(0.055, 0.0), (0.045, 0.03)], segments=12), "y", 90)
    eye = turn(lathe([(0.06, 0.0), (0.06, 0.03)], segments=12), "y", 90)
    looks: Looks = {
        "main": [box((0.26, 0.4, 0.36), (0, 0, 0.38), bevel=0.03), box((0.24, 0.32, 0.24), (0, 0, 0.72), bevel=0.03)],
        "accent": [
            *pair(box((0.26, 0.15, 0.09), (0.02, 0.12, 0.045), bevel=0.025)),
            *pair(small_ball(0.06, (0, 0.27, 0.32))),
            *pair(small_ball(0.045, (0, 0.17, 0.73))),
            small_ball(0.045, (0, 0, 0.96)),
            move(dial, (0.125, 0.09, 0.45)),
        ],
        "light": [
            *pair(move(eye, (0.11, 0.075, 0.76))),
            box((0.02, 0.3, 0.24), (0.13, 0, 0.38)),
            box((0.02, 0.16, 0.04), (0.12, 0, 0.65)),
        ],
        "dark": [
            *pair(rod((0, 0.1, 0.08), (0, 0.1, 0.22), 0.045, 8)),
            *pair(rod((0, 0.23, 0.5), (0, 0.27, 0.34), 0.035, 8)),
            rod((0, 0, 0.54), (0, 0, 0.62), 0.07, 8),
            rod((0, 0, 0.82), (0, 0, 0.94), 0.014, 6),
            *pair(small_ball(0.028, (0.14, 0.075, 0.76))),
            *(box((0.03, 0.05, 0.05), (0.135, y, 0.32)) for y in (-0.09, 0.0, 0.09)),
            box((0.03, 0.14, 0.05), (0.135, -0.05, 0.45)),
        ],
    }
    solids = [
        block((0.26, 0.38, 0.09), (0.02, 0, 0.045)),
        block((0.26, 0.4, 0.48), (0, 0, 0.32)),
        block((0.24, 0.34, 0.26), (0, 0, 0.72)),
        *(capsule((0, 0.22 * s, 0.5), (0, 0.27 * s, 0.32), 0.055) for s in (-1, 1)),
        capsule((0, 0, 0.85), (0, 0, 0.96), 0.04),
    ]
    return assemble("robot", looks, solids, SHELL)


def _panel(start: float) -> Mesh:
    """Return a sixth of a ball, down to its axis."""
    columns, rows = 5, 12
    arcs = [start + math.tau / 6 * k / (columns - 1) for k in range(columns)]
    rings = []
    for row in range(1, rows):
        up = math.pi * (row / rows - 0.5)
        z = 0.5 * math.sin(up)
        out = 0.5 * math.cos(up)
        rings.append([*((out * math.cos(a), out * math.sin(a), z) for a in arcs), (0.0, 0.0, z)])
    return loft([[(0.0, 0.0, -0.5)], *rings, [(0.0, 0.0, 0.5)]])


def _sideways(mesh: Mesh, height: float) -> Mesh:
    """Return a surface of revolution about the y axis."""
    return move(turn(mesh, "x", 90), (0.0, 0.0, height))
