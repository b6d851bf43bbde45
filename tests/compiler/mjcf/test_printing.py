"""Templates only print, each once compiled for all processes, and a prefix changes the names of an infant only."""

import re

import mujoco
import numpy as np
import pytest
from jinja2 import Environment, FileSystemLoader, UndefinedError, nodes
from lxml import etree

import mimoc
from mimoc.compiler import building, model_check
from mimoc.compiler.building import builder
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.printing import (
    TEMPLATES,
    CompiledTemplates,
    environment,
    prefixed_scene,
    render_scene,
    render_text,
)
from mimoc.schema import InfantSpec


def test_a_template_that_is_given_too_little_fails():
    with pytest.raises(UndefinedError):
        environment().from_string("{{ nothing }}").render()
    with pytest.raises(UndefinedError, match="manifest"):
        render_text("README.md.j2", version="1")


def test_names_are_escaped_in_xml():
    template = environment().get_template("scene.xml.j2")
    assert template.environment.autoescape("scene.xml.j2")
    assert not template.environment.autoescape("README.md.j2")


@pytest.fixture
def compiles(monkeypatch):
    """Return whether an environment that keeps compiled templates in a folder compiles one of mimoc's templates."""

    def _compiles(folder):
        compiled = []
        new = Environment(loader=FileSystemLoader(TEMPLATES), bytecode_cache=CompiledTemplates(str(folder)))
        new.filters["num"] = str
        original = new.compile
        monkeypatch.setattr(new, "compile", lambda *args, **kwargs: compiled.append(args) or original(*args, **kwargs))
        assert new.get_template("README.md.j2")
        return bool(compiled)

    return _compiles


def test_a_template_is_compiled_once_for_all_processes(compiles, tmp_path):
    assert [compiles(tmp_path / "new"), compiles(tmp_path / "new")] == [True, False]


@pytest.mark.parametrize("content", [b"", b"damaged", b"j2\x05\x00\x00\x00\x00\x00"])
def test_a_damaged_compiled_template_is_compiled_again(compiles, tmp_path, content):
    compiles(tmp_path)
    for file in tmp_path.iterdir():
        file.write_bytes(content or file.read_bytes()[:40])
    assert [compiles(tmp_path), compiles(tmp_path)] == [True, False]


def test_a_folder_that_cannot_be_made_costs_only_time(compiles, tmp_path):
    (tmp_path / "file").touch()
    assert [compiles(tmp_path / "file" / "below"), compiles(tmp_path / "file")] == [True, True]


INFANTS = {
    "mitten": {},
    "five fingers": {"body": {"hands": "five_finger"}},
    "muscles": {"actuation": {"model": "muscle"}},
    "spastic": {"impairments": {"preset": "diplegia"}},
    "published": {"development": "published"},
}
REFERRING = ("name", "joint", "site", "body1", "body2", "geom1", "geom2", "material", "texture", "class", "childclass")


@pytest.mark.parametrize("kind", INFANTS)
def test_all_names_begin_with_the_prefix_and_all_numbers_stay(kind):
    data = {"mimoc": 1, "name": "kim", "age_months": 9, "senses": {"touch": {}}, **INFANTS[kind]}
    plain = builder(mimoc.InfantSpec.model_validate(data)).infant
    ours, theirs = (
        etree.fromstring(printing.render_inhabitant(scene)) for scene in (plain, prefixed_scene(plain, "a_"))
    )
    for one, other in zip(ours.iter(), theirs.iter(), strict=True):
        assert one.tag == other.tag
        for key, value in one.attrib.items():
            if key == "name" and one.tag in ("exclude", "pair"):
                first, _, second = value.partition("-")
                assert other.get(key) == f"a_{first}-a_{second}"
            elif key in REFERRING:
                assert other.get(key) == f"a_{value}"
            elif one.tag == "skin" and key == "file":
                assert other.get(key) == value.replace("assets/", "assets/a_")
            else:
                assert other.get(key) == value


def test_a_skin_is_moved_by_the_bodies_with_the_prefix():
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 9, "senses": {}})
    bundle = mimoc.build_world({"a": spec, "b": spec})
    model = mujoco.MjModel.from_xml_string(
        bundle.files["scene.xml"].decode(), {name: bundle.files[name] for name in bundle.files if "assets/" in name}
    )
    for skin in range(model.nskin):
        prefix = model.skin(skin).name[:2]
        bones = model.skin_bonebodyid[model.skin_boneadr[skin] :][: model.skin_bonenum[skin]]
        assert all(model.body(body).name.startswith(prefix) for body in bones)
    halves = np.split(model.skin_vert, 2)
    assert np.array_equal(*halves)


FORBIDDEN: dict[str, tuple[type[nodes.Node], ...]] = {
    "arithmetic": (nodes.BinExpr, nodes.Neg, nodes.Pos, nodes.Concat),
    "a decision": (nodes.If, nodes.CondExpr, nodes.Compare, nodes.And, nodes.Or, nodes.Not),
    "a test": (nodes.Test,),
    "a variable of its own": (nodes.Assign, nodes.AssignBlock, nodes.With),
    "a macro": (nodes.Macro, nodes.CallBlock, nodes.FilterBlock, nodes.Import, nodes.FromImport),
    "a number or a list of its own": (nodes.Const, nodes.List, nodes.Tuple, nodes.Dict),
    "indexing": (nodes.Getitem, nodes.Slice),
    "a control of the loop": (nodes.Break, nodes.Continue),
}
FILTERS = {"num", "rad"}
PLACES = sorted(TEMPLATES.rglob("*.j2"))


def faults(source: str) -> list[str]:
    """Return what a template does beyond printing, by line."""
    tree = environment().parse(source)
    found = [
        (node.lineno, f"{what}: {type(node).__name__}")
        for what, kinds in FORBIDDEN.items()
        for node in tree.find_all(kinds)
        if not _is_name_of_a_part(node, tree)
    ]
    found += [(each.lineno, f"filter: {each.name}") for each in tree.find_all(nodes.Filter) if each.name not in FILTERS]
    found += [(each.lineno, "call") for each in tree.find_all(nodes.Call) if not _is_recursion(each)]
    found += [(each.lineno, "filtered loop") for each in tree.find_all(nodes.For) if each.test or each.else_]
    return [f"line {line}: {what}" for line, what in sorted(found)]


def _is_recursion(call: nodes.Call) -> bool:
    """`{{ loop(body.children) }}` is how a template walks down a tree."""
    return isinstance(call.node, nodes.Name) and call.node.name == "loop"


def _is_name_of_a_part(node: nodes.Node, tree: nodes.Template) -> bool:
    """The tuple in `for name, value in pairs` and the text in `include "limb.xml.j2"` decide nothing."""
    targets = [loop.target for loop in tree.find_all(nodes.For)]
    parts = [include.template for include in tree.find_all(nodes.Include)]
    return any(node is each for each in (*targets, *parts))


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.name)
def test_a_template_only_prints(place):
    assert faults(place.read_text(encoding="utf-8")) == []


def test_the_templates_are_read_at_all():
    """So the test above is not empty: they are there, and what they print is seen."""
    assert {place.name for place in PLACES} >= {"infant.xml.j2", "scene.xml.j2", "README.md.j2"}
    infant = environment().parse((TEMPLATES / "infant.xml.j2").read_text(encoding="utf-8"))
    assert len(list(infant.find_all(nodes.Filter))) > 20
    assert len(list(infant.find_all(nodes.For))) > 5


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ("{{ a + 1 }}", "arithmetic: Add"),
        ("{{ a * b }}", "arithmetic: Mul"),
        ("{{ a ** b }}", "arithmetic: Pow"),
        ("{{ -a }}", "arithmetic: Neg"),
        ("{{ a ~ b }}", "arithmetic: Concat"),
        ("{% if a %}x{% endif %}", "a decision: If"),
        ("{{ a if b }}", "a decision: CondExpr"),
        ("{{ a < b }}", "a decision: Compare"),
        ("{{ a or b }}", "a decision: Or"),
        ("{{ not a }}", "a decision: Not"),
        ("{{ a is defined }}", "a test: Test"),
        ("{% set a = b %}", "a variable of its own: Assign"),
        ("{% with a = b %}{{ a }}{% endwith %}", "a variable of its own: With"),
        ("{% macro a() %}{% endmacro %}", "a macro: Macro"),
        ("{% from 'a' import b %}", "a macro: FromImport"),
        ("{{ 'red' }}", "a number or a list of its own: Const"),
        ("{% for a in [b] %}{% endfor %}", "a number or a list of its own: List"),
        ("{{ a[b] }}", "indexing: Getitem"),
        ("{{ a | round }}", "filter: round"),
        ("{{ a | default(b) }}", "filter: default"),
        ("{{ a | num | upper }}", "filter: upper"),
        ("{{ a.upper() }}", "call"),
        ("{{ range(a) }}", "call"),
        ("{% for a in b if a %}{% endfor %}", "filtered loop"),
        ("{% for a in b %}{% else %}x{% endfor %}", "filtered loop"),
    ],
)
def test_a_template_that_does_more_is_found(source, fault):
    assert f"line 1: {fault}" in faults(source)


def test_printing_is_free():
    source = "{% for a, b in c.d recursive %}{% include 'e' %}{{ a.b | num }} {{ b }}{{ loop(c.d) }}{% endfor %}"
    assert faults(source) == []


def test_every_element_has_a_line_of_its_own():
    """So MuJoCo's 'line 12' means one element."""
    spec = InfantSpec(mimoc=1, name="infant", age_months=9)
    rendered = render_scene(builder(spec).infant)
    for name in ("infant.xml", "scene.xml"):
        lines = rendered[name].decode().splitlines()
        assert len(lines) > 20
        crowded = [line for line in lines if line.strip() and not re.fullmatch(r"\s*<[^<>]+>", line)]
        assert crowded == [], name


FELT = ("dim", "friction", "solref", "solimp", "includemargin")


@pytest.fixture(scope="module", params=["mitten", "five_finger"])
def room(request) -> dict[str, bytes]:
    data = {
        "mimoc": 1,
        "name": "x",
        "age_months": 9,
        "body": {"hands": request.param},
        "scene": {"kind": "room", "toys": {"count": [4, 4]}},
    }
    return dict(building.build(InfantSpec.model_validate(data)).files)


def with_solid_walls(files: dict[str, bytes]) -> mujoco.MjModel:
    """Return the room with walls and ceiling that touch by their contact bits, and no listed pairs of theirs."""
    tree = etree.fromstring(files["scene.xml"])
    pairs = tree.findall("contact/pair")
    for name in {pair.get("geom1") for pair in pairs}:
        (wall,) = tree.xpath(f"worldbody/geom[@name='{name}']")
        wall.set("contype", "1")
        wall.set("conaffinity", "1")
    for pair in pairs:
        pair.getparent().remove(pair)
    return model_check.compile_model({**files, "scene.xml": etree.tostring(tree)})


def contacts(model: mujoco.MjModel, data: mujoco.MjData) -> dict[tuple, list[np.ndarray]]:
    """Return what each contact is like, by its geoms and its place."""
    mujoco.mj_forward(model, data)
    return {
        (*sorted(contact.geom.tolist()), *np.round(contact.pos, 9), round(contact.dist, 9)): [
            np.copy(getattr(contact, name)) for name in FELT
        ]
        for contact in data.contact
    }


def test_walls_and_ceiling_are_touched_as_by_contact_bits(room):
    paired, solid = model_check.compile_model(room), with_solid_walls(room)
    assert (paired.npair, solid.npair) == (5 * _touching(solid), 0)
    wall_touched, generator = 0, np.random.default_rng(0)
    depth, width, height = _half_size_m(paired)
    for _ in range(40):
        states = mujoco.MjData(paired), mujoco.MjData(solid)
        states[0].qpos[:3] = generator.uniform([-depth, -width, 0], [depth, width, 2 * height])
        states[0].qpos[3:7] = generator.normal(size=4)
        states[1].qpos[:] = states[0].qpos
        by_pair, by_bits = contacts(paired, states[0]), contacts(solid, states[1])
        assert by_pair.keys() == by_bits.keys()
        for where, felt in by_pair.items():
            for mine, theirs in zip(felt, by_bits[where], strict=True):
                np.testing.assert_allclose(mine, theirs, atol=1e-12, err_msg=str(where))
        wall_touched += bool(np.isin(states[0].contact.geom, _walls(paired)).any())
    assert wall_touched > 5


def test_rooms_ask_for_nothing_that_warp_lacks(room):
    assert b"midphase" not in room["scene.xml"] + room["infant.xml"]
    assert model_check.compile_model(room).opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE) == 0


def _touching(model: mujoco.MjModel) -> int:
    """Return how many geoms of what moves touch anything."""
    moves = model.body_weldid[model.geom_bodyid] != 0
    return int(((model.geom_contype | model.geom_conaffinity).astype(bool) & moves).sum())


def _half_size_m(model: mujoco.MjModel) -> np.ndarray:
    return np.array([*model.geom("floor").size[:2], model.geom("ceiling").pos[2] / 2])


def _walls(model: mujoco.MjModel) -> list[int]:
    return [model.geom(name).id for name in ("wall_front", "wall_back", "wall_left", "wall_right", "ceiling")]
