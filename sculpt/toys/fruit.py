"""Toy fruit and mushrooms."""

import math

import numpy as np
from toys.materials import THIN_SHELL, WOOD
from toys.shaping import egg, lathe, rod, tube
from toys.solids import capsule, cylinder, ellipsoid, sphere
from toys.transforms import move, turn

from mimoc.compiler.toys.shape import Looks, Mesh, ToyModel, assemble

MANY = 24
"""Corners of circles that are seen from close up."""


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
