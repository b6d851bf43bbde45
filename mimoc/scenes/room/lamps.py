"""Lamps on the ceiling of a room, and their light."""

from collections.abc import Iterator

import numpy as np

from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.furniture import UNTOUCHED, SpotLight, WorldGeom
from mimoc.mjcf.materials import WorldMaterial
from mimoc.random_streams import between, whole_between
from mimoc.scenes.room.pictures import OFF_THE_WALL_M

LAMP_COUNT = (1, 2)
LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M = 0.16, 0.025
LAMP_LIGHT = 0.34
"""All lamps together, on what faces them: with the headlight, white walls are just not overexposed."""
WARMEST, COOLEST = (1.0, 0.93, 0.82), (0.96, 0.98, 1.0)
SHADE = WorldMaterial("lamp", (1.0, 0.98, 0.93, 1.0), emission=0.9)


def hang_lamps(
    generator: np.random.Generator, depth: float, width: float, height: float
) -> tuple[tuple[WorldGeom, ...], tuple[SpotLight, ...]]:
    """Return lamps on the ceiling, in a row along the longer side, and their light."""
    count = whole_between(generator, *LAMP_COUNT)
    warmth, brightness = generator.random(), between(generator, 0.85, 1.0)
    sideways, along = (between(generator, -0.1, 0.1) for _ in range(2))
    red, green, blue = (
        brightness * LAMP_LIGHT / count * (warmth * warm + (1 - warmth) * cool)
        for warm, cool in zip(WARMEST, COOLEST, strict=True)
    )
    shares = [((number + 0.5) / count - 0.5 + along, sideways) for number in range(count)]
    if depth < width:
        shares = [(across, down) for down, across in shares]
    places = [(depth * share_x, width * share_y) for share_x, share_y in shares]
    lamps = list(_lamps(places, height))
    lights = list(_lights(places, height, (red, green, blue)))
    return tuple(lamps), tuple(lights)


def _lamps(places: list[tuple[float, float]], height: float) -> Iterator[WorldGeom]:
    for number, (x, y) in enumerate(places, start=1):
        yield WorldGeom(
            f"lamp_{number}",
            "cylinder",
            (LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M),
            (x, y, height - OFF_THE_WALL_M - LAMP_HALF_HEIGHT_M),
            (0.0, 0.0, 0.0),
            SHADE.name,
            contype=UNTOUCHED,
            conaffinity=UNTOUCHED,
        )


def _lights(places: list[tuple[float, float]], height: float, diffuse: Vec3) -> Iterator[SpotLight]:
    """Yield the light of each lamp; only that of the first casts shadows."""
    for number, (x, y) in enumerate(places, start=1):
        yield SpotLight(
            f"lamp_{number}",
            (x, y, height - 3 * LAMP_HALF_HEIGHT_M),
            (0.0, 0.0, -1.0),
            diffuse,
            specular=(0.05, 0.05, 0.05),
            attenuation=(1.0, 0.0, 0.0),
            cutoff_deg=90.0,
            exponent=0.0,
            castshadow=number == 1,
        )
