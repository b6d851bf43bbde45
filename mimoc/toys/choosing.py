"""Which toys there are, how large and in which colours: each drawn at random, from a stream of its own."""

import colorsys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.mjcf.materials import Rgba
from mimoc.random_streams import between, pick, stream, whole_between
from mimoc.toys.model import Tint, ToyModel
from mimoc.toys.solids import radius
from mimoc.toys.spec import ToysSpec
from mimoc.units import cm_to_m

SATURATION, BRIGHTNESS = (0.55, 0.9), (0.65, 0.95)
"""Of a toy's colour; its hue is any."""
ACCENT = (0.42, 0.58)
"""How far the hue of the second colour is from the first, in turns: about opposite."""
DARK: Rgba = (0.13, 0.13, 0.15, 1.0)
LIGHT: Rgba = (0.96, 0.95, 0.92, 1.0)


@dataclass(frozen=True, slots=True)
class Toybox:
    """What toys there are to choose from."""

    names: Sequence[str]
    """Of the objects."""
    load: Callable[[str], ToyModel]
    """Returns the shape of one."""
    notes: tuple[str, ...] = ()
    """What the user of a bundle with such toys should know."""


@dataclass(frozen=True, slots=True)
class Toy:
    """A toy that has been chosen, without a place."""

    model: ToyModel
    size_m: float
    """Longest side."""
    yaw_rad: float
    """How it is turned about the vertical."""
    colours: dict[Tint, Rgba]

    @property
    def mass_kg(self) -> float:
        """What it weighs."""
        return self.model.volume * self.size_m**3 * self.model.density_kg_m3

    @property
    def radius_m(self) -> float:
        """How far it reaches from the vertical through its middle, with all it shows and touches with."""
        seen = (float(np.linalg.norm(part.mesh.vertices[:, :2], axis=1).max()) for part in self.model.parts)
        return self.size_m * max(*seen, *map(radius, self.model.solids))


def choose_toys(spec: ToysSpec, seed: int, box: Toybox) -> tuple[Toy, ...]:
    """Return a random number of toys; the first ones are the same, however many there are.

    Args:
        spec: How many, and how large.
        seed: Of the scene.
        box: What to choose from.
    """
    count = whole_between(stream(seed, "toys.count"), *spec.count)
    which, sizes, colours, turns = (
        stream(seed, f"toys.{aspect}") for aspect in ("choice", "size", "colour", "orientation")
    )
    low_m, high_m = map(cm_to_m, spec.size_cm)
    return tuple(
        Toy(
            model=box.load(pick(which, box.names)),
            size_m=between(sizes, low_m, high_m),
            yaw_rad=between(turns, 0.0, 2 * np.pi),
            colours=_draw_colours(colours),
        )
        for _ in range(count)
    )


def _draw_colours(generator: np.random.Generator) -> dict[Tint, Rgba]:
    """Return a colour, one that goes with it, nearly black and nearly white."""
    hue, saturation, brightness = (between(generator, *ends) for ends in ((0.0, 1.0), SATURATION, BRIGHTNESS))
    other = (hue + between(generator, *ACCENT)) % 1.0
    return {
        "main": _rgba(hue, saturation, brightness),
        "accent": _rgba(other, saturation, brightness),
        "dark": DARK,
        "light": LIGHT,
    }


def _rgba(hue: float, saturation: float, brightness: float) -> Rgba:
    red, green, blue = (round(channel, 4) for channel in colorsys.hsv_to_rgb(hue, saturation, brightness))
    return red, green, blue, 1.0
