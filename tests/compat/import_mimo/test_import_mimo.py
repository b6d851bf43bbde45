"""What a scene with MIMo in it becomes: a spec, and the scene without its infant."""

import re
import shlex
import shutil
import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
import pytest
from PIL import Image
from support.mimo_scenes import FREE, WORLD, body, mimo_of, remove, with_prefixes, write_scene

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.io import write_bundle
from mimoc.compat import import_config
from mimoc.compat.settings import Imported

PAGE = Path(__file__).parents[3] / "docs" / "import_mimo.md"
HELD = '<equality><weld body1="mimo_location"/></equality>'
TARGET = '<body name="target" pos=".3 0 .6"><freejoint name="target_joint"/><geom size=".02" mass=".1"/></body>'
RAIL = (
    '<body name="crib" pos=".1 0 .4"><geom size=".02 .4" type="cylinder"/><geom size=".01 .2" type="cylinder"/></body>'
)
CRIB = '<body name="crib"><body name="crib_base"><geom type="box" size=".5 .4 .1"/></body></body>'
WALL = '<geom type="box" size="{1}" pos="{0}"/>'
ROOM = '<body name="room" pos="0 0 1">{}</body>'.format(
    "".join(WALL.format(*wall) for wall in (("0 2 0", "2 .1 1"), ("0 -2 0", "2 .1 1"), ("1.5 0 0", ".1 2 1")))
)


def imported(folder: Path, infant=None, **parts: str) -> Imported:
    return import_config("mimo", write_scene(folder, infant, **parts))


def notes(result: Imported) -> str:
    return "\n".join(map(str, result.notes))


def opened(result: Imported, folder: Path, target: str | None = None) -> mujoco.MjModel:
    """Write what was imported, build its spec, and open the scene that is beside it."""
    folder.mkdir(exist_ok=True)
    (folder / "spec.yaml").write_text(result.text)
    for name, content in result.scene("spec").items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)
    bundle = mimoc.build(mimoc.load_spec(folder / "spec.yaml"), target)
    write_bundle(bundle, folder / "out" / result.spec["name"], force=True)
    return mujoco.MjModel.from_xml_path(str(folder / "spec_scene.xml"))


def names(model: mujoco.MjModel, kind: str, count: int) -> list[str]:
    return [getattr(model, kind)(index).name for index in range(count)]


def test_the_infant_of_a_scene_becomes_a_spec(tmp_path):
    assert imported(tmp_path).spec == {
        "mimoc": 1,
        "name": "nursery",
        "age_months": 9,
        "development": "published",
        "senses": {"proprioception": {}, "vestibular": {}},
        "scene": {"kind": "flat", "pose": "standing"},
    }


@pytest.mark.parametrize(
    ("parts", "section", "value"),
    [
        ({"turn": 'euler="0 -1.57 0"'}, "scene", {"kind": "flat", "pose": "supine"}),
        ({"turn": 'euler="0 1.57 0"'}, "scene", {"kind": "flat", "pose": "prone"}),
        ({"pos": "0 0 .1"}, "scene", {"kind": "flat", "pose": "sitting"}),
        ({"world": ""}, "scene", {"kind": "empty", "pose": "standing"}),
        ({"world": WORLD + CRIB}, "scene", {"kind": "crib", "pose": "standing"}),
        (
            {"world": WORLD + ROOM},
            "scene",
            {"kind": "room", "pose": "standing", "room": {"size_m": [[2.8, 2.8], [3.8, 3.8], [2.0, 2.0]]}},
        ),
        ({"sections": HELD}, "scene", {"kind": "flat", "pose": "standing", "held": ["hip"]}),
        ({"joint": ""}, "scene", {"kind": "flat", "pose": "standing", "held": ["hip"]}),
        ({"sections": HELD.replace("/>", ' active="false"/>')}, "scene", {"kind": "flat", "pose": "standing"}),
        (
            {"sections": '<equality><weld body1="lower_body"/></equality>'},
            "scene",
            {"kind": "flat", "pose": "standing", "held": ["lower_body"]},
        ),
        (
            {"sections": '<equality><weld body1="head" body2="upper_body"/></equality>'},
            "actuation",
            {"locked": ["neck"]},
        ),
        ({"world": WORLD + TARGET}, "task", {"kind": "reach"}),
        ({"world": WORLD + TARGET, "gravity": "0 0 0"}, "task", {"kind": "reach"}),
        ({"world": WORLD + RAIL}, "task", {"kind": "standup"}),
        ({"timestep": ".002"}, "control", {"step_ms": 10.0, "timestep_ms": 2.0}),
        ({"timestep": ".003"}, "control", {"step_ms": 12.0, "timestep_ms": 3.0}),
    ],
)
def test_what_a_spec_can_say_of_a_scene_it_says(tmp_path, parts, section, value):
    assert imported(tmp_path, **parts).spec[section] == value


@pytest.mark.full
@pytest.mark.parametrize("age_months", [0.5, 4, 17.25])
def test_the_age_is_known_by_the_sizes(tmp_path, age_months):
    result = imported(tmp_path, mimo_of(age_months))
    assert result.spec["age_months"] == age_months
    assert f"it has the sizes of {age_months:g} months by the published law" in notes(result)
    assert [note.key for note in result.notes if "site 'eef:" not in note.key] == ["body 'hip'"]


def test_an_infant_of_no_age_is_given_the_nearest(tmp_path):
    infant = mimo_of(6)
    for geom in infant.iter("geom"):
        sizes = [1.05 * float(size) for size in geom.get("size", "").split()]
        geom.set("size", " ".join(map(str, sizes)))
    result = imported(tmp_path, infant)
    assert 6 < result.spec["age_months"] < 12
    assert "its sizes are those of no age by the published law of growth; nearest is " in notes(result)


@pytest.mark.full
def test_five_fingers_and_a_chest_with_joints_are_recognised(tmp_path):
    infant = mimo_of(12, body={"hands": "five_finger", "chest_joint": True})
    result = imported(tmp_path, infant, world=WORLD + TARGET)
    assert result.spec["body"] == {"hands": "five_finger", "chest_joint": True}
    assert result.spec["task"] == {"kind": "catch"}
    assert result.spec["age_months"] == 12


def test_limbs_that_it_lacks_are_removed(tmp_path):
    infant = mimo_of()
    for name in ("left_lower_arm", "right_toes"):
        remove(infant, name)
    result = imported(tmp_path, infant)
    assert result.spec["body"] == {"remove": ["left_lower_arm", "right_toes"]}


def test_muscle_groups_without_actuators_take_no_commands(tmp_path):
    infant = mimo_of()
    (actuators,) = infant.findall("actuator")
    for motor in list(actuators):
        if "right" not in motor.get("name") or "eye" in motor.get("name"):
            actuators.remove(motor)
    result = imported(tmp_path, infant)
    assert result.spec["actuation"] == {"regions": ["right_arm", "right_hand", "right_leg"]}
    assert "the scene has no actuator act:hip_bend, " in notes(result)


def test_servos_are_recognised(tmp_path):
    result = imported(tmp_path, mimo_of(actuation={"model": "position"}))
    assert result.spec["actuation"] == {"model": "position"}


def test_part_of_a_group_that_is_locked_is_noted(tmp_path):
    lock = '<equality><joint joint1="robot:left_elbow" polycoef="-.4 0 0 0 0"/></equality>'
    result = imported(tmp_path, sections=lock)
    assert "locked" not in result.spec.get("actuation", {})
    assert "some joints of left_arm are locked; a spec locks whole muscle groups" in notes(result)
    assert b'joint1="robot:left_elbow"' in result.scene("x")["x_scene.xml"]


def test_the_scene_is_as_it_was_but_for_the_infant(tmp_path):
    path = write_scene(
        tmp_path / "source", sections='<sensor><framepos name="hand" objtype="xbody" objname="left_hand"/></sensor>'
    )
    before = mujoco.MjModel.from_xml_path(str(path))
    after = opened(import_config("mimo", path), tmp_path / "made")
    for kind in ("joint", "actuator", "sensor", "camera"):
        count = {"joint": "njnt", "actuator": "nu", "sensor": "nsensor", "camera": "ncam"}[kind]
        extra = set(names(after, kind, getattr(after, count))) ^ set(names(before, kind, getattr(before, count)))
        assert extra <= {"proprio:chest"}
    assert after.nlight == 1
    assert after.opt.density == before.opt.density == 1.2
    assert after.geom("ball").solref.tolist() == [-20000, -20]
    assert after.geom("lb").rgba.tolist() != [0.5, 0.6, 0.7, 1]
    old, new = (mujoco.MjData(model) for model in (before, after))
    mujoco.mj_kinematics(before, old)
    mujoco.mj_kinematics(after, new)
    for name in ("hip", "ball", "left_hand", "head"):
        np.testing.assert_allclose(new.body(name).xpos, old.body(name).xpos, atol=1e-6)
    for _ in range(20):
        mujoco.mj_step(after, new)
    assert not any(warning.number for warning in new.warning)


def test_a_bundle_built_for_mimo_fits_the_scene_as_well(tmp_path):
    """Its infant has a body of its own above the hip."""
    result = imported(tmp_path)
    model = opened(result, tmp_path / "made", "mimo")
    assert model.body("mimo_location").id != model.body("hip").id
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    assert data.body("hip").xpos[2] == pytest.approx(0.4)


def test_an_infant_without_a_free_joint_is_welded_to_what_it_was_fixed_to(tmp_path):
    model = opened(imported(tmp_path, joint=""), tmp_path / "made")
    (weld,) = [index for index in range(model.neq) if model.eq_type[index] == mujoco.mjtEq.mjEQ_WELD]
    assert {model.body(model.eq_obj1id[weld]).name, model.body(model.eq_obj2id[weld]).name} == {"hip", "mimo_location"}
    data = mujoco.MjData(model)
    for _ in range(100):
        mujoco.mj_step(model, data)
    assert data.body("hip").xpos[2] == pytest.approx(0.4, abs=0.01)


@pytest.mark.full
def test_one_file_and_includes_give_the_same(tmp_path):
    """Also where an include is below a body, and names of geoms have the prefix of later scenes."""
    path = write_scene(tmp_path / "parts")
    result = import_config("mimo", path)
    whole = path.read_text()
    for name in ("meta", "model"):
        text = (path.parent / "mimo" / f"{name}.xml").read_text()
        whole = whole.replace(f'<include file="mimo/{name}.xml"/>', re.sub("</?mujoco>", "", text))
    (tmp_path / "nursery.xml").write_text(whole)
    same = import_config("mimo", tmp_path / "nursery.xml")
    with_prefixes(path)
    prefixed = import_config("mimo", path)
    assert 'name="geom:right_hand1"' in (path.parent / "mimo" / "model.xml").read_text()
    for other in (same, prefixed):
        assert other.spec == result.spec
        assert other.scene("a") == result.scene("a")


def test_assets_are_copied_and_those_of_the_infant_are_not(tmp_path):
    """Nor are they read: they need not even exist."""
    for folder in ("mine", "shapes"):
        (tmp_path / "source" / folder).mkdir(parents=True)
        Image.new("RGB", (4, 4), "red").save(tmp_path / "source" / folder / "toy.png")
    tetrahedron = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "source" / "shapes" / "toy.obj").write_text(tetrahedron)
    assets = """<mesh name="toy" file="toy.obj"/>
      <texture name="head" type="2d" file="toy.png"/><texture name="box" type="cube" fileleft="../shapes/toy.png"/>
      <material name="head_of_toy" texture="head"/><material name="box" texture="box"/>"""
    world = """<body name="toy" pos="1 0 0"><geom type="mesh" mesh="toy" material="head_of_toy"/>
      <geom name="skinny" size=".1" material="skin"/></body>"""
    folders = '<compiler texturedir="mine" meshdir="shapes"/>'
    path = write_scene(tmp_path / "source", assets=assets, sections=folders, world=WORLD + world)
    shutil.rmtree(tmp_path / "source" / "pictures")
    result = import_config("mimo", path)
    files = result.scene("kim")
    assert set(files) == {"kim_scene.xml", "kim_assets/toy.png", "kim_assets/toy_2.png", "kim_assets/toy.obj"}
    text = files["kim_scene.xml"].decode()
    assert "face" not in text
    assert 'material="scene_skin"' in text
    assert not re.search("texturedir|meshdir|top_sleeve|" + re.escape(str(tmp_path)), text)
    model = opened(result, tmp_path / "made")
    assert model.nmesh == 1
    np.testing.assert_allclose(model.material("scene_skin").rgba, model.material("skin").rgba, atol=1e-6)


def test_keyframes_are_those_of_the_same_joints(tmp_path):
    infant = mimo_of()
    path = write_scene(tmp_path / "source", infant, world="", joint='<freejoint name="mimo_orientation"/>')
    model = mujoco.MjModel.from_xml_path(str(path))
    qpos = np.arange(model.nq) / 1000
    qpos[3:7] = 0.5
    key = f'<keyframe><key name="odd" qpos="{" ".join(map(str, qpos))}"/></keyframe>'
    result = imported(tmp_path / "source", infant, world="", joint='<freejoint name="mimo_orientation"/>', sections=key)
    made = opened(result, tmp_path / "made")
    assert made.key(0).name == "odd"
    data = mujoco.MjData(made)
    data.qpos[:] = made.key_qpos[0]
    for index in range(model.njnt):
        name, address = model.joint(index).name, model.jnt_qposadr[index]
        value = data.joint("mimo_location" if name == "mimo_orientation" else name).qpos
        np.testing.assert_allclose(value, qpos[address : address + len(value)], atol=1e-8)


def test_what_was_changed_by_hand_is_noted(tmp_path):
    infant = mimo_of()
    body(infant, "left_hand").append(body(mimo_of(), "right_toes"))
    rattle = body(infant, "left_hand")[-1]
    rattle.set("name", "rattle")
    for part in list(rattle.iter()):
        if part.tag in ("joint", "site"):
            rattle.remove(part)
        elif part.tag == "geom":
            part.set("name", f"rattle_{part.get('name')}")
    head = body(infant, "head")
    head.insert(0, head.makeelement("camera", {"name": "selfie", "pos": "1 0 0"}))
    head.insert(0, head.makeelement("joint", {"name": "nod", "axis": "0 1 0", "range": "-1 1"}))
    head.append(head.makeelement("geom", {"name": "hat", "size": ".05", "pos": "0 0 .15", "mass": "0"}))
    head.append(head.makeelement("site", {"name": "badge"}))
    geom = next(part for part in body(infant, "left_lower_leg").iter("geom"))
    geom.set("size", "0.04 0.05")
    geom.set("mass", "2")
    elbow = next(part for part in infant.iter("joint") if part.get("name") == "robot:left_elbow")
    elbow.set("range", "-1 0")
    (actuators,) = infant.findall("actuator")
    actuators[0].set("gear", "99")
    joint = f'{FREE}<camera name="third" pos="-1 0 0"/>'
    sensor = '<sensor><jointpos name="mine" joint="nod"/></sensor>'
    result = imported(tmp_path, infant, joint=joint, sections=sensor)
    said = notes(result)
    for text in (
        "body 'rattle': not taken over: it is on the infant, and no part of MIMo's",
        "camera 'selfie': not taken over: mimoc's infant has no such camera on 'head'",
        "camera 'third': not taken over: it is fixed to 'mimo_location', which mimoc's infant does not have",
        "joint 'nod': not taken over: mimoc's infant has no such joint on 'head'",
        "geom 'hat': not taken over: mimoc's infant has no such geom on 'head'",
        "site 'badge': not taken over: mimoc's infant has no such site on 'head'",
        "jointpos 'mine': not taken over: mimoc's infant has no joint 'nod'",
        "it has the sizes of 9 months by the published law of growth, but for 1 of 36 geoms: largest difference ",
        "masses of bodies differ in 1 of 22, most in left_lower_leg",
        "ranges of joints differ in 1 of 47, most in robot:left_elbow, by ",
        "gears of motors differ in 1 of 44, most in act:hip_bend",
    ):
        assert text in said
    assert "selfie" not in result.scene("x")["x_scene.xml"].decode()
    comments = [line for line in result.text.splitlines() if line.startswith("#   ")]
    assert len(comments) == len(result.notes)
    assert any(line.startswith("#   model.xml, line ") for line in comments)


def test_the_spec_and_the_scene_do_not_depend_on_where_they_were(tmp_path):
    first, second = (imported(tmp_path / name) for name in ("here", "there"))
    assert first.text == second.text
    assert first.scene("kim") == second.scene("kim")


# Bad scenes.


def refused(path: Path) -> str:
    with pytest.raises(SpecError) as caught:
        import_config("mimo", path)
    return str(caught.value)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"name: kim\n", "1:1: this is not XML (syntax error)"),
        (b"", "1:1: this is not XML (no element found)"),
        (b"<mujoco><body></mujoco>", "1:1: this is not XML (mismatched tag)"),
        (b"\x89PNG\r\n\x00\x00", "1:1: this is a binary file; give the MJCF (XML) of a scene"),
        (b"<robot name='x'/>", "1:1: this is not MJCF: it begins with <robot>, not with <mujoco>"),
        (b"<mujoco>\n<worldbody><geom size='1'/></worldbody></mujoco>", "1:1: there is no MIMo in it"),
        (
            b"<mujoco>\n<include file='a.xml'/>\n<include file='b.xml'/></mujoco>",
            "include: 'SOURCE/b.xml' does not exist",
        ),
        (b"<mujoco><include/></mujoco>", "1:1: include: '' names no file"),
        (b"<mujoco>\n<include file='nursery.xml'/></mujoco>", "2:1: include: 'nursery.xml' is included a second time"),
        (
            b"<!DOCTYPE x [<!ENTITY a 'b'>]><mujoco>&a;</mujoco>",
            "it declares a document type, which MJCF does not have",
        ),
        (b"<mujoco>" + 70 * b"<body>" + 70 * b"</body>" + b"</mujoco>", "or 64 within each other"),
        (b"<mujoco>" + 20_001 * b"<geom/>" + b"</mujoco>", "more than 20,000 elements"),
        (b"<?xml version='1.0' encoding='klingon'?><mujoco/>", "this "),
    ],
)
def test_what_is_no_scene_is_refused(tmp_path, content, said):
    (tmp_path / "nursery.xml").write_bytes(content)
    message = refused(tmp_path / "nursery.xml")
    assert said.replace("SOURCE", str(tmp_path)) in message
    assert all(line.startswith(f"{tmp_path}/nursery.xml:") for line in message.splitlines())


def test_files_that_include_each_other_are_refused(tmp_path):
    (tmp_path / "a.xml").write_text('<mujoco><include file="b.xml"/></mujoco>')
    (tmp_path / "b.xml").write_text('<mujoco>\n<include file="a.xml"/></mujoco>')
    assert refused(tmp_path / "a.xml").startswith(f"{tmp_path}/b.xml:2:1: include: 'a.xml' is included a second time")


def test_a_link_is_not_followed(tmp_path):
    path = write_scene(tmp_path / "source")
    meta = path.parent / "mimo" / "meta.xml"
    meta.rename(tmp_path / "meta.xml")
    meta.symlink_to(tmp_path / "meta.xml")
    assert "is a link, which mimoc does not follow; put the file itself in its place" in refused(path)


@pytest.mark.full
def test_a_missing_picture_is_refused_with_its_line(tmp_path):
    path = write_scene(tmp_path, assets='<texture name="mine" type="2d" file="mine.png"/>')
    line = next(number for number, text in enumerate(path.read_text().splitlines(), 1) if "mine.png" in text)
    assert f"nursery.xml:{line}:1: texture 'mine': the file '{tmp_path}/mine.png' does not exist" in refused(path)


def test_a_scene_that_attaches_models_is_refused(tmp_path):
    path = write_scene(tmp_path, assets='<model name="cot" file="cot.xml"/>')
    assert "model 'cot': attaches another model; include its parts" in refused(path)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"world": WORLD + '<replicate count="100000"><geom size=".1"/></replicate>'}, "count is 100,000"),
        (
            {
                "world": WORLD
                + '<replicate count="300"><replicate count="300"><geom size=".1"/></replicate></replicate>'
            },
            "<geom>, copies included; at most 2,048",
        ),
        ({"world": WORLD + '<body><composite type="cable" count="900 1 1"/></body>'}, "<body>, copies included"),
        ({"world": WORLD + '<flexcomp name="f" type="grid" count="20 20 20"/>'}, "<body>, copies included"),
        ({"world": WORLD + '<flexcomp name="f" type="mesh" file="x.obj"/>'}, "a flexible body of a file"),
        ({"timestep": "0"}, "timestep is 0; give 0.0001 to 1 s"),
        ({"timestep": "nan"}, "timestep is no number"),
        ({"timestep": "1e-12"}, "timestep is 1e-12"),
        ({"pos": "inf 0 0"}, "pos is no number"),
        ({"gravity": "0 0 -1e300"}, "gravity is no number"),
        ({"assets": '<hfield name="h" nrow="60000" ncol="60000" size="1 1 1 1"/>'}, "more than 1,048,576 samples"),
        ({"assets": '<texture name="t" type="2d" builtin="flat" width="60000" height="8"/>'}, "width is 60,000"),
        ({"sections": '<size memory="900G"/>'}, "memory is above 1 GB"),
        ({"sections": '<size nuser_body="2000000000"/>'}, "nuser_body is 2,000,000,000"),
        ({"sections": '<option iterations="2000000000"/>'}, "iterations is 2,000,000,000; give 1,000"),
        ({"sections": "<keyframe>" + "<key/>" * 5000 + "</keyframe>"}, "5,000 <key>"),
        ({"sections": '<extension><plugin plugin="mujoco.pid"/></extension>'}, "does not load"),
        ({"sections": '<compiler><lengthrange inttotal="1e9"/></compiler>'}, "simulates too many steps"),
    ],
)
def test_what_would_take_too_long_or_is_no_number_is_refused(tmp_path, parts, said):
    """MuJoCo would make bodies for ever, ask for all memory, or give poses that are no numbers."""
    with pytest.raises(SpecError) as refused:
        imported(tmp_path, **parts)
    assert said in str(refused.value)
    assert re.match(r".*nursery\.xml:\d+:1: ", str(refused.value))


def test_a_few_copies_are_no_obstacle(tmp_path):
    boxes = '<replicate count="3" offset=".3 0 0"><geom type="box" size=".1 .1 .1" pos="1 1 .1"/></replicate>'
    assert imported(tmp_path, world=WORLD + boxes).spec["age_months"] == 9


@pytest.mark.full
def test_a_picture_of_other_programs_is_read_and_one_that_unpacks_to_more_is_refused(tmp_path):
    """Other programs write 16 bits a channel, interlaced rows and texts; a few kilobytes can unpack to gigabytes."""
    texture = '<texture name="t" type="2d" file="t.png"/>'
    tmp_path.joinpath("t.png").write_bytes(png(64, 64, b"\0" * 64 * 129, depth=16, colour=0, text=b"Title\0of mine"))
    assert imported(tmp_path, assets=texture).spec["age_months"] == 9
    tmp_path.joinpath("t.png").write_bytes(png(8, 8, b"\0" * 200_000_000, depth=8, colour=0))
    with pytest.raises(SpecError, match=r"texture 't': the file .*t\.png.* it has not as many pixels as it says"):
        imported(tmp_path, assets=texture)


def png(width: int, height: int, rows: bytes, depth: int, colour: int, text: bytes = b"") -> bytes:
    """Return a PNG of any rows, whether they fit its size or not, and a text."""
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))]
    chunks += [(b"tEXt", text)] * bool(text) + [(b"IDAT", zlib.compress(rows, 9)), (b"IEND", b"")]
    parts = [
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def test_what_mujoco_refuses_is_refused_with_its_line(tmp_path):
    path = write_scene(tmp_path, world='<geom size=".1" material="nothing"/>')
    line = next(number for number, text in enumerate(path.read_text().splitlines(), 1) if "nothing" in text)
    message = refused(path)
    assert message.startswith(f"{path}:{line}:1: geom: MuJoCo {mujoco.__version__} rejects this scene")
    assert "\n" not in message


@pytest.mark.parametrize(
    ("gone", "added", "said"),
    [
        ("head", "", "body 'hip': this MIMo has no head, without which no infant can be"),
        ("left_fingers", "left_hook", "body 'left_hand': an unknown hand: of its fingers (left_hook), none is MIMo's"),
        (
            "left_fingers",
            "left_ffknuckle",
            "body 'left_hand': it has other fingers than the rest of this MIMo, whose hands are 'mitten'",
        ),
    ],
)
def test_a_mimo_that_is_none_is_refused(tmp_path, gone, added, said):
    infant = mimo_of()
    remove(infant, gone)
    if added:
        hand = body(infant, "left_hand")
        finger = hand.makeelement("body", {"name": added, "pos": "0 0 .05"})
        finger.append(hand.makeelement("geom", {"size": ".01", "type": "sphere", "mass": ".01"}))
        hand.append(finger)
    assert said in refused(write_scene(tmp_path, infant))


# The command.


def test_the_command_writes_a_spec_and_a_scene_and_nothing_else(tmp_path, monkeypatch, invoke):
    path = write_scene(tmp_path / "source")
    before = {file: file.read_bytes() for file in sorted(tmp_path.rglob("*")) if file.is_file()}
    (tmp_path / "made").mkdir()
    monkeypatch.chdir(tmp_path / "made")
    done = invoke("import", "mimo", path, "-o", "kim.yaml")
    assert done.code == 0
    assert sorted(file.name for file in Path().iterdir()) == ["kim.yaml", "kim_scene.xml"]
    assert {file: file.read_bytes() for file in sorted((tmp_path / "source").rglob("*")) if file.is_file()} == before
    assert done.out.splitlines()[-2:] == [
        "kim.yaml: try it with: mimoc build kim.yaml -o out/nursery",
        "kim_scene.xml: the scene, which takes its infant from out/nursery; open it with MuJoCo",
    ]
    assert invoke("build", "kim.yaml", "-o", "out/nursery").code == 0
    assert mujoco.MjModel.from_xml_path("kim_scene.xml").nu == 44


@pytest.mark.full
def test_the_command_replaces_nothing_unasked_and_never_its_source(tmp_path, monkeypatch, invoke):
    path = write_scene(tmp_path)
    monkeypatch.chdir(tmp_path)
    Path("kim_scene.xml").write_text("mine")
    refusal = invoke("import", "mimo", path, "-o", "kim.yaml")
    assert (refusal.code, Path("kim.yaml").exists()) == (2, False)
    assert "kim_scene.xml: already exists; choose another file, or replace it with --force" in refusal.err
    assert invoke("import", "mimo", path, "-o", "kim.yaml", "--force").code == 0
    assert Path("kim_scene.xml").read_text() != "mine"
    path.rename("own_scene.xml")
    for name in ("own.yaml", "mimo/meta.xml"):
        refusal = invoke("import", "mimo", "own_scene.xml", "-o", name, "--force")
        assert refusal.code == 2
        assert "choose another file" in refusal.err


def test_the_page_on_scenes_is_right(tmp_path, monkeypatch, invoke):
    write_scene(tmp_path)
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert [language for language, _ in blocks] == ["sh", "sh", "python"]
    session: dict = {}
    for language, text in blocks:
        if language == "python":
            exec(text, session)
        else:
            program, *arguments = shlex.split(text)
            assert (program, invoke(*arguments).code) == ("mimoc", 0)
    assert session["data"].time > 0.4


def test_standard_output_gets_the_spec_alone(tmp_path, monkeypatch, invoke):
    path = write_scene(tmp_path / "source")
    monkeypatch.chdir(tmp_path)
    done = invoke("import", "mimo", path, "-o", "-")
    assert (done.code, done.out) == (0, import_config("mimo", path).text)
    assert "the rest of the scene is not written; for that, give a file" in done.err
    assert [file.name for file in tmp_path.iterdir()] == ["source"]
