"""Toy fruit, mushrooms, baked goods, ice cream and a hamburger."""

import math

import numpy as np
from toys.shaping import ball, box, egg, lathe, loft, move, plate, ring, rod, tube, turn
from toys.solids import THIN_SHELL, WOOD, capsule, cylinder, ellipsoid, hoop, sphere

from mimoc.compiler.toys import Looks, Mesh, ToyModel, assemble

MANY = 24  # Corners of circles that are seen from close up.


def apple() -> ToyModel:
    """Return an apple with a stem and a leaf; its collision shape is round, and stable as it is wider than high."""
    skin = [(0.0, 0.06), (0.1, 0.03), (0.18, 0.0), (0.28, 0.05), (0.4, 0.2), (0.48, 0.4), (0.49, 0.55), (0.43, 0.72)]
    top = [(0.3, 0.82), (0.18, 0.84), (0.08, 0.79), (0.0, 0.72)]
    looks: Looks = {
        "main": [lathe([*skin, *top], segments=MANY)],
        "dark": [tube([(0, 0, 0.72), (0.01, 0, 0.86), (0.05, 0, 0.98)], (0.022, 0.022, 0.03), 8)],
        "accent": [move(turn(egg((0.16, 0.08, 0.02), segments=12, rows=4), "y", -25), (-0.13, 0, 0.93))],
    }
    solids = [ellipsoid((0.48, 0.48, 0.42), (0, 0, 0.42)), capsule((0, 0, 0.8), (0.04, 0, 0.95), 0.03)]
    return assemble("apple", looks, solids, THIN_SHELL)


def pear() -> ToyModel:
    """Return a pear."""
    skin = [
        (0.0, 0.03),
        (0.12, 0.0),
        (0.22, 0.02),
        (0.32, 0.12),
        (0.36, 0.27),
        (0.33, 0.42),
        (0.25, 0.56),
        (0.19, 0.68),
    ]
    top = [(0.165, 0.78), (0.13, 0.86), (0.06, 0.9), (0.0, 0.89)]
    looks: Looks = {
        "main": [lathe([*skin, *top], segments=MANY)],
        "dark": [tube([(0, 0, 0.88), (0.01, 0, 0.94), (0.04, 0, 1.0)], (0.02, 0.018, 0.024), 8)],
        "accent": [move(turn(egg((0.13, 0.06, 0.015), segments=12, rows=4), "y", -15), (-0.12, 0, 0.93))],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.1), 0.2),
        sphere(0.345, (0, 0, 0.36)),
        capsule((0, 0, 0.5), (0, 0, 0.73), 0.17),
        capsule((0, 0, 0.88), (0.03, 0, 0.97), 0.025),
    ]
    return assemble("pear", looks, solids, THIN_SHELL)


def banana() -> ToyModel:
    """Return a banana that lies on its side."""
    angles = np.radians(np.linspace(-66, 66, 11))
    thickness = 0.13 * np.cos(angles * 1.1) ** 0.5
    path = np.column_stack([0.5 * np.sin(angles), 0.56 * np.cos(angles), np.full(11, 0.13)])
    stem = [path[-1], path[-1] + (0.03, -0.08, 0.0), path[-1] + (0.05, -0.15, 0.0)]
    tip = [path[0], path[0] + (-0.01, -0.03, 0.0)]
    looks: Looks = {
        "main": [tube(path, thickness.tolist(), 8), tube(stem, (0.06, 0.042, 0.036), 6)],
        "dark": [tube(tip, (0.05, 0.045), 6), rod(tuple(stem[2]), tuple(stem[2] + (0.01, -0.03, 0.0)), 0.04, 6)],
    }
    corners = [tuple(path[k].tolist()) for k in (2, 5, 8)]
    ends = [(*(0.97 * path[k][:2]).tolist(), 0.13) for k in (0, -1)]
    solids = [
        capsule(corners[0], corners[1], 0.122),
        capsule(corners[1], corners[2], 0.122),
        capsule(ends[0], corners[0], 0.075),
        capsule(corners[2], ends[1], 0.075),
        capsule(ends[1], tuple(stem[2].tolist()), 0.045),
    ]
    return assemble("banana", looks, solids, WOOD)


def mushroom() -> ToyModel:
    """Return a toadstool with dots."""
    cap = [(0.0, 0.42), (0.3, 0.4), (0.47, 0.42), (0.5, 0.47), (0.46, 0.6), (0.36, 0.74), (0.2, 0.84), (0.0, 0.87)]
    spots = [
        (0, 90),
        (20, 52),
        (95, 45),
        (165, 55),
        (235, 47),
        (305, 50),
        (345, 24),
        (60, 20),
        (130, 22),
        (200, 24),
        (270, 20),
    ]
    looks: Looks = {
        "main": [lathe(cap, segments=MANY)],
        "light": [
            lathe([(0.2, 0.0), (0.22, 0.05), (0.16, 0.2), (0.15, 0.42)]),
            *(_spot(math.radians(around), math.radians(up)) for around, up in spots),
        ],
        "accent": [lathe([(0.26, 0.39), (0.4, 0.385), (0.4, 0.42)], segments=MANY)],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.42), 0.19),
        cylinder((0, 0, 0.4), (0, 0, 0.56), 0.48),
        ellipsoid((0.46, 0.46, 0.35), (0, 0, 0.5)),
    ]
    return assemble("mushroom", looks, solids, WOOD)


def _spot(around: float, up: float) -> Mesh:
    """Return a dot on the cap of a mushroom."""
    x, z = 0.485 * math.cos(up), 0.47 + 0.4 * math.sin(up)
    dot = turn(egg((0.02, 0.07, 0.07), segments=8, rows=4), "y", -math.degrees(up))
    return turn(move(dot, (x, 0, z)), "z", math.degrees(around))


def donut() -> ToyModel:
    """Return an iced donut with sprinkles, and a hole to reach through."""
    icing = move(ring(0.32, 0.185, corners=10), (0, 0, 0.195))
    looks: Looks = {
        "accent": [ring(0.32, 0.18, (0, 0, 0.18))],
        "main": [_wavy(icing)],
        "light": [_sprinkle(2.4 * k, 0.32 + 0.09 * math.sin(5.0 * k), 0.37) for k in range(0, 16, 2)],
        "dark": [_sprinkle(2.4 * k, 0.32 + 0.09 * math.sin(5.0 * k), 0.37) for k in range(1, 16, 2)],
    }
    return assemble("donut", looks, hoop(0.32, 0.18, (0, 0, 0.18)), THIN_SHELL)


def cookie() -> ToyModel:
    """Return a bitten cookie with chips, whose collision shape is a whole disc."""
    angles = math.tau * np.arange(36) / 36
    bite = 0.17 * np.clip(1 - np.abs(angles - 3.6) / 0.42, 0, 1) ** 0.5
    radius = 0.5 - bite + 0.008 * np.cos(5 * angles)
    outline = list(zip((radius * np.cos(angles)).tolist(), (radius * np.sin(angles)).tolist(), strict=True))
    chips = [
        (0.0, 0.03),
        (0.25, -0.1),
        (-0.22, 0.2),
        (0.08, 0.3),
        (-0.1, -0.25),
        (-0.2, -0.02),
        (0.18, -0.34),
        (-0.06, 0.42),
    ]
    chips += [(0.4, -0.0), (0.02, -0.42), (0.15, 0.12)]
    looks: Looks = {
        "main": [plate(outline, 0.0, 0.15, bevel=0.09)],
        "dark": [egg((0.062, 0.055, 0.045), (x, y, 0.15), segments=8, rows=4) for x, y in chips],
    }
    return assemble("cookie", looks, [cylinder((0, 0, 0), (0, 0, 0.15), 0.47)], THIN_SHELL)


def hamburger() -> ToyModel:
    """Return a hamburger with several layers."""
    leaf = [(0.49 + 0.03 * math.cos(9 * a), a) for a in (math.tau * k / 36 for k in range(36))]
    lettuce = [(r * math.cos(a), r * math.sin(a)) for r, a in leaf]
    bun = [(0.0, 0.34), (0.44, 0.34), (0.48, 0.4), (0.46, 0.5), (0.36, 0.62), (0.2, 0.69), (0.0, 0.71)]
    seeds = [(0.0, 0.0), *((0.17, 1.26 * k) for k in range(5)), *((0.33, 0.7 * k + 0.3) for k in range(9))]
    looks: Looks = {
        "main": [
            lathe(bun, segments=MANY),
            lathe([(0.42, 0.0), (0.47, 0.03), (0.47, 0.13), (0.45, 0.15)], segments=MANY),
        ],
        "dark": [lathe([(0.46, 0.15), (0.49, 0.17), (0.49, 0.24), (0.46, 0.26)], segments=MANY)],
        "accent": [plate(lettuce, 0.29, 0.35)],
        "light": [
            turn(plate([(-0.38, -0.38), (0.38, -0.38), (0.38, 0.38), (-0.38, 0.38)], 0.26, 0.29), "z", 20),
            *(
                egg((0.03, 0.022, 0.016), (r * math.cos(a), r * math.sin(a), _bun_top(r)), segments=6, rows=4)
                for r, a in seeds
            ),
        ],
    }
    solids = [cylinder((0, 0, 0), (0, 0, 0.42), 0.47), ellipsoid((0.47, 0.47, 0.29), (0, 0, 0.42))]
    return assemble("hamburger", looks, solids, THIN_SHELL)


def cupcake() -> ToyModel:
    """Return a cupcake in its pleated paper, with a cherry on top."""
    pleats = [1.0 if k % 2 else 0.93 for k in range(32)]
    paper = loft([_star(pleats, radius, height) for radius, height in ((0.3, 0.0), (0.4, 0.36))])
    coils = [
        ring(r, t, (0, 0, z), segments=20, corners=7)
        for r, t, z in ((0.28, 0.14, 0.42), (0.18, 0.12, 0.58), (0.09, 0.1, 0.7))
    ]
    looks: Looks = {
        "accent": [paper, ball(0.085, (0, 0, 0.86), 10, 6)],
        "main": [*coils, lathe([(0.3, 0.34), (0.3, 0.5), (0.17, 0.66), (0.0, 0.8)])],
        "light": [_sprinkle(2.4 * k, 0.33 - 0.012 * k, 0.53 + 0.018 * k) for k in range(10)],
        "dark": [tube([(0, 0, 0.93), (0.02, 0, 0.98), (0.06, 0, 1.02)], 0.012, 6)],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.36), 0.34),
        ellipsoid((0.41, 0.41, 0.35), (0, 0, 0.45)),
        capsule((0, 0, 0.6), (0, 0, 0.88), 0.1),
    ]
    return assemble("cupcake", looks, solids, THIN_SHELL)


def ice_cream() -> ToyModel:
    """Return two scoops of ice cream in a standing wafer."""
    wafer = [(0.14, 0.0), (0.18, 0.36), (0.255, 0.4), (0.265, 0.52), (0.2, 0.53)]
    ribs = [box((0.02, 0.02, 0.34), (0.162, 0, 0.18)) for _ in range(8)]
    scoops = [ball(0.24, (0, 0, 0.6)), _star_skirt(0.235, 0.56)]
    looks: Looks = {
        "accent": [lathe(wafer, segments=20), *(turn(rib, "z", 45 * k) for k, rib in enumerate(ribs))],
        "main": scoops,
        "light": [ball(0.19, (0, 0, 0.85))],
        "dark": [ball(0.06, (0, 0, 1.06), 10, 6), *(_sprinkle(2.4 * k, 0.15, 0.97) for k in range(6))],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.4), 0.17),
        cylinder((0, 0, 0.38), (0, 0, 0.53), 0.26),
        sphere(0.24, (0, 0, 0.6)),
        sphere(0.19, (0, 0, 0.85)),
        sphere(0.06, (0, 0, 1.06)),
    ]
    return assemble("ice_cream", looks, solids, THIN_SHELL)


def _wavy(icing: Mesh) -> Mesh:
    """Return the upper side of a ring of icing, which drips unevenly."""
    x, y, z = icing.vertices.T
    edge = 0.2 + 0.035 * np.sin(7 * np.arctan2(y, x)) * (np.hypot(x, y) > 0.32)
    return Mesh(np.column_stack([x, y, np.maximum(z, edge)]), icing.faces)


def _sprinkle(around: float, out: float, height: float) -> Mesh:
    """Return a short rod that lies somewhere on top, across or along by turns."""
    lying = turn(box((0.07, 0.025, 0.025)), "z", math.degrees(3.1 * around))
    return turn(move(lying, (out, 0, height)), "z", math.degrees(around))


def _bun_top(radius: float) -> float:
    """Return the height of a bun's skin."""
    return 0.42 + 0.29 * math.sqrt(1 - (radius / 0.48) ** 2)


def _star(factors: list[float], radius: float, height: float) -> list[tuple[float, float, float]]:
    """Return a ring with a wavy radius."""
    turns = [math.tau * k / len(factors) for k in range(len(factors))]
    return [(f * radius * math.cos(a), f * radius * math.sin(a), height) for f, a in zip(factors, turns, strict=True)]


def _star_skirt(radius: float, height: float) -> Mesh:
    """Return the wavy rim of a scoop."""
    waves = [1.0 + 0.08 * math.cos(math.tau * 8 * k / 32) for k in range(32)]
    return loft(
        [
            _star(waves, 0.9 * radius, height - 0.05),
            _star(waves, 1.1 * radius, height),
            _star(waves, radius, height + 0.08),
        ]
    )
