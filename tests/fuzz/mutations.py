"""Changes by chance to bytes, plain data, XML, files by their kind and folders; values drawn from a JSON Schema."""

import copy
import csv
import io
import json
import os
import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fuzz.crafted_policies import packed, unpacked

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


OMITTED = object()  # What a hint gives for a key that is to be left out.
FULL = 0.35  # How often a key is there that may be left out.
MAX_ITEMS = 3

Hints = Mapping[str, Callable[[np.random.Generator], Any]]
"""What draws the value of a key of some name, which the schema alone says too little of."""


def among(*values: Any) -> Any:
    return lambda generator: pick(generator, values)


def between(low: float, high: float, digits: int = 1) -> Any:
    return lambda generator: round(float(generator.uniform(low, high)), digits)


def whole(low: int, high: int) -> Any:
    return lambda generator: int(generator.integers(low, high + 1))


@dataclass(frozen=True)
class Drawing:
    schema: Mapping[str, Any]  # The whole schema.
    hints: Hints
    generator: np.random.Generator

    def value(self, node: Mapping[str, Any] | None = None) -> Any:
        """Return a value that fits a node of the schema, by default all of it."""
        node = self.resolved(self.schema if node is None else node)
        if "const" in node:
            return node["const"]
        if "enum" in node:
            return pick(self.generator, node["enum"])
        if options := node.get("oneOf") or node.get("anyOf"):
            return self.value(pick(self.generator, options))
        return getattr(self, f"_{node.get('type', 'string')}")(node)

    def resolved(self, node: Mapping[str, Any]) -> Mapping[str, Any]:
        return self.schema["$defs"][node["$ref"].rpartition("/")[2]] if "$ref" in node else node

    def _object(self, node: Mapping[str, Any]) -> dict[str, Any]:
        known, needed = node.get("properties", {}), node.get("required", ())
        drawn = {}
        for key, inner in known.items():
            if key in needed or self.generator.random() < FULL:
                drawn[key] = self.hints[key](self.generator) if key in self.hints else self.value(inner)
        more = node.get("additionalProperties")
        if names := node.get("propertyNames", {}).get("enum"):
            for _ in range(self.generator.integers(MAX_ITEMS)):
                drawn[pick(self.generator, names)] = self.value(more)
        return {key: value for key, value in drawn.items() if value is not OMITTED}

    def _array(self, node: Mapping[str, Any]) -> list[Any]:
        if "prefixItems" in node:
            drawn = [self.value(item) for item in node["prefixItems"]]
            return sorted(drawn) if all(isinstance(value, (int, float)) for value in drawn) else drawn
        most = min(MAX_ITEMS, node.get("maxItems", MAX_ITEMS))
        drawn = [self.value(node["items"]) for _ in range(self.generator.integers(1, most + 1))]
        return [value for number, value in enumerate(drawn) if value not in drawn[:number]]

    def _number(self, node: Mapping[str, Any]) -> float:
        low = node.get("minimum", node.get("exclusiveMinimum", 0.0))
        return round(float(self.generator.uniform(low, node.get("maximum", low + 1))), 3)

    def _integer(self, node: Mapping[str, Any]) -> int:
        low = node.get("minimum", 0)
        return int(self.generator.integers(low, min(node.get("maximum", low + 9), low + 9) + 1))

    def _boolean(self, _: Mapping[str, Any]) -> bool:
        return bool(self.generator.random() < 0.5)

    def _string(self, node: Mapping[str, Any]) -> str:
        return pick(self.generator, node.get("examples", ("small", "one_more")))


LINKED = ("canary.png", "canary.xml", "eye.png", ".")
"""What links lead to, in the folder outside; a dot is that folder."""


def spoil(generator: Generator, place: Path, outside: Path) -> None:
    """Change a folder in one to three places.

    Args:
        generator: Decides what is changed.
        place: The folder.
        outside: A folder beside it, which links may lead to.
    """
    for _ in range(pick(generator, (1, 1, 1, 2, 3))):
        inside = [path for path in sorted(place.rglob("*")) if not path.is_symlink()]
        files, folders = [path for path in inside if path.is_file()], [path for path in inside if path.is_dir()]
        if files and generator.random() < 0.6:
            _change(generator, pick(generator, files), files)
        elif inside:
            _replace(generator, pick(generator, pick(generator, (files or inside, folders or inside))), outside)


def changed_csv(generator: Generator, text: str) -> str:
    rows = [row for row in csv.reader(io.StringIO(text)) if row]
    for _ in range(int(generator.integers(1, 4))):
        kind, row, column = generator.integers(6), pick(generator, rows), int(generator.integers(len(rows[0])))
        if kind == 0:
            row[column : column + 1] = [pick(generator, TEXTS)]
        elif kind == 1:
            row[column : column + 1] = [pick(generator, pick(generator, rows) or [""])]
        elif kind == 2:
            for line in rows:
                del line[column : column + 1]
        elif kind == 3:
            for line in rows:
                line.insert(column, pick(generator, TEXTS))
        elif kind == 4:
            rows.insert(int(generator.integers(len(rows) + 1)), [*row])
        elif len(rows) > 1:
            rows.remove(row)
        if not rows[0]:
            break
    written = io.StringIO()
    csv.writer(written, lineterminator="\n").writerows(rows)
    return written.getvalue()


def changed_file(generator: Generator, name: str, content: bytes) -> bytes:
    """Return the content of a file with changes that fit its kind, or else to its bytes."""
    by_kind: dict[str, Callable[[], bytes]] = {
        ".json": lambda: json.dumps(changed_data(generator, json.loads(content))).encode(errors="surrogateescape"),
        ".csv": lambda: changed_csv(generator, content.decode()).encode(),
        ".zip": lambda: _changed_archive(generator, content),
    }
    kind = Path(name).suffix
    if kind in by_kind and generator.random() < 0.85:
        try:
            return by_kind[kind]()
        except (ValueError, LookupError):  # It has been changed before, to what is no such file.
            pass
    return changed_bytes(generator, content)


def _changed_archive(generator: Generator, content: bytes) -> bytes:
    members = unpacked(content)
    name = pick(generator, sorted(members))
    if generator.random() < 0.1:
        del members[name]
    else:
        members[name] = changed_file(generator, name, members[name])
    return packed(members)


def _change(generator: Generator, path: Path, files: Sequence[Path]) -> None:
    if generator.random() < 0.1:
        content = pick(generator, files).read_bytes()
    else:
        content = changed_file(generator, path.name, path.read_bytes())
    path.unlink()  # Files may be hard links to those of what all tries begin with.
    path.write_bytes(content)


def _replace(generator: Generator, path: Path, outside: Path) -> None:
    """Replace a file or folder by a link, a pipe, a folder, a file or nothing; or add something beside it."""
    kind = pick(generator, ("link", "link", "link", "pipe", "folder", "file", "nothing", "beside", "within"))
    if kind == "beside":
        path = path.parent / pick(generator, ("x", ".hidden", "00", "../x", "x.json", "ff.json", "x" * 200)).strip("./")
        kind = pick(generator, ("link", "pipe", "folder", "file"))
    if os.path.lexists(path):
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    if kind == "link":
        aims = (outside / pick(generator, LINKED), path.parent, path, outside / "nowhere", outside / "." / "made")
        path.symlink_to(pick(generator, aims))
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind in ("folder", "within"):
        path.mkdir()
        if kind == "within":
            (path / pick(generator, ("x", "lock.json", "run.json", "cohort.json"))).write_bytes(b"{}")
    elif kind == "file":
        path.write_bytes(pick(generator, (b"", b"{}", b"[]", b"null", b"\xff\xfe", b"0" * 100)))
