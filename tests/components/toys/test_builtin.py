"""The toys that mimoc brings along."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay
from support.full import full_but

from mimoc.compiler.toys import Mesh, ToyModel, bounds, solid_volume
from mimoc.components.toys.builtin import NAMES, load_toy

CATEGORIES = set(
    """
airplane apple ball banana bicycle boat bottle bowl bread bunny bus butterfly cake candy car cat cells_battery
chair chess_piece chicken closet coin cookie cow crab cup cupcake deer_moose dinosaur dog dolphin donut dragon drum
elephant fan fish flower fox fridge fries frog giraffe glass grapes guitar hamburger hammer hat helicopter helmet horse
ice_cream key keyboard knife ladder laptop light_bulb lion lizard marker microwave monitor monkey motorcycle mouse mug
mushroom octopus orange panda pc_mouse pear pen pencil penguin phone piano pig pizza plate radio robot sandwich saw
screwdriver shark sheep shoe sink snake sofa spade stove submarine toaster tractor train trashcan tree truck tv violin
whale
""".split()  # noqa: SIM905
)
ONE_POINT = {"ball", "apple"}
"""What stands on a single point."""
HOLLOW = {"bowl": 0.0, "cup": 0.0, "mug": -0.14, "truck": -0.17}
"""What something can be put into, and x of the middle of the hollow."""
SIZE_M = 0.08
MARBLE_M = 0.007
FRICTION = 'condim="6" friction="1 0.005 0.0005" solref="0.005 1"'


EXAMPLES = full_but(("ball", "cup", "truck"), NAMES)
"""One that stands on a point, one that is hollow, and one of many parts; all others are for `make test-all`."""


@pytest.fixture(params=EXAMPLES)
def toy(request) -> ToyModel:
    return load_toy(request.param)


def test_there_are_enough_to_choose_from():
    assert len(NAMES) >= 24
    assert list(NAMES) == sorted(NAMES)


def test_each_is_named_as_its_category_of_toys4k_and_read_once(toy):
    assert toy.name == toy.category
    assert toy.name in CATEGORIES
    assert toy.source == "made by mimoc"
    assert load_toy(toy.name) is toy


def test_the_longest_side_is_one(toy):
    low, high = looks(toy)
    assert (high - low).max() == pytest.approx(1, abs=1e-12)


def test_it_stands_on_the_ground_over_the_origin(toy):
    low, high = looks(toy)
    np.testing.assert_allclose([*(low + high)[:2], low[2]], 0, atol=1e-12)
    assert touch(toy)[0][2] == pytest.approx(0, abs=1e-12)


def test_it_has_the_colour_that_is_drawn_and_one_part_for_each(toy):
    tints = [part.tint for part in toy.parts]
    assert "main" in tints
    assert len(tints) == len(set(tints))


def test_what_is_seen_is_closed(toy):
    """Each edge is run along once in either direction."""
    for part in toy.parts:
        edges = directed_edges(part.mesh)
        assert len(edges) == 3 * len(part.mesh.faces)
        assert edges == {(b, a) for a, b in edges}


def test_every_shell_faces_outwards(toy):
    for part in toy.parts:
        assert all(shell.volume > 0 for shell in shells(part.mesh))


def test_it_has_few_faces_and_a_small_file(toy):
    assert sum(len(part.mesh.faces) for part in toy.parts) <= 1500
    assert sum(len(obj(part.mesh)) for part in toy.parts) < 100_000


def test_what_touches_is_where_what_is_seen_is(toy):
    (low, high), (low_touch, high_touch) = looks(toy), touch(toy)
    assert np.all(low_touch >= low - 0.05)
    assert np.all(high_touch <= high + 0.05)
    np.testing.assert_allclose([low_touch, high_touch], [low, high], atol=0.1)


def test_what_touches_is_primitive_and_little(toy):
    assert all(solid.mesh is None and solid.type != "mesh" for solid in toy.solids)
    assert len(toy.solids) <= 17
    assert all(np.linalg.norm(solid.quat) == pytest.approx(1) for solid in toy.solids)


def test_it_weighs_as_much_as_the_toys_of_infants(toy):
    mass_kg = toy.volume * 0.1**3 * toy.density_kg_m3
    assert 0.01 <= mass_kg <= 0.2


def test_there_is_as_much_material_as_is_seen(toy):
    assert toy.volume == pytest.approx(sum(part.mesh.volume for part in toy.parts))


def test_it_stays_where_it_is_dropped(toy):
    model = compiled(toy)
    data = mujoco.MjData(model)
    data.qpos[2] = 0.002
    mujoco.mj_step(model, data, nstep=600)
    assert not data.warning.number.any()
    assert np.linalg.norm(data.qpos[:2]) < 0.01
    assert np.degrees(2 * np.arccos(min(1.0, abs(data.qpos[3])))) < 5
    np.testing.assert_allclose(data.qvel, 0, atol=0.01)


def test_it_stands_on_few_points_and_on_them_firmly(toy):
    """The centre of mass is above them, whether it is that of the looks or that of the solids."""
    model = compiled(toy)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=100)
    points = data.contact.pos[:, :2]
    assert 1 <= len(points) <= 4
    for centre in (data.subtree_com[1][:2], SIZE_M * centre_of_mass(toy)[:2]):
        if toy.name in ONE_POINT:
            assert np.linalg.norm(points - centre) < 0.1 * SIZE_M
        else:
            assert Delaunay(points).find_simplex(centre) >= 0


@pytest.mark.parametrize("name", HOLLOW)
def test_something_can_be_put_into_what_is_hollow(name):
    toy = load_toy(name)
    top_m = SIZE_M * looks(toy)[1][2]
    model = compiled(toy, marble_at_m=(SIZE_M * HOLLOW[name], 0.0, top_m))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=600)
    assert 1.2 * MARBLE_M < data.body("marble").xpos[2] < top_m
    assert np.linalg.norm(data.body("marble").xpos[:2]) < SIZE_M / 2
    assert np.linalg.norm(data.body("toy").xpos) < 0.01


def test_looks_differ_between_any_two():
    digests = [b"".join(part.mesh.vertices.tobytes() for part in load_toy(name).parts) for name in NAMES]
    assert all(one != other for one, other in pairwise(sorted(digests)))


def looks(toy: ToyModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest corner of the box around what is seen."""
    vertices = np.concatenate([part.mesh.vertices for part in toy.parts])
    return vertices.min(axis=0), vertices.max(axis=0)


def touch(toy: ToyModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest corner of the box around what touches."""
    corners = np.array([bounds(solid) for solid in toy.solids])
    return corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)


def directed_edges(mesh: Mesh) -> set[tuple[int, int]]:
    return {(int(a), int(b)) for face in mesh.faces for a, b in zip(face, np.roll(face, -1), strict=True)}


def shells(mesh: Mesh) -> list[Mesh]:
    """Return the connected pieces of a mesh."""
    a, b, c = mesh.faces.T
    count = len(mesh.vertices)
    ones = np.ones(2 * len(a))
    graph = coo_array((ones, (np.concatenate([a, b]), np.concatenate([b, c]))), shape=(count, count))
    pieces, label = connected_components(graph, directed=False)
    return [Mesh(mesh.vertices, mesh.faces[label[a] == piece]) for piece in range(pieces)]


def obj(mesh: Mesh) -> str:
    corners = [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in mesh.vertices]
    return "\n".join([*corners, *(f"f {a} {b} {c}" for a, b, c in mesh.faces + 1)])


def centre_of_mass(toy: ToyModel) -> np.ndarray:
    """Return the middle of what is seen, were it of one material."""
    moment, volume = np.zeros(3), 0.0
    for part in toy.parts:
        a, b, c = (part.mesh.vertices[part.mesh.faces[:, corner]] for corner in range(3))
        sixths = np.einsum("ij,ij->i", np.cross(a, b), c)
        moment += sixths @ (a + b + c) / 24
        volume += sixths.sum() / 6
    return moment / volume


def compiled(toy: ToyModel, marble_at_m: tuple[float, float, float] | None = None) -> mujoco.MjModel:
    """Return a toy of 8 cm on a floor, its weight spread over its solids, and maybe a marble."""
    assets = "".join(
        f'<mesh name="{part.tint}" vertex="{row(SIZE_M * part.mesh.vertices)}" face="{row(part.mesh.faces)}"/>'
        for part in toy.parts
    )
    seen = "".join(f'<geom type="mesh" mesh="{part.tint}" contype="0" conaffinity="0" mass="0"/>' for part in toy.parts)
    mass_kg = toy.volume * SIZE_M**3 * toy.density_kg_m3
    share_kg = [mass_kg * solid_volume(solid) / sum(map(solid_volume, toy.solids)) for solid in toy.solids]
    felt = "".join(
        f'<geom type="{solid.type}" size="{row(SIZE_M * np.array(solid.size))}" quat="{row(solid.quat)}" '
        f'pos="{row(SIZE_M * np.array(solid.pos))}" mass="{mass}" {FRICTION}/>'
        for solid, mass in zip(toy.solids, share_kg, strict=True)
    )
    other = (
        f'<body name="marble" pos="{row(marble_at_m)}"><freejoint/><geom size="{MARBLE_M}" mass="0.002"/></body>'
        if marble_at_m
        else ""
    )
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.005" integrator="implicitfast"/><asset>{assets}</asset><worldbody>'
        f'<geom type="plane" size="1 1 1" {FRICTION}/><body name="toy"><freejoint/>{seen}{felt}</body>{other}'
        "</worldbody></mujoco>"
    )


def row(numbers) -> str:
    return " ".join(f"{number:.9g}" for number in np.asarray(numbers).ravel())
