"""Changes by chance: to bytes, to plain data, and to XML."""

import copy
import re
from typing import Any

import numpy as np

Generator = np.random.Generator

VALUES = (
    *(None, True, False, [], {}, "", "x", "hip", "robot:head_tilt", "\0", "é" * 300, "../../etc", "1e999"),
    *(0, 1, -1, 2, 3, 0.5, -0.0, 1e-300, 1e-9, 1e9, 1e300, -1e300, 10**9, -(10**9), 2**31, 2**63, 2**70, 10**400),
    *(float("nan"), float("inf"), [[]], [0], [None], ["hip"], {"x": 1}),
)
"""What no honest file has in most places."""
TEXTS = (
    *(
        "",
        "0",
        "-1",
        "1e-300",
        "1e300",
        "nan",
        "inf",
        "-inf",
        "0x10",
        "1e9",
        "99999999999",
        "0.0000001",
        "1 2 3",
        "a b",
    ),
    *("0 0 0", "0 0 0 0", "1 " * 100, "true", "false", "mesh", "sphere", "plane", "box", "ball", "slide", "muscle"),
    *("../x", "/etc/passwd", "/dev/zero", "/dev/stdin", "&#47;", "&lt;", "x" * 5000, "hip", "infant", "scene.xml"),
)
ELEMENTS = (
    '<include file="/etc/passwd"/>',
    '<replicate count="1000"><geom size="1"/></replicate>',
    '<frame pos="1 1 1"><geom size="1"/></frame>',
    '<plugin plugin="mujoco.pid"/>',
    '<joint name="more" type="ball"/>',
    "<freejoint/>",
    '<geom name="more" size="1"/>',
    '<geom name="more" type="mesh" mesh="more"/>',
    '<body name="more"><freejoint/><geom size="0.1"/></body>',
    '<body name="more" mocap="true"/>',
    '<general name="more" joint="robot:head_tilt"/>',
    '<key name="more"/>',
    "<!-- -->",
    "text",
)
_ATTRIBUTE = re.compile(r'([\w]+)="([^"]*)"')
_ELEMENT = re.compile(r"^ *<.*/>\n", re.MULTILINE)


def pick(generator: Generator, among: Any) -> Any:
    return among[int(generator.integers(len(among)))]


def changed_bytes(generator: Generator, content: bytes) -> bytes:
    """Return bytes of which some are others, missing, or there twice."""
    found = bytearray(content)
    for _ in range(int(generator.integers(1, 8))):
        at = int(generator.integers(len(found) + 1))
        kind = int(generator.integers(6))
        if kind == 0:
            del found[at : at + int(generator.integers(1, 64))]
        elif kind == 1:
            found[at:at] = generator.bytes(int(generator.integers(1, 16)))
        elif kind == 2:
            found[at : at + 4] = pick(generator, (b"\xff\xff\xff\x7f", b"\xff\xff\xff\xff", bytes(4), b"\0\0\0\x80"))
        elif kind == 3:
            found[at:at] = found[at : at + 64]
        elif kind == 4 and found:
            found[at % len(found)] = int(generator.integers(256))
        elif generator.random() < 0.1:
            del found[at:]
    return bytes(found)


def changed_data(generator: Generator, data: Any) -> Any:
    data = copy.deepcopy(data)
    for _ in range(int(generator.integers(1, 4))):
        places = list(_places(data))
        if not places:
            return pick(generator, VALUES)
        inside, key = pick(generator, places)
        kind = int(generator.integers(8))
        if kind == 0:
            del inside[key]
        elif kind == 1:
            held, at = pick(generator, places)
            inside[key] = copy.deepcopy(held[at])
        elif kind == 2 and isinstance(inside[key], (int, float)):
            inside[key] = inside[key] * pick(generator, (-1, 0, 1e-6, 0.3, 3, 1e3, 1e6))
        elif kind == 3 and isinstance(inside, list):
            inside.extend(copy.deepcopy(inside[:64]))
        elif kind == 4 and isinstance(inside, dict):
            inside[pick(generator, ("x", "kind", "name", "points", ""))] = pick(generator, VALUES)
        else:
            inside[key] = pick(generator, VALUES)
    return data


def changed_xml(generator: Generator, text: str) -> str:
    for _ in range(int(generator.integers(1, 4))):
        kind = int(generator.integers(8))
        if kind < 4:
            text = _with_attribute(generator, text, kind)
        elif kind == 4:
            found = pick(generator, list(_ELEMENT.finditer(text)))
            text = text[: found.start()] + text[found.end() :]
        elif kind == 5:
            found, other = (pick(generator, list(_ELEMENT.finditer(text))) for _ in range(2))
            text = text[: other.start()] + found[0] + text[other.start() :]
        elif kind == 6:
            found = pick(generator, list(re.finditer(r">\n", text)))
            text = text[: found.end()] + pick(generator, ELEMENTS) + text[found.end() :]
        else:
            text = changed_bytes(generator, text.encode(errors="surrogateescape")).decode(errors="surrogateescape")
        if len(list(_ELEMENT.finditer(text))) < 2:
            return text
    return text


def _with_attribute(generator: Generator, text: str, kind: int) -> str:
    """Return XML in which one attribute is missing, has another value, or that of another one."""
    places = list(_ATTRIBUTE.finditer(text))
    found = pick(generator, places)
    if kind == 0:
        return text[: found.start()] + text[found.end() :]
    same = [place[2] for place in places if place[1] == found[1]]
    value = pick(generator, (pick(generator, TEXTS), pick(generator, same), pick(generator, places)[2]))
    return f'{text[: found.start()]}{found[1]}="{value}"{text[found.end() :]}'


def _places(data: Any) -> Any:
    """Yield each place in plain data: what it is in, and its key or index."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, inner in list(items):
        yield data, key
        yield from _places(inner)
