"""How the face of a child differs by age. Lengths are mm on a head of nine months, whatever the age."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FaceShape:
    """Shapes of one age, in a frame at the middle of the head's solid: x forward, z up; both sides are the same.

    All are by eye (D), from portraits of children and from the ratios of Farkas (1994) where it has some.
    """

    forehead: float  # How far the forehead stands out beyond the solid.
    occiput: float  # How far the back of the head does.
    temple: float  # How far the temples do.
    side: float  # How far the sides of the head do, above the ears.
    bridge: float  # How far the bridge of the nose does, between the eyes.
    tip: tuple[float, float, float]  # Middle of the tip of the nose, x and z, and its radius.
    wing: tuple[float, float]  # Distance of the middle of a wing of the nose from the midline, and its radius.
    cheek: float  # How far a cheek stands out under the eye.
    jowl: float  # How far it does beside the jaw.
    mouth: tuple[float, float]  # Where the lips meet on the midline, about: x and z.
    jaw: tuple[float, float]  # Middle of the lower jaw, x and z.
    jaw_size: tuple[float, float, float]  # Its half axes.
    chin: tuple[float, float, float]  # Front of the chin, x, its height, z, and its radius.
    lids: tuple[float, float]  # How far upper and lower lids are open, by how far they are in the mesh.
    puffy: float  # How far the skin under an eye and above it stands out.


SHAPES = {
    0: FaceShape(
        forehead=2.6,
        occiput=0.0,
        temple=0.0,
        side=4.0,
        bridge=-2.6,
        tip=(77.0, -26.5, 5.6),
        wing=(5.4, 3.8),
        cheek=5.0,
        jowl=5.4,
        mouth=(71.0, -43.5),
        jaw=(22.0, -42.0),
        jaw_size=(37.0, 35.0, 26.0),
        chin=(59.0, -59.0, 7.5),
        lids=(0.78, 0.86),
        puffy=1.4,
    ),
    3: FaceShape(
        forehead=2.8,
        occiput=0.0,
        temple=0.0,
        side=4.5,
        bridge=-2.4,
        tip=(78.6, -27.5, 5.6),
        wing=(5.4, 3.8),
        cheek=7.0,
        jowl=8.6,
        mouth=(72.0, -45.5),
        jaw=(23.0, -44.0),
        jaw_size=(38.0, 37.0, 28.0),
        chin=(60.5, -62.0, 8.0),
        lids=(0.93, 1.0),
        puffy=0.7,
    ),
    6: FaceShape(
        forehead=2.2,
        occiput=0.0,
        temple=0.0,
        side=4.5,
        bridge=-2.0,
        tip=(79.6, -28.0, 5.6),
        wing=(5.4, 3.8),
        cheek=6.8,
        jowl=8.2,
        mouth=(72.5, -47.0),
        jaw=(24.0, -46.0),
        jaw_size=(39.0, 37.0, 29.0),
        chin=(61.5, -64.5, 8.5),
        lids=(0.95, 1.02),
        puffy=0.5,
    ),
    12: FaceShape(
        forehead=1.4,
        occiput=1.0,
        temple=-0.4,
        side=4.5,
        bridge=-1.2,
        tip=(81.0, -29.0, 5.5),
        wing=(5.5, 3.7),
        cheek=5.8,
        jowl=6.4,
        mouth=(73.0, -49.0),
        jaw=(26.0, -50.0),
        jaw_size=(40.0, 36.0, 30.0),
        chin=(63.0, -68.0, 9.0),
        lids=(0.9, 0.98),
        puffy=0.3,
    ),
    24: FaceShape(
        forehead=0.2,
        occiput=2.5,
        temple=-1.2,
        side=4.0,
        bridge=0.6,
        tip=(82.0, -30.5, 5.3),
        wing=(5.8, 3.7),
        cheek=3.2,
        jowl=4.2,
        mouth=(73.5, -52.5),
        jaw=(28.0, -55.0),
        jaw_size=(41.0, 36.5, 31.0),
        chin=(65.0, -74.5, 9.5),
        lids=(0.85, 0.93),
        puffy=0.1,
    ),
}
"""Shape by age in months."""
MESHED = 6  # The age whose surface becomes the mesh, which the others share.
