"""Random choice of toys, sizes, colours and orientations, each from a separate random stream."""

import colorsys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from mimoc.base.random_streams import between, pick, stream, whole_between
from mimoc.base.units import cm_to_m
from mimoc.compiler.mjcf.furniture import Rgba
from mimoc.compiler.toys.shape import Tint, ToyModel, radius
from mimoc.schema.toys import ToysSpec

SATURATION, BRIGHTNESS = (0.55, 0.9), (0.65, 0.95)
"""Ranges of the saturation and brightness of a toy's colour; its hue is unrestricted."""
ACCENT = (0.42, 0.58)
"""Range of the difference in hue between the two colours of a toy, in turns: about opposite."""
DARK: Rgba = (0.13, 0.13, 0.15, 1.0)
LIGHT: Rgba = (0.96, 0.95, 0.92, 1.0)


@dataclass(frozen=True, slots=True)
class Toybox:
    """A set of toys to choose from."""

    names: Sequence[str]
    load: Callable[[str], ToyModel]
    """Function that returns the shape of a toy by its name."""
    notes: tuple[str, ...] = ()
    """Notes for the user of a bundle with such toys."""
    progress: Callable[[int, int], None] = field(default=lambda done, total: None, compare=False)
    """Called with the number of a scene's toys that are loaded and their total; a mesh takes long the first time."""


@dataclass(frozen=True, slots=True)
class Toy:
    """A chosen toy, before it is placed."""

    model: ToyModel
    size_m: float
    """Length of its longest side."""
    yaw_rad: float
    """Rotation about the vertical."""
    colours: dict[Tint, Rgba]

    @property
    def mass_kg(self) -> float:
        """Mass."""
        return self.model.volume * self.size_m**3 * self.model.density_kg_m3

    @property
    def radius_m(self) -> float:
        """Radius of the smallest vertical cylinder about its origin that encloses its visual and collision geoms."""
        visual = (float(np.linalg.norm(part.mesh.vertices[:, :2], axis=1).max()) for part in self.model.parts)
        return self.size_m * max(*visual, *map(radius, self.model.solids))


def choose_toys(spec: ToysSpec, seed: int, box: Toybox) -> tuple[Toy, ...]:
    """Return a random number of toys from a box; the first n do not depend on the number."""
    count = whole_between(stream(seed, "toys.count"), *spec.count)
    which, sizes, colours, turns = (
        stream(seed, f"toys.{aspect}") for aspect in ("choice", "size", "colour", "orientation")
    )
    low_m, high_m = map(cm_to_m, spec.size_cm)
    toys: list[Toy] = []
    for done in range(count):
        box.progress(done, count)
        model, size_m = box.load(pick(which, box.names)), between(sizes, low_m, high_m)
        toys.append(Toy(model, size_m, between(turns, 0.0, 2 * np.pi), _draw_colours(colours)))
    return tuple(toys)


def _draw_colours(generator: np.random.Generator) -> dict[Tint, Rgba]:
    """Return a random colour, a contrasting one, a near-black and a near-white."""
    hue, saturation, brightness = (between(generator, *ends) for ends in ((0.0, 1.0), SATURATION, BRIGHTNESS))
    other = (hue + between(generator, *ACCENT)) % 1.0
    main, accent = (_rgba(turn, saturation, brightness) for turn in (hue, other))
    return {"main": main, "accent": accent, "dark": DARK, "light": LIGHT}


def _rgba(hue: float, saturation: float, brightness: float) -> Rgba:
    red, green, blue = (round(channel, 4) for channel in colorsys.hsv_to_rgb(hue, saturation, brightness))
    return red, green, blue, 1.0
