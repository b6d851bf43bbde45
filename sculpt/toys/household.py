"""Toy household objects: dishes, a bottle, a hat and furniture."""

from toys.shaping import Outline, box, lathe, rod, tube
from toys.solids import FELT, PLUSH, POLYPROPYLENE, SHELL, WOOD, block, capsule, cylinder, wall

from mimoc.compiler.toys import Looks, Mesh, ToyModel, assemble

MANY = 24  # Corners of circles that are seen from close up.


def cup() -> ToyModel:
    """Return a beaker that objects can be put into."""
    side = [(0.33, 0.0), (0.44, 0.96), (0.46, 1.0), (0.4, 1.0), (0.29, 0.06), (0.0, 0.06)]
    looks: Looks = {
        "main": [lathe(side, segments=MANY)],
        "accent": [_band([(0.376, 0.42), (0.398, 0.44), (0.411, 0.56), (0.391, 0.58)])],
        "light": [_band([(0.36, 0.3), (0.382, 0.31), (0.386, 0.35), (0.364, 0.36)])],
    }
    solids = [cylinder((0, 0, 0), (0, 0, 0.06), 0.33), *wall(0.395, 0.05, 0.01, 1.0, flare=0.11)]
    return assemble("cup", looks, solids, POLYPROPYLENE)


def mug() -> ToyModel:
    """Return a mug that can be held by its handle, and filled."""
    side = [(0.35, 0.0), (0.38, 0.03), (0.38, 0.84), (0.37, 0.86), (0.32, 0.86), (0.32, 0.06), (0.0, 0.06)]
    handle = [
        (0.4, 0, 0.72),
        (0.5, 0, 0.72),
        (0.6, 0, 0.62),
        (0.62, 0, 0.46),
        (0.58, 0, 0.3),
        (0.48, 0, 0.19),
        (0.4, 0, 0.17),
    ]
    looks: Looks = {
        "main": [lathe(side, segments=MANY)],
        "accent": [tube(handle, 0.05)],
        "light": [_band([(0.37, 0.3), (0.39, 0.3), (0.39, 0.42), (0.37, 0.42)])],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.06), 0.36),
        *wall(0.37, 0.05, 0.01, 0.86),
        capsule((0.38, 0, 0.72), (0.55, 0, 0.7), 0.05),
        capsule((0.61, 0, 0.62), (0.6, 0, 0.34), 0.05),
        capsule((0.38, 0, 0.17), (0.55, 0, 0.24), 0.05),
    ]
    return assemble("mug", looks, solids, POLYPROPYLENE)


def bowl() -> ToyModel:
    """Return a bowl that objects can be put into."""
    outside = [(0.22, 0.0), (0.22, 0.04), (0.32, 0.09), (0.42, 0.2), (0.48, 0.36), (0.5, 0.4)]
    inside = [(0.46, 0.4), (0.44, 0.35), (0.38, 0.22), (0.29, 0.13), (0.0, 0.09)]
    looks: Looks = {
        "main": [lathe([*outside, *inside], segments=MANY)],
        "accent": [_band([(0.455, 0.31), (0.475, 0.31), (0.495, 0.36), (0.475, 0.36)])],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.09), 0.24),
        *wall(0.32, 0.05, 0.02, 0.19, flare=0.2),
        *wall(0.465, 0.05, 0.17, 0.4, flare=0.1),
    ]
    return assemble("bowl", looks, solids, POLYPROPYLENE)


def bottle() -> ToyModel:
    """Return a baby's bottle."""
    body = [
        (0.17, 0.0),
        (0.19, 0.03),
        (0.19, 0.22),
        (0.165, 0.3),
        (0.165, 0.42),
        (0.19, 0.5),
        (0.19, 0.6),
        (0.15, 0.68),
    ]
    teat = [(0.13, 0.78), (0.12, 0.83), (0.06, 0.87), (0.05, 0.93), (0.06, 0.96), (0.045, 0.99), (0.0, 1.0)]
    marks = [box((0.03, 0.09, 0.015), (0.185, 0, z)) for z in (0.12, 0.18, 0.54, 0.6)]
    looks: Looks = {
        "light": [lathe(body, segments=20)],
        "main": [lathe([(0.17, 0.66), (0.18, 0.67), (0.18, 0.77), (0.165, 0.79)], segments=20)],
        "accent": [lathe(teat, segments=14), *marks],
    }
    solids = [
        cylinder((0, 0, 0), (0, 0, 0.66), 0.185),
        cylinder((0, 0, 0.66), (0, 0, 0.79), 0.18),
        capsule((0, 0, 0.79), (0, 0, 0.94), 0.06),
    ]
    return assemble("bottle", looks, solids, SHELL)


def hat() -> ToyModel:
    """Return a sun hat on its brim, whose visual mesh is hollow and whose collision shape is not."""
    outside = [(0.5, 0.0), (0.5, 0.025), (0.31, 0.06), (0.285, 0.3), (0.24, 0.36), (0.12, 0.39), (0.0, 0.4)]
    inside = [(0.0, 0.37), (0.22, 0.33), (0.26, 0.28), (0.28, 0.03)]
    looks: Looks = {
        "main": [lathe([*inside, *outside], segments=MANY)],
        "accent": [_band([(0.29, 0.055), (0.32, 0.055), (0.308, 0.15), (0.28, 0.15)])],
    }
    solids = [cylinder((0, 0, 0), (0, 0, 0.035), 0.49), cylinder((0, 0, 0.03), (0, 0, 0.36), 0.29)]
    return assemble("hat", looks, solids, FELT)


def sofa() -> ToyModel:
    """Return a sofa for dolls."""
    legs = [box((0.06, 0.06, 0.08), (x, y, 0.04)) for x in (-0.2, 0.2) for y in (-0.42, 0.42)]
    looks: Looks = {
        "main": [
            box((0.5, 0.96, 0.16), (0, 0, 0.14), bevel=0.02),
            box((0.16, 0.96, 0.42), (-0.17, 0, 0.34), bevel=0.05),
            *(box((0.5, 0.14, 0.32), (0, y, 0.25), bevel=0.05) for y in (-0.43, 0.43)),
        ],
        "accent": [
            *(box((0.36, 0.35, 0.1), (0.06, y, 0.26), bevel=0.03) for y in (-0.18, 0.18)),
            *(box((0.1, 0.34, 0.24), (-0.08, y, 0.41), bevel=0.03) for y in (-0.18, 0.18)),
        ],
        "dark": legs,
    }
    solids = [
        block((0.5, 0.96, 0.3), (0, 0, 0.15)),
        block((0.2, 0.96, 0.27), (-0.15, 0, 0.415)),
        *(block((0.5, 0.14, 0.12), (0, y, 0.35)) for y in (-0.43, 0.43)),
    ]
    return assemble("sofa", looks, solids, PLUSH)


def chair() -> ToyModel:
    """Return a chair for dolls."""
    corners = [(x, y) for x in (-0.2, 0.2) for y in (-0.2, 0.2)]
    posts = [rod((-0.21, y, 0.5), (-0.25, y, 0.96), 0.03, 8) for y in (-0.19, 0.19)]
    looks: Looks = {
        "main": [
            box((0.5, 0.5, 0.07), (0, 0, 0.47), bevel=0.02),
            box((0.05, 0.46, 0.13), (-0.245, 0, 0.9), bevel=0.02),
            box((0.04, 0.4, 0.08), (-0.23, 0, 0.7), bevel=0.015),
        ],
        "accent": [lathe([(0.03, 0.0), (0.04, 0.45)], (x, y, 0), segments=10) for x, y in corners],
        "light": posts,
    }
    solids = [
        *(capsule((x, y, 0.035), (x, y, 0.44), 0.035) for x, y in corners),
        block((0.5, 0.5, 0.07), (0, 0, 0.47)),
        block((0.07, 0.46, 0.5), (-0.24, 0, 0.72)),
    ]
    return assemble("chair", looks, solids, WOOD)


def _band(profile: Outline) -> Mesh:
    """Return a stripe around a hollow object, which leaves it open."""
    return lathe(profile, segments=MANY, closed=True)
