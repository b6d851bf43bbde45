"""Bundles made to do harm: every way that was ever found, small, by code.

Each changes the files of an honest bundle, which are sealed anew afterwards. `CRAFTED` says what mimoc answers.
"""

import json
import os
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

Files = dict[str, bytes]
Craft = Callable[[Files, Path], None]
"""Changes the files of a bundle; the path is a folder outside of it, with canaries."""


def _xml(name: str, old: str, new: str, count: int = 1) -> Craft:
    def craft(files: Files, outside: Path) -> None:
        text = files[name].decode()
        assert old in text, old
        files[name] = text.replace(old, new.replace("{outside}", str(outside)), count).encode()

    return craft


def _in_scene(element: str) -> Craft:
    return _xml("scene.xml", "<worldbody>", f"<worldbody>{element}")


def _in_assets(element: str) -> Craft:
    return _xml("scene.xml", "<asset>", f"<asset>{element}")


def _at_root(element: str) -> Craft:
    return _xml("scene.xml", "<asset>", f"{element}<asset>")


def _manifest(*changes: tuple[str, Any]) -> Craft:
    """Return what sets some keys of the manifest, such as `actuation.actuators.0.name`."""

    def craft(files: Files, outside: Path) -> None:
        data = json.loads(files["manifest.json"])
        for path, value in changes:
            inside, (*way, last) = data, path.split(".")
            for key in way:
                inside = inside[int(key)] if isinstance(inside, list) else inside[key]
            inside[int(last) if isinstance(inside, list) else last] = value
        files["manifest.json"] = json.dumps(data).encode()

    return craft


def _replaced(name: str, content: Callable[[bytes], bytes]) -> Craft:
    def craft(files: Files, outside: Path) -> None:
        files[name] = content(files[name])

    return craft


def _added(name: str, content: bytes, then: Craft) -> Craft:
    def craft(files: Files, outside: Path) -> None:
        files[name] = content
        then(files, outside)

    return craft


def png(width: int, height: int, data: bytes, *chunks: tuple[bytes, bytes]) -> bytes:
    """Return a PNG that says it is of some size, of 8 bits of grey, with any compressed data."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    parts = [(b"IHDR", header), *chunks, (b"IDAT", zlib.compress(data, 9)), (b"IEND", b"")]
    packed = (struct.pack(">I", len(body)) + kind + body + _crc(kind + body) for kind, body in parts)
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)


def _crc(data: bytes) -> bytes:
    return struct.pack(">I", zlib.crc32(data))


def _with_integer(offset: int, value: int) -> Callable[[bytes], bytes]:
    return lambda content: content[:offset] + struct.pack("<i", value) + content[offset + 4 :]


def _integer(content: bytes, offset: int) -> int:
    return struct.unpack_from("<i", content, offset)[0]


def _heavy_bone(content: bytes) -> bytes:
    """Return a skin whose first bone says that it moves a billion vertices: their bytes are no 32-bit number."""
    verts, texcoords, faces, _ = struct.unpack_from("<4i", content)
    return _with_integer(16 + 12 * verts + 8 * texcoords + 12 * faces + 40 + 28, 10**9)(content)


def _deep(files: Files, outside: Path) -> None:
    files["scene.xml"] = b"<mujoco>" + b"<worldbody><body>" * 50_000 + b"</body></worldbody>" * 50_000 + b"</mujoco>"


def _laughs(files: Files, outside: Path) -> None:
    entities = "".join(f'<!ENTITY a{n + 1} "{f"&a{n};" * 10}">' for n in range(9))
    files["scene.xml"] = f'<!DOCTYPE m [<!ENTITY a0 "ha">{entities}]><mujoco model="&a9;"/>'.encode()


def _entity(files: Files, outside: Path) -> None:
    head = f'<!DOCTYPE m [<!ENTITY x SYSTEM "file://{outside}/canary.xml">]>'
    files["scene.xml"] = head.encode() + files["scene.xml"].replace(b"<worldbody>", b"<worldbody>&x;")


def _pile(files: Files, outside: Path) -> None:
    _in_scene("".join(f'<geom name="g{n}" type="sphere" size="1"/>' for n in range(1000)))(files, outside)


def _many_geoms(files: Files, outside: Path) -> None:
    geoms = "".join(f'<geom name="g{n}" type="sphere" size="1" pos="0 0 1"/>' for n in range(100_000))
    _in_scene(geoms)(files, outside)


NEW_FACE = _xml("infant.xml", 'file="assets/stripes.png"', 'file="assets/new.png"')
EYE = "assets/eye.png"
ELEMENT = "is not an element that mimoc writes"
NOT_THERE = "is not what mimoc writes there"

CRAFTED: dict[str, tuple[Craft, str]] = {
    # What reads other files.
    "include of an absolute path": (_at_root('<include file="{outside}/canary.xml"/>'), NOT_THERE),
    "include of a path above": (_at_root('<include file="../canary.xml"/>'), NOT_THERE),
    "include of itself": (_at_root('<include file="scene.xml"/>'), NOT_THERE),
    "include of the infant twice": (_at_root('<include file="infant.xml"/>' * 2), "2 times <include>"),
    "include of an infant that is there already": (_at_root('<include file="infant.xml"/>'), "repeated default class"),
    "include in the infant": (
        _xml("infant.xml", "<asset>", '<include file="infant.xml"/><asset>'),
        "only scene.xml may include infant.xml",
    ),
    "no infant": (_xml("scene.xml", "worldbody>", "asset>", 2), "Schema violation"),
    "a texture of an absolute path": (
        _xml("infant.xml", 'file="assets/stripes.png"', 'file="{outside}/canary.png"'),
        NOT_THERE,
    ),
    "a texture of a path above": (
        _xml("infant.xml", 'file="assets/stripes.png"', 'file="assets/../../outside/canary.png"'),
        NOT_THERE,
    ),
    "a texture that is not in the bundle": (NEW_FACE, "it is not among the files of the bundle"),
    "a texture in six files": (
        _in_assets('<texture name="six" type="cube" fileright="{outside}/canary.png"/>'),
        "'fileright' is not an attribute",
    ),
    "a mesh of an absolute path": (_in_assets('<mesh name="m" file="{outside}/canary.obj"/>'), NOT_THERE),
    "a mesh with a plug-in": (_in_assets('<mesh name="m"><plugin plugin="mujoco.sdf.bolt"/></mesh>'), ELEMENT),
    "a skin of an absolute path": (
        _xml("scene.xml", 'file="assets/head.skn"', 'file="{outside}/canary.skn"'),
        NOT_THERE,
    ),
    "a height field of a file": (_in_assets('<hfield name="h" file="{outside}/canary.png" size="1 1 1 1"/>'), ELEMENT),
    "a model that is attached": (_in_assets('<model name="m" file="{outside}/canary.xml"/>'), ELEMENT),
    "a folder for textures": (
        _xml("infant.xml", 'texturedir="."', 'texturedir="{outside}"'),
        NOT_THERE,
    ),
    "a folder for all assets": (
        _xml("infant.xml", 'meshdir="."', 'meshdir="." assetdir="{outside}"'),
        "'assetdir' is not an attribute",
    ),
    "an external entity": (_entity, "mimoc writes nothing but elements"),
    "a numbered character in a path": (
        _xml("infant.xml", 'file="assets/stripes.png"', 'file="&#47;etc/hostname"'),
        "mimoc writes nothing but elements",
    ),
    # What runs something.
    "a plug-in of MuJoCo's": (_at_root('<extension><plugin plugin="mujoco.pid"/></extension>'), ELEMENT),
    "a sensor with a plug-in": (
        _xml("infant.xml", "<sensor>", '<sensor><plugin name="p" plugin="mujoco.sensor.touch_grid"/>'),
        ELEMENT,
    ),
    "a plug-in that is not here": (
        _manifest(("plugins", {"senses.sound": "os"})),
        "this bundle needs the sense 'sound'",
    ),
    "a sense by a module's path": (
        _manifest(("plugins", {"senses.os.system": "x"})),
        "in a way that mimoc never writes",
    ),
    # What exhausts.
    "a body 30,000 times": (_in_scene('<replicate count="30000"><body name="b"/></replicate>'), ELEMENT),
    "a composite": (_in_scene('<composite type="cable" count="30000 1 1"/>'), ELEMENT),
    "a flexible grid": (_in_scene('<flexcomp name="f" type="grid" count="900 900 900" spacing="1 1 1"/>'), ELEMENT),
    "a height field of 40,000 x 40,000": (
        _in_assets('<hfield name="h" nrow="40000" ncol="40000" size="1 1 1 1"/>'),
        ELEMENT,
    ),
    "a texture of 30,000 x 30,000": (
        _in_assets('<texture name="t" type="2d" builtin="flat" width="30000" height="30000"/>'),
        NOT_THERE,
    ),
    "a picture that says it is huge": (_added("assets/new.png", png(30_000, 30_000, b""), NEW_FACE), "30,000 x 30,000"),
    "a picture that unpacks to 200 MB": (
        _added("assets/new.png", png(8, 8, bytes(200_000_000)), NEW_FACE),
        "it has not as many pixels as it says",
    ),
    "a picture with a bomb beside it": (
        _added("assets/new.png", png(8, 8, bytes(72), (b"zTXt", b"a\0\0" + zlib.compress(bytes(10**7)))), NEW_FACE),
        "not a PNG as mimoc writes it",
    ),
    "a picture cut short": (_replaced(EYE, lambda content: content[:100]), "damaged, or not a PNG"),
    "a picture that is text": (_replaced(EYE, lambda _: b"GIF89a" * 20), "it is not a PNG"),
    "an arena of 1 TB": (_xml("infant.xml", "<size ", '<size memory="1T" '), "'memory' is not an attribute"),
    "ten million constraints": (_xml("infant.xml", "<size ", '<size njmax="10000000" '), "'njmax' is not an attribute"),
    "ten billion iterations": (_xml("infant.xml", 'iterations="100"', 'iterations="9999999999"'), NOT_THERE),
    "a muscle whose length is unknown": (
        _xml("infant.xml", 'gaintype="fixed"', 'gaintype="muscle"'),
        "a muscle without a lengthrange",
    ),
    "a buffer of a billion samples": (
        _xml("infant.xml", '<general name="act:', '<general nsample="1000000000" name="act:'),
        "'nsample' is not an attribute",
    ),
    "100,000 geoms in one place": (_many_geoms, "100,"),
    "a thousand balls around the infant": (_pile, "contacts at the start"),
    "50,000 bodies within each other": (_deep, "more than 64 elements within each other"),
    "a billion laughs": (_laughs, "mimoc writes nothing but elements"),
    "9 MB of blanks": (_replaced("scene.xml", lambda content: content + b" " * 9_000_000), "more than 8 MB"),
    "no XML": (_replaced("scene.xml", lambda content: content[: len(content) // 2]), "it is not XML"),
    "no text": (_replaced("infant.xml", lambda content: content.replace(b"hip", b"h\xff\xfe")), "it is not XML"),
    "a NUL": (_replaced("infant.xml", lambda content: content.replace(b"hip", b"h\0p")), "it is not XML"),
    "text between elements": (_at_root("hello"), "mimoc writes nothing but elements"),
    "a number that is infinite": (_xml("scene.xml", 'gravity="0 0 -9.81"', 'gravity="0 0 -1e300"'), NOT_THERE),
    "a number that is none": (_xml("scene.xml", 'gravity="0 0 -9.81"', 'gravity="0 0 nan"'), NOT_THERE),
    "a skin that refers to other vertices": (
        _replaced("assets/head.skn", lambda content: _with_integer(16 + 20 * _integer(content, 0), 10**6)(content)),
        "it refers to vertices that it does not have",
    ),
    "a skin of a billion vertices": (_replaced("assets/head.skn", _with_integer(0, 10**9)), "its sizes are not those"),
    "a bone of a billion vertices": (_replaced("assets/head.skn", _heavy_bone), "it is longer or shorter than it says"),
    "a skin of -1 bones": (_replaced("assets/head.skn", _with_integer(12, -1)), "its sizes are not those"),
    "a skin cut short": (
        _replaced("assets/head.skn", lambda content: content[:5000]),
        "longer or shorter than it says",
    ),
    "an empty skin": (_replaced("assets/head.skn", lambda _: b""), "it is not a skin"),
    # What the manifest says.
    "a physics step of 1e-300 ms": (_manifest(("timestep_ms", 1e-300)), "timestep_ms: Input should be greater"),
    "no poses": (_manifest(("poses", [])), "is none of the poses"),
    "a control step of 0 ms": (_manifest(("step_ms", 0)), "step_ms: Input should be greater"),
    "a control step of 1e308 ms": (_manifest(("step_ms", 1e308)), "step_ms: Input should be less"),
    "a control step of NaN": (_manifest(("step_ms", float("nan"))), "step_ms: Input should be"),
    "a control step of half a physics step": (_manifest(("step_ms", 2.5)), "2.5 ms is 0.50 steps of 5 ms"),
    "another physics step than the model's": (_manifest(("timestep_ms", 2.5)), "the physics step of the model is 5 ms"),
    "a delay of 1e12 ms": (_manifest(("delays.touch", {"ms": 1e12})), "delays.touch.ms: Input should be less"),
    "a delay of a part of a step": (_manifest(("delays.touch", {"ms": 7.3})), "delays.touch.ms: 7.3 ms is 1.46 steps"),
    "a delay of -5 ms": (_manifest(("delays.motor", {"ms": -5})), "delays.motor.ms: Input should be greater"),
    "jitter of 1e9 ms": (_manifest(("noise.delay_jitter_ms", 1e9)), "noise.delay_jitter_ms: Input should be less"),
    "pictures of 10^9 pixels a side": (
        _manifest(("senses.vision.width_px", 10**9)),
        "vision.width_px: Input should be",
    ),
    "pictures of -1 pixels a side": (_manifest(("senses.vision.height_px", -1)), "vision.height_px: Input should be"),
    "skin points a nanometre apart": (_manifest(("senses.touch.skin.0.spacing_m", 1e-9)), "spacing_m: Input should be"),
    "other skin points than there are": (_manifest(("senses.touch.skin.0.points", 7)), "skin points of"),
    "another scene": (_manifest(("scene", "../scene.xml")), "scene: Input should be 'scene.xml'"),
    "a key that nobody knows": (_manifest(("run", "rm -rf")), "run: Extra inputs are not permitted"),
    "an unknown actuator": (_manifest(("actuation.actuators.0.name", "x")), "the model has no actuator 'x'"),
    "an unknown joint": (
        _manifest(("actuation.actuators.0.joint", "x")),
        "actuators[0].joint: the model has no hinge 'x'",
    ),
    "an unknown sense of torque": (
        _manifest(("senses.proprioception.torque_sensors.0", "x")),
        "the model has no sensor of three numbers 'x'",
    ),
    "an unknown camera": (_manifest(("senses.vision.cameras.0", "x")), "the model has no camera 'x'"),
    "an unknown pose": (_manifest(("pose", "x"), ("poses.0", "x")), "pose: the model has no keyframe 'x'"),
    "an unknown root": (_manifest(("root_body", "x")), "root_body: the model has no body 'x'"),
    "a root that is a hinge": (
        _manifest(("root_joint", "robot:head_tilt")),
        "the model has no free joint 'robot:head_tilt'",
    ),
    "an unknown material": (
        _manifest(("face.materials.happy", "x")),
        "face.materials.happy: the model has no material 'x'",
    ),
    "an unknown skin": (_manifest(("face.skin", "x")), "face.skin: the model has no skin 'x'"),
    "an unknown body with a NUL": (_manifest(("senses.touch.skin.0.body", "hip\0")), "the model has no body"),
    "a name of 10^6 characters": (_manifest(("root_body", "x" * 10**6)), "root_body: String should have at most"),
    "a manifest of deep lists": (_replaced("manifest.json", lambda _: b"[" * 10**6), "it is damaged"),
    "a manifest of a huge number": (_replaced("manifest.json", lambda _: b"9" * 10**6), "it is damaged"),
    "an array that is compressed": (_replaced("arrays.npz", lambda _: b"PK\5\6" + bytes(18)), "skin points of"),
    "an array of text": (
        _replaced("arrays.npz", lambda content: content.replace(b"<f8", b"|O8")),
        "arrays.npz is damaged",
    ),
    "an array of 10^12 numbers": (
        _replaced("arrays.npz", lambda content: content.replace(b", 3)", b"e9)")),
        "arrays.npz is damaged",
    ),
}
"""What was found, and what the error says of it."""


def plant_fifo(folder: Path, outside: Path) -> None:
    os.unlink(folder / EYE)
    os.mkfifo(folder / EYE)


def plant_link(folder: Path, outside: Path) -> None:
    os.unlink(folder / EYE)
    os.symlink(outside / "canary.png", folder / EYE)


def plant_linked_folder(folder: Path, outside: Path) -> None:
    os.rename(folder / "assets", folder.parent / "moved")
    os.symlink(outside, folder / "assets")


def plant_large_file(folder: Path, outside: Path) -> None:
    os.truncate(folder / EYE, 2**40)


PLANTED = {
    "a pipe": (plant_fifo, "assets/eye.png is not a regular file"),
    "a link": (plant_link, "assets/eye.png is a link, which mimoc never writes"),
    "a folder that is a link": (plant_linked_folder, "is a link, which mimoc never writes"),
    "a terabyte of nothing": (plant_large_file, "assets/eye.png is larger than those of any infant"),
}
"""What is done to the folder itself."""
