"""A build is a pure function of the spec, and what the runtime is told is what the compiled model has."""

import json
import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import mujoco
import pytest
import yaml
from lxml import etree
from PIL import Image
from support import store

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import ModelError
from mimoc.body.grow import grow_tree
from mimoc.body.kinematics import stature
from mimoc.bundle.manifest import Manifest, to_data
from mimoc.compiler import building
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.provenance import who_percentiles
from mimoc.fits import measure
from mimoc.schema import InfantSpec

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))
FILES = {"infant.xml", "scene.xml", "spec.yaml", "resolved.yaml", "provenance.json", "manifest.json", "lock.json"}

PRINT_LOCK = """
import sys, mimoc
sys.stdout.write(mimoc.build(mimoc.load_spec(sys.argv[1])).files["lock.json"].decode())
"""

SURROUNDINGS = {
    "hash seed, ASCII locale": {"PYTHONHASHSEED": "1", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "another hash seed, time zone and locale with commas": {
        "PYTHONHASHSEED": "4242",
        "TZ": "Pacific/Kiritimati",
        "LANG": "de_DE.UTF-8",
        "LC_ALL": "tr_TR.UTF-8",
    },
}

NAMELESS = {"mujoco", "compiler", "option", "size", "flag", "default", "include", "statistic", "visual"} | {
    "asset", "worldbody", "deformable", "contact", "tendon", "actuator", "sensor", "keyframe", "equality"
}  # fmt: skip
"""Sections of MJCF, which are one of a kind."""


@pytest.fixture(scope="module", params=CONFIGS, ids=lambda path: path.stem)
def config(request) -> Path:
    return request.param


@pytest.fixture(scope="module")
def built(config) -> mimoc.Bundle:
    return store.built(config)


def test_the_files_are_those_of_a_bundle(built):
    arrays = {"arrays.npz"} if built.manifest.senses.touch or built.manifest.face.shapes else set()
    assert {name for name in built.files if not name.startswith("assets/")} == FILES | {"README.md"} | arrays
    assert list(built.files) == sorted(built.files)


@pytest.mark.full
@pytest.mark.parametrize("case", SURROUNDINGS)
def test_surroundings_do_not_matter(case, tmp_path):
    """Another process, working directory, environment and file time: the lock has the digest of every file."""
    spec = tmp_path / "elsewhere" / "nine.yaml"
    spec.parent.mkdir()
    spec.write_bytes((CONFIGS[0].parent / "nine_months.yaml").read_bytes())
    os.utime(spec, (1e9, 1e9))
    environment = {**os.environ, **SURROUNDINGS[case]}
    command = [sys.executable, "-c", PRINT_LOCK, "elsewhere/nine.yaml"]
    printed = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True).stdout
    assert printed == mimoc.build(mimoc.load_spec(spec)).files["lock.json"]


def test_building_leaves_nothing_behind(tmp_path, monkeypatch):
    """Not even for the next infant: what was built before does not matter."""
    monkeypatch.chdir(tmp_path)
    first = mimoc.build(spec_of(age_months=9)).files
    mimoc.build(spec_of(age_months=24, body={"expression": "sad"}))
    assert mimoc.build(spec_of(age_months=9)).files == first
    assert not list(tmp_path.iterdir())


def spec_of(**sections) -> InfantSpec:
    return InfantSpec.model_validate({"mimoc": 1, "name": "x", **sections})


@pytest.mark.parametrize(
    "written",
    [
        b"mimoc: 1\r\nname: x\r\nage_months: 9  # CRLF\r\n",
        b"\xef\xbb\xbfmimoc: 1\nname: x\nage_months: 9\n",
        "# Zoë's brother 👶\nmimoc: 1\nname: x\nage_months: 9".encode(),
        b"\n\n  \nmimoc: 1\nname: x\nage_months: 9\n...\n",
    ],
)
def test_the_spec_in_the_bundle_is_the_file_to_the_byte(written, tmp_path):
    (tmp_path / "x.yaml").write_bytes(written)
    assert mimoc.build(mimoc.load_spec(tmp_path / "x.yaml")).files["spec.yaml"] == written


def test_a_spec_from_python_has_a_file_too(tmp_path):
    spec = spec_of(age_months=4.5, scene={"pose": "prone"})
    (tmp_path / "spec.yaml").write_bytes(mimoc.build(spec).files["spec.yaml"])
    assert mimoc.load_spec(tmp_path / "spec.yaml") == spec


def test_the_same_spec_gives_the_same_bytes_also_the_one_in_the_bundle(built, tmp_path):
    (tmp_path / "spec.yaml").write_bytes(built.files["spec.yaml"])
    assert mimoc.build(mimoc.load_spec(tmp_path / "spec.yaml")).files == built.files


def test_the_resolved_spec_says_the_same_with_nothing_left_out(config, built, tmp_path):
    (tmp_path / "resolved.yaml").write_bytes(built.files["resolved.yaml"])
    assert mimoc.load_spec(tmp_path / "resolved.yaml") == mimoc.load_spec(config)
    sections = yaml.safe_load(built.files["resolved.yaml"])
    assert sections["control"] == mimoc.load_spec(config).control.model_dump()


def test_no_file_tells_where_or_when_it_was_made(config, built):
    places = [str(Path.cwd()), str(Path.home()), str(config.parent), "/tmp", os.uname().nodename]
    for name, content in built.files.items():
        text = content.decode(errors="ignore")
        assert not [place for place in places if len(place) > 3 and place in text], name
        assert not re.search(r"20\d\d-\d\d-\d\d|\d\d:\d\d:\d\d", text), name
        assert b"tIME" not in content, name
        assert b"tEXt" not in content, name


def test_every_element_has_a_name_of_its_own(built):
    """So that MuJoCo's errors can be traced; but for sections, defaults, and what a tendon passes."""
    for file in ("infant.xml", "scene.xml"):
        names: Counter[tuple[str, str]] = Counter()
        for element in etree.fromstring(built.files[file]).iter():
            above = {ancestor.tag for ancestor in element.iterancestors()}
            if element.tag in NAMELESS or above & {"default", "visual", "fixed", "spatial"}:
                continue
            kind = "joint" if element.tag == "freejoint" else "equality" if "equality" in above else element.tag
            names[kind, element.get("name", "")] += 1
        assert not [key for key in names if not key[1]]
        assert set(names.values()) == {1}


def test_every_line_has_one_element(built):
    for file in ("infant.xml", "scene.xml"):
        for line in built.files[file].decode().splitlines():
            assert len(re.findall(r"<\w", line)) <= 1, line


def test_only_assets_that_are_used_are_there_and_they_are_small(built, tmp_path):
    xml = (built.files["infant.xml"] + built.files["scene.xml"]).decode()
    used = set(re.findall(r'file="(assets/[^"]+)"', xml))
    assert used == {name for name in built.files if name.startswith("assets/")}
    for name in (name for name in used if name.endswith(".png")):
        (tmp_path / "picture.png").write_bytes(built.files[name])
        with Image.open(tmp_path / "picture.png") as picture:
            assert max(picture.size) <= 512, name


def test_what_mujoco_changed_between_versions_is_not_in_the_files(built):
    """See design.md section 6: their meaning differs between MuJoCo 3.5 and 4.0, but for the margin of joints."""
    text = (built.files["infant.xml"] + built.files["scene.xml"]).decode()
    text = re.sub(r"(<joint [^>]*) margin=", r"\1 ", text)
    assert not re.search(r"\b(margin|gap|dampratio|settotalmass|composite|fileup|scale)=", text)
    assert re.search('multiccd="(disable|enable)"', text)
    assert 'active="1"' in text
    model = compile_model(built.files)
    hinges = model.jnt_dofadr[model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE]
    assert model.dof_armature[hinges].min() > 0


def broken(files, name: str, attribute: str, value: str) -> dict[str, bytes]:
    """Return files with one attribute of the infant changed, wherever it is printed."""
    changed = dict(files)
    for file in {"infant.xml", "scene.xml"} & files.keys():
        tree = etree.fromstring(files[file])
        for element in tree.xpath(f"//*[@name='{name}' and @{attribute}]"):
            element.set(attribute, value)
        changed[file] = etree.tostring(tree)
    assert changed != files
    return changed


@pytest.mark.parametrize(
    ("name", "attribute", "value"),
    [
        ("left_hand1", "size", "-1 1 1"),
        ("robot:left_elbow", "range", "1 -1"),
        ("act:left_elbow", "forcerange", "1 -1"),
        ("lb", "material", "no_such_material"),
        ("act:left_knee", "joint", "no_such_joint"),
    ],
)
def test_a_refusal_of_mujoco_names_the_element(bundle_at, name, attribute, value):
    with pytest.raises(ModelError, match="MuJoCo rejects the model") as refusal:
        compile_model(broken(bundle_at(9).files, name, attribute, value))
    assert refusal.value.element == name


@pytest.fixture
def no_left_hand(monkeypatch):
    """Let every hand be written with a size that MuJoCo refuses."""
    render = building.printing.render_inhabitant

    def spoil(tree):
        return broken({"infant.xml": render(tree)}, "left_hand1", "size", "-1 1 1")["infant.xml"]

    monkeypatch.setattr(building.printing, "render_inhabitant", spoil)


def test_a_refusal_of_mujoco_leads_back_to_the_spec(no_left_hand, tmp_path):
    (tmp_path / "x.yaml").write_text("mimoc: 1\nname: x\nage_months: 9\n")
    with pytest.raises(ModelError) as refusal:
        mimoc.build(mimoc.load_spec(tmp_path / "x.yaml"))
    assert str(refusal.value).startswith(f"{tmp_path / 'x.yaml'}:3:")
    assert "age_months: 'left_hand1' follows from this, and MuJoCo rejects the model: " in str(refusal.value)


def test_a_spec_from_python_is_led_back_to_as_well(no_left_hand):
    with pytest.raises(ModelError, match=r"^<x>: age_months: 'left_hand1' follows"):
        mimoc.build(spec_of(age_months=9))


def test_the_average_child_stands_in_the_middle_of_whos(bundle_at):
    """And at birth WHO has no standard for the arm."""
    assert who_percentiles(bundle_at(0).manifest.child).keys() == {
        "length_cm",
        "weight_kg",
        "head_circumference_cm",
    }
    for age_months in (0, 3, 12, 24):
        found = who_percentiles(bundle_at(age_months).manifest.child)
        assert all(15 < found[key] < 85 for key in found if key != "arm_circumference_cm"), age_months


def manifest_of(**sections) -> Manifest:
    return store.built({"mimoc": 1, "name": "x", "age_months": 9, **sections}).manifest


def test_the_manifest_in_memory_is_the_one_in_the_file(bundle_at):
    bundle = bundle_at(9)
    assert Manifest.model_validate_json(bundle.files["manifest.json"]) == bundle.manifest
    assert json.loads(bundle.files["manifest.json"]) == json.loads(json.dumps(to_data(bundle.manifest)))


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_names_are_those_of_the_compiled_model_in_its_order(bundle_at, infant_at, age_months, hands_and_chest):
    manifest, model = bundle_at(age_months, *hands_and_chest).manifest, infant_at(age_months, *hands_and_chest).model
    assert manifest.root_body == model.body(1).name
    assert manifest.root_joint == model.joint(0).name
    assert list(manifest.poses) == [model.key(index).name for index in range(model.nkey)]
    actuators = manifest.actuation.actuators
    assert [actuator.name for actuator in actuators] == [model.actuator(index).name for index in range(model.nu)]
    for actuator in actuators:
        compiled = model.actuator(actuator.name)
        assert model.joint(compiled.trnid[0]).name == actuator.joint
        assert [actuator.action_low, actuator.action_high] == list(compiled.ctrlrange)
    senses = manifest.senses
    assert list(senses.proprioception.joints) == [model.joint(index).name for index in range(1, model.njnt)]
    for sensor in (*senses.proprioception.torque_sensors, senses.vestibular.accelerometer, senses.vestibular.gyro):
        assert model.sensor(sensor).dim[0] == 3


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_the_child_is_the_body_as_measured(bundle_at, age_months):
    child = bundle_at(age_months).manifest.child
    found = stature(grow_tree(measure(age_months), assemble("mitten", False)))
    assert child.age_months == age_months
    assert child.model_dump(exclude={"age_months", "sex", "clothes"}) == pytest.approx(dict(found), rel=1e-8)


def test_the_clock_and_the_pose_are_the_specs():
    manifest = manifest_of(control={"step_ms": 20, "timestep_ms": 2.5}, scene={"pose": "sitting"})
    assert (manifest.step_ms, manifest.timestep_ms, manifest.pose) == (20, 2.5, "sitting")


def test_a_sense_that_is_not_named_is_off():
    senses = manifest_of(senses={"vestibular": {}}).senses
    assert senses.proprioception is None
    assert senses.vestibular is not None


def test_proprioception_includes_what_was_asked_for_in_that_order():
    senses = manifest_of(senses={"proprioception": {"include": ["limits", "velocity"]}}).senses
    assert senses.proprioception.include == ("limits", "velocity")


def test_the_timestep_is_the_models():
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "control": {"step_ms": 20, "timestep_ms": 2.5}}
    files = store.built(spec).files
    assert mujoco.MjModel.from_xml_string(files["infant.xml"].decode(), dict(files)).opt.timestep == 0.0025
