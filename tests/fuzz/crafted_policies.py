"""Policies made to do harm: every way that was ever found, small, by code.

Each changes the members of an honest one. `CRAFTED` says what mimoc answers.
"""

import io
import json
import os
import pickle
import re
import struct
import zipfile
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

Members = dict[str, bytes]
Craft = Callable[[Members], None]
MARKER = "MIMOC_FUZZ_MARKER"  # Variable of the environment that code of a stranger would set.
DAMAGED = "not a policy trained by mimoc, or it is damaged"


class Runs:
    def __reduce__(self) -> tuple[Any, ...]:
        return eval, (f"__import__('os').environ.__setitem__({MARKER!r}, 'yes')",)


def packed(members: Mapping[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", compression) as archive:
        for name, member in members.items():
            archive.writestr(name, member)
    return content.getvalue()


def unpacked(content: bytes) -> Members:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _member(name: str, content: bytes | Callable[[bytes], bytes]) -> Craft:
    def craft(members: Members) -> None:
        members[name] = content if isinstance(content, bytes) else content(members[name])

    return craft


def _about(*keys: str, value: Any) -> Craft:
    """Return what sets a key in the description; `*` is whatever comes first."""

    def craft(members: Members) -> None:
        about = json.loads(members["mimoc.json"])
        inside: Any = about
        for key in keys[:-1]:
            inside = inside[next(iter(inside)) if key == "*" else key]
        inside[keys[-1]] = value
        members["mimoc.json"] = json.dumps(about).encode()

    return craft


def _arrays(member: str, change: Callable[[dict[str, Any]], Any]) -> Craft:
    def craft(members: Members) -> None:
        with np.load(io.BytesIO(members[member])) as file:
            arrays: dict[str, Any] = dict(file)
        content = io.BytesIO()
        np.savez(content, **(change(arrays) or arrays))
        members[member] = content.getvalue()

    return craft


_weights, _statistics = partial(_arrays, "weights.npz"), partial(_arrays, "scale.npz")


def _inside(change: Callable[[bytes], bytes], compression: int = zipfile.ZIP_STORED) -> Craft:
    """Return what changes an array in the file of the weights, as it stands there."""

    def craft(members: Members) -> None:
        inner = unpacked(members["weights.npz"])
        name = next(iter(inner))
        members["weights.npz"] = packed({**inner, name: change(inner[name])}, compression)

    return craft


def _longer(array: bytes) -> bytes:
    header = array[10 : 10 + int.from_bytes(array[8:10], "little")]
    shape = re.search(rb"'shape': \(([^)]*)\)", header)
    assert shape
    longer = (
        header.replace(shape[0], b"'shape': (4294967296,)").rstrip().ljust(len(header) - 1)[: len(header) - 1] + b"\n"
    )
    return array[:10] + longer + array[10 + len(header) :]


ALLOCATES = b"\x80\x04\x96" + struct.pack("<Q", 2**36) + b"."  # A pickle of a bytearray of 64 GB, which is not there.
REMEMBERS = b"\x80\x02Nr" + struct.pack("<I", 2**32 - 2) + b"."
"""A pickle that keeps None in the last of four billion places."""
CODE = pickle.dumps(Runs(), protocol=2)
NEW_CODE = pickle.dumps(Runs(), protocol=4)
BOMB = bytes(2**24 + 1)

CRAFTED: dict[str, tuple[Craft, str]] = {
    # What would run code.
    "code in place of the weights": (_member("weights.npz", CODE), DAMAGED),
    "code in the archive of the weights": (_inside(lambda _: CODE), DAMAGED),
    "code by another protocol": (_inside(lambda _: NEW_CODE), DAMAGED),
    "code among the weights": (_weights(lambda weights: {**weights, "x": np.array([Runs()], object)}), DAMAGED),
    "code among the statistics": (
        _statistics(lambda arrays: arrays.update(x=np.array([Runs()], object))),
        DAMAGED,
    ),
    "a module of torch's": (_inside(lambda _: b"\x80\x02ctorch.hub\nload\nX\1\0\0\0x\x85R."), DAMAGED),
    "a function of builtins": (_inside(lambda _: b"\x80\x02c__builtin__\neval\nX\1\0\0\0x\x85R."), DAMAGED),
    "an instance": (_inside(lambda _: b"\x80\x02(X\1\0\0\0xios\nsystem\n."), DAMAGED),
    # What would exhaust.
    "a description that unpacks to 16 MB": (_member("mimoc.json", BOMB), DAMAGED),
    "statistics that unpack to 16 MB": (_member("scale.npz", BOMB), DAMAGED),
    "weights that unpack to 16 MB": (_member("weights.npz", BOMB), DAMAGED),
    "weights that are packed": (_inside(lambda array: array, zipfile.ZIP_DEFLATED), DAMAGED),
    "a pickle that allocates 64 GB": (_inside(lambda _: ALLOCATES), DAMAGED),
    "a pickle that remembers four billion things": (_inside(lambda _: REMEMBERS), DAMAGED),
    "a pickle of deep lists": (_inside(lambda _: b"\x80\x02" + b"]" * 10**6 + b"a" * (10**6 - 1) + b"."), DAMAGED),
    "weights that are longer than the file": (_inside(_longer), DAMAGED),
    "layers of 16,384 units": (_about("settings", "hyper", "width", value=2**14), DAMAGED),
    "a description of deep lists": (_member("mimoc.json", b"[" * 10**6), DAMAGED),
    # What is damaged.
    "an algorithm that nobody knows": (_about("settings", "algo", value="dqn"), DAMAGED),
    "an algorithm that is a list": (_about("settings", "algo", value=["ppo"]), DAMAGED),
    "a width of NaN": (_about("settings", "hyper", "width", value=float("nan")), DAMAGED),
    "a width that is text": (_about("settings", "hyper", "width", value="8"), DAMAGED),
    "settings that are a list": (_about("settings", value=[]), DAMAGED),
    "observations that are a list": (_about("observes", value=[]), DAMAGED),
    "a shape that is text": (_about("observes", "*", "shape", value="x"), DAMAGED),
    "a layout that is missing": (_about("observes", "*", value={"shape": [1]}), DAMAGED),
    "commands that are numbers": (_about("commands", value=[1, 2]), DAMAGED),
    "a name that moves the cursor": (_about("infant", value="\x1b[2J"), DAMAGED),
    "a later version": (_about("policy", value=4), "was saved by another version of mimoc; train it again"),
    "a version that is text": (_about("policy", value="2"), DAMAGED),
    "weights of another shape": (_weights(lambda weights: {name: part[:1] for name, part in weights.items()}), DAMAGED),
    "weights without names": (
        _weights(lambda weights: {f"arr_{n}": part for n, part in enumerate(weights.values())}),
        DAMAGED,
    ),
    "weights that are numbers": (_weights(lambda weights: dict.fromkeys(weights, np.float32(1))), DAMAGED),
    "weights that are text": (_weights(lambda weights: dict.fromkeys(weights, np.array(["x"]))), DAMAGED),
    "weights in column order": (
        _weights(lambda weights: {n: np.asfortranarray(part) for n, part in weights.items()}),
        DAMAGED,
    ),
    "weights that are not there": (_weights(lambda weights: {"log_std": weights["log_std"]}), DAMAGED),
    "weights of NaN": (_weights(lambda weights: {name: part * np.nan for name, part in weights.items()}), DAMAGED),
    "statistics of another shape": (
        _statistics(lambda arrays: arrays.update({name: np.zeros(3) for name in arrays})),
        DAMAGED,
    ),
    "statistics that are infinite": (
        _statistics(lambda arrays: arrays.update({name: np.full_like(part, np.inf) for name, part in arrays.items()})),
        DAMAGED,
    ),
    "statistics that are not there": (_statistics(dict.clear), DAMAGED),
    "weights that overflow": (
        _weights(lambda weights: {name: np.full_like(part, 3e38) for name, part in weights.items()}),
        "this policy gives commands that are not finite; train it again",
    ),
}
"""What was found, and what the error says of it."""


def ran() -> bool:
    """Return whether code of a stranger has run; it may run again then."""
    return os.environ.pop(MARKER, None) is not None
