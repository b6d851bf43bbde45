"""Toy animals of land and sea; all face along x."""

import math

from toys.shaping import ball, board, egg, flatten_below, lathe, move, pair, ring, rod, small_ball, tube, turn
from toys.solids import PLUSH, THIN_SHELL, block, capsule, cylinder, ellipsoid, sphere

from mimoc.compiler.toys import Looks, Mesh, Solid, ToyModel, assemble


def bunny() -> ToyModel:
    """Return a plush bunny that sits upright."""
    ear = egg((0.05, 0.075, 0.2), segments=8, rows=6)
    inner = egg((0.02, 0.045, 0.15), (0.042, 0, 0), segments=8, rows=4)
    looks: Looks = {
        "main": [
            egg((0.2, 0.22, 0.24), (0, 0, 0.22)),
            egg((0.18, 0.19, 0.17), (0.03, 0, 0.55)),
            *(move(turn(side, "x", -9 * s), (-0.02, 0.1 * s, 0.82)) for side, s in ((ear, 1), (ear, -1))),
            *pair(egg((0.17, 0.085, 0.075), (0.16, 0.14, 0.075), segments=8, rows=6)),
            *pair(rod((0.1, 0.18, 0.36), (0.2, 0.13, 0.26), 0.055, 6)),
        ],
        "light": [
            egg((0.1, 0.14, 0.17), (0.12, 0, 0.24), segments=12, rows=6),
            egg((0.09, 0.09, 0.09), (-0.22, 0, 0.14), segments=8, rows=6),
            *pair(egg((0.05, 0.055, 0.045), (0.19, 0.04, 0.5), segments=8, rows=4)),
            *pair(egg((0.02, 0.05, 0.05), (0.32, 0.14, 0.08), segments=8, rows=4)),
        ],
        "accent": [
            small_ball(0.03, (0.23, 0, 0.54)),
            *(move(turn(inner, "x", -9 * s), (-0.02, 0.1 * s, 0.82)) for s in (1, -1)),
        ],
        "dark": pair(small_ball(0.033, (0.18, 0.09, 0.6))),
    }
    solids = [
        block((0.46, 0.42, 0.08), (0.1, 0, 0.04)),
        sphere(0.21, (0, 0, 0.23)),
        sphere(0.18, (0.03, 0, 0.55)),
        sphere(0.09, (-0.22, 0, 0.14)),
        *(capsule((-0.02, 0.4 * y, 0.7), (-0.02, y, 0.94), 0.055) for y in (-0.12, 0.12)),
    ]
    return assemble("bunny", looks, solids, PLUSH)


def elephant() -> ToyModel:
    """Return an elephant on four legs."""
    trunk = [(0.34, 0, 0.48), (0.43, 0, 0.42), (0.47, 0, 0.32), (0.48, 0, 0.22), (0.52, 0, 0.15), (0.58, 0, 0.14)]
    ear = turn(egg((0.03, 0.17, 0.2), segments=14, rows=4), "z", 28)
    legs = [(x, y) for x in (-0.25, 0.14) for y in (-0.13, 0.13)]
    looks: Looks = {
        "main": [
            egg((0.37, 0.25, 0.25), (-0.06, 0, 0.4)),
            egg((0.19, 0.19, 0.2), (0.26, 0, 0.53)),
            tube(trunk, (0.085, 0.075, 0.065, 0.055, 0.05, 0.045)),
            *(lathe([(0.1, 0.0), (0.095, 0.3)], (x, y, 0), 12) for x, y in legs),
            tube([(-0.4, 0, 0.46), (-0.47, 0, 0.38), (-0.48, 0, 0.28)], 0.022, 6),
        ],
        "accent": pair(move(ear, (0.18, 0.26, 0.56))),
        "light": [
            *pair(tube([(0.36, 0.1, 0.4), (0.46, 0.11, 0.34), (0.52, 0.11, 0.37)], (0.028, 0.025, 0.012), 6)),
            *(egg((0.03, 0.06, 0.03), (x + 0.085, y, 0.03), segments=8, rows=4) for x, y in legs),
        ],
        "dark": [*pair(small_ball(0.03, (0.405, 0.1, 0.58))), small_ball(0.035, (-0.48, 0, 0.26))],
    }
    solids = [
        *(capsule((x, y, 0.095), (x, y, 0.3), 0.095) for x, y in legs),
        capsule((-0.18, 0, 0.4), (0.06, 0, 0.4), 0.245),
        sphere(0.19, (0.26, 0, 0.53)),
        capsule((0.4, 0, 0.44), (0.48, 0, 0.22), 0.06),
        capsule((0.48, 0, 0.2), (0.57, 0, 0.14), 0.05),
        *(ellipsoid((0.05, 0.16, 0.19), (0.18, y, 0.56)) for y in (-0.26, 0.26)),
    ]
    return assemble("elephant", looks, solids, PLUSH)


def pig() -> ToyModel:
    """Return a pig with a curly tail."""
    legs = [(x, y) for x in (-0.24, 0.18) for y in (-0.15, 0.15)]
    curl = [(-0.42 - 0.012 * k, 0.05 * math.sin(k * 1.0), 0.42 + 0.05 * math.cos(k * 1.0)) for k in range(9)]
    ear = turn(egg((0.03, 0.075, 0.1), segments=8, rows=6), "y", 35)
    snout = turn(lathe([(0.11, 0.0), (0.11, 0.08), (0.09, 0.1)], segments=14), "y", 90)
    looks: Looks = {
        "main": [
            egg((0.4, 0.28, 0.27), (-0.04, 0, 0.38)),
            egg((0.2, 0.21, 0.2), (0.28, 0, 0.45)),
            *(lathe([(0.075, 0.0), (0.085, 0.25)], (x, y, 0), 10) for x, y in legs),
        ],
        "accent": [move(snout, (0.42, 0, 0.42)), *pair(move(ear, (0.3, 0.13, 0.64))), tube(curl, 0.02, 6)],
        "dark": [
            *pair(small_ball(0.032, (0.44, 0.1, 0.54))),
            *pair(egg((0.01, 0.02, 0.03), (0.52, 0.04, 0.42), segments=8, rows=4)),
            *(lathe([(0.08, 0.0), (0.082, 0.05)], (x, y, 0), 10) for x, y in legs),
        ],
    }
    solids = [
        *(capsule((x, y, 0.08), (x, y, 0.25), 0.08) for x, y in legs),
        capsule((-0.17, 0, 0.38), (0.1, 0, 0.38), 0.265),
        sphere(0.2, (0.28, 0, 0.45)),
        capsule((0.4, 0, 0.42), (0.42, 0, 0.42), 0.1),
        *(sphere(0.07, (0.3, y, 0.65)) for y in (-0.13, 0.13)),
        sphere(0.06, (-0.46, 0, 0.42)),
    ]
    return assemble("pig", looks, solids, PLUSH)


def chicken() -> ToyModel:
    """Return a hen that sits."""
    beak = turn(lathe([(0.05, 0.0), (0.0, 0.12)], segments=8), "y", 95)
    comb = [ball(r, (x, 0, z), 10, 6) for r, x, z in ((0.06, 0.24, 0.86), (0.07, 0.16, 0.89), (0.055, 0.08, 0.86))]
    tail = [
        move(turn(egg((0.07, 0.04, 0.2), segments=10, rows=6), "y", a), (-0.36, 0, z))
        for a, z in ((-50, 0.47), (-20, 0.55))
    ]
    wing = turn(egg((0.2, 0.05, 0.13), segments=12, rows=6), "y", 20)
    looks: Looks = {
        "main": [
            flatten_below(egg((0.36, 0.28, 0.3), (-0.04, 0, 0.26)), 0.0),
            tube([(0.1, 0, 0.38), (0.17, 0, 0.55), (0.19, 0, 0.7)], (0.22, 0.17, 0.155), 14),
            *tail,
        ],
        "light": pair(move(wing, (-0.07, 0.26, 0.32))),
        "accent": [move(beak, (0.32, 0, 0.71)), *comb, ball(0.05, (0.34, 0, 0.6), 10, 6)],
        "dark": pair(small_ball(0.03, (0.28, 0.115, 0.76))),
    }
    solids = [
        block((0.36, 0.28, 0.06), (-0.03, 0, 0.03)),
        capsule((-0.1, 0, 0.29), (0.04, 0, 0.29), 0.27),
        capsule((0.14, 0, 0.45), (0.19, 0, 0.72), 0.16),
        capsule((-0.3, 0, 0.45), (-0.46, 0, 0.64), 0.06),
        capsule((0.1, 0, 0.87), (0.23, 0, 0.87), 0.06),
        capsule((0.3, 0, 0.71), (0.4, 0, 0.7), 0.04),
    ]
    return assemble("chicken", looks, solids, THIN_SHELL)


def penguin() -> ToyModel:
    """Return a penguin on its feet."""
    body = [(0.16, 0.03), (0.25, 0.1), (0.29, 0.26), (0.27, 0.44), (0.2, 0.6), (0.14, 0.68), (0.0, 0.7)]
    flipper = turn(egg((0.08, 0.035, 0.24), segments=10, rows=6), "x", 28)
    beak = turn(lathe([(0.06, 0.0), (0.035, 0.08), (0.0, 0.13)], segments=10), "y", 90)
    foot = egg((0.15, 0.09, 0.045), (0.14, 0.13, 0.045), segments=10, rows=6)
    looks: Looks = {
        "main": [
            lathe(body, segments=20),
            egg((0.19, 0.2, 0.2), (0.0, 0, 0.79)),
            *pair(move(flipper, (-0.02, 0.33, 0.4))),
            egg((0.12, 0.1, 0.05), (-0.26, 0, 0.09), segments=10, rows=4),
        ],
        "accent": [*pair(foot), move(beak, (0.17, 0, 0.77))],
        "light": [
            egg((0.18, 0.21, 0.27), (0.145, 0, 0.32), segments=20, rows=6),
            *pair(egg((0.06, 0.085, 0.1), (0.135, 0.075, 0.82), segments=10, rows=6)),
        ],
        "dark": pair(small_ball(0.035, (0.18, 0.085, 0.84))),
    }
    solids = [
        block((0.42, 0.38, 0.09), (0.06, 0, 0.045)),
        capsule((0, 0, 0.31), (0, 0, 0.44), 0.28),
        sphere(0.2, (0.0, 0, 0.79)),
        sphere(0.06, (-0.3, 0, 0.09)),
        *(capsule((-0.02, y / 2, 0.6), (-0.02, y, 0.26), 0.06) for y in (-0.4, 0.4)),
    ]
    return assemble("penguin", looks, solids, PLUSH)


def fish() -> ToyModel:
    """Return a bath fish with a flat belly."""
    tail = [(-0.3, 0.32), (-0.4, 0.5), (-0.52, 0.56), (-0.47, 0.33), (-0.52, 0.12), (-0.4, 0.17)]
    fin = [(-0.18, 0.5), (0.16, 0.52), (0.1, 0.66), (-0.06, 0.72), (-0.2, 0.66)]
    side = turn(egg((0.12, 0.025, 0.07), segments=10, rows=4), "z", -25)
    stripes = [egg((0.045, 0.2 * w, 0.3 * w), (x, 0, 0.3), rows=6) for x, w in ((-0.02, 1.0), (-0.17, 0.83))]
    looks: Looks = {
        "main": [
            flatten_below(egg((0.4, 0.19, 0.29), (0.06, 0, 0.3)), 0.05),
            flatten_below(egg((0.2, 0.12, 0.1), (0.06, 0, 0.05)), 0.0),
        ],
        "accent": [
            board(tail, 0.07, bevel=0.1),
            board(fin, 0.06, bevel=0.1),
            *pair(move(side, (0.08, 0.22, 0.22))),
            move(turn(ring(0.05, 0.025, segments=12, corners=6), "y", 90), (0.455, 0, 0.27)),
        ],
        "light": [
            *[flatten_below(stripe, 0.05) for stripe in stripes],
            *pair(egg((0.07, 0.04, 0.07), (0.29, 0.13, 0.38), segments=10, rows=6)),
        ],
        "dark": pair(egg((0.035, 0.02, 0.035), (0.305, 0.16, 0.385), segments=8, rows=6)),
    }
    solids = [
        block((0.34, 0.2, 0.06), (0.06, 0, 0.03)),
        ellipsoid((0.4, 0.19, 0.27), (0.06, 0, 0.31)),
        block((0.16, 0.06, 0.38), (-0.43, 0, 0.34)),
        block((0.3, 0.06, 0.16), (0.0, 0, 0.62)),
        *(capsule((0.12, 0.16 * s, 0.22), (0.02, 0.25 * s, 0.22), 0.04) for s in (-1, 1)),
    ]
    return assemble("fish", looks, solids, THIN_SHELL)


def whale() -> ToyModel:
    """Return a spouting bath whale with a flat belly."""
    body = tube(
        [(0.18, 0, 0.25), (0.0, 0, 0.25), (-0.18, 0, 0.24), (-0.32, 0, 0.26), (-0.44, 0, 0.38)],
        (0.27, 0.27, 0.2, 0.11, 0.06),
        18,
    )
    fluke = turn(egg((0.09, 0.17, 0.035), segments=12, rows=4), "z", 35)
    spout = [
        tube(
            [(0.12, 0, 0.5), (0.12, 0, 0.58), (0.12 + x / 3, 0, 0.67), (0.12 + x, 0, 0.65), (0.12 + 1.4 * x, 0, 0.57)],
            0.026,
            8,
        )
        for x in (-0.12, 0.12)
    ]
    flipper = turn(egg((0.08, 0.16, 0.025), segments=10, rows=4), "z", 30)
    looks: Looks = {
        "main": [
            flatten_below(body, 0.0),
            *pair(move(fluke, (-0.5, 0.13, 0.42))),
            *pair(move(turn(flipper, "x", -20), (0.1, 0.31, 0.12))),
        ],
        "light": [
            flatten_below(egg((0.27, 0.262, 0.28), (0.19, 0, 0.17)), 0.0),
            *pair(egg((0.05, 0.04, 0.055), (0.27, 0.235, 0.33), segments=10, rows=6)),
        ],
        "accent": spout,
        "dark": pair(egg((0.03, 0.03, 0.035), (0.285, 0.255, 0.335), segments=8, rows=6)),
    }
    solids = [
        block((0.44, 0.36, 0.06), (0.09, 0, 0.03)),
        capsule((0.0, 0, 0.27), (0.18, 0, 0.27), 0.26),
        capsule((-0.2, 0, 0.25), (-0.4, 0, 0.34), 0.12),
        block((0.16, 0.5, 0.06), (-0.49, 0, 0.42)),
        *(capsule((0.1, 0.25 * s, 0.14), (0.06, 0.42 * s, 0.08), 0.04) for s in (-1, 1)),
        capsule((0.12, 0, 0.5), (0.12, 0, 0.66), 0.05),
    ]
    return assemble("whale", looks, solids, THIN_SHELL)


def octopus() -> ToyModel:
    """Return an octopus on its eight arms."""
    looks: Looks = {
        "main": [
            egg((0.25, 0.25, 0.28), (0, 0, 0.46)),
            *(_arm(math.tau * (k + 0.5) / 8) for k in range(8)),
        ],
        "light": pair(egg((0.06, 0.085, 0.1), (0.2, 0.1, 0.5), segments=10, rows=6)),
        "accent": [
            move(turn(ring(0.045, 0.022, segments=12, corners=6), "y", 90), (0.245, 0, 0.35)),
            *(
                egg((0.045, 0.045, 0.02), (x, y, z), segments=6, rows=4)
                for x, y, z in ((0, 0, 0.735), (0.08, 0.12, 0.69), (-0.02, -0.15, 0.68))
            ),
        ],
        "dark": pair(small_ball(0.045, (0.245, 0.1, 0.49))),
    }
    solids = [
        cylinder((0, 0, 0.02), (0, 0, 0.26), 0.2),
        sphere(0.25, (0, 0, 0.47)),
        *(_hold(math.tau * (k + 0.5) / 8, 0.06 + 0.01 * (k % 2)) for k in range(8)),
    ]
    return assemble("octopus", looks, solids, THIN_SHELL)


def _arm(angle: float) -> Mesh:
    """Return the mesh of an arm of an octopus, whose end curls up."""
    line = [(0.12, 0.24), (0.24, 0.12), (0.34, 0.065), (0.44, 0.07), (0.5, 0.13)]
    path = [(out * math.cos(angle), out * math.sin(angle), height) for out, height in line]
    return tube(path, (0.085, 0.08, 0.065, 0.05, 0.035), 6)


def _hold(angle: float, height: float) -> Solid:
    """Return the collision shape of an arm of an octopus."""
    x, y = math.cos(angle), math.sin(angle)
    return capsule((0.15 * x, 0.15 * y, 0.17), (0.42 * x, 0.42 * y, height), 0.06)
