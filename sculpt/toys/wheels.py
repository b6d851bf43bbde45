"""Visual meshes and collision shapes of wheels."""

from toys.shaping import lathe
from toys.solids import capsule
from toys.transforms import move, pair, turn

from mimoc.compiler.toys.shape import Mesh, Solid


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
