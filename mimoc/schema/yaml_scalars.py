"""Unquoted values of YAML 1.2, and data written as YAML."""

import re
import sys
from collections.abc import Mapping
from typing import Any

import yaml

from mimoc.schema.base import shown

_INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_REAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_CONSTANTS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def scalar(text: str) -> bool | int | float | str | None:
    """Return what an unquoted YAML 1.2 scalar means: `012` is twelve, `1e-3` a number, `no` a word.

    Raises:
        ValueError: If it is a number that is not finite or too large.
    """
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _NOT_FINITE.fullmatch(text):
        raise ValueError(f"{text} is not finite; write a finite number")
    if not _REAL.fullmatch(text) and not _INTEGER.fullmatch(text):
        return text
    try:
        number = int(text, {"0o": 8, "0x": 16}.get(text[:2], 10)) if _INTEGER.fullmatch(text) else float(text)
        finite = abs(float(number)) <= sys.float_info.max
    except (OverflowError, ValueError):  # ValueError: Python does not convert integers of very many digits.
        number, finite = 0, False
    if not finite:
        raise ValueError(f"{shown(text)} is too large; write a smaller number")
    return number


def means_itself(text: str) -> bool:
    """Return whether an unquoted scalar is just this text."""
    try:
        return scalar(text) == text
    except ValueError:
        return False


def dump(data: Mapping[str, Any]) -> str:
    """Return data as YAML that parses to the same, with sorted keys."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=True, default_flow_style=False, width=sys.maxsize)


class _Dumper(yaml.SafeDumper):
    """PyYAML's dumper, without aliases and with quotes around words that YAML 1.2 would not read as text."""

    def ignore_aliases(self, data: Any) -> bool:
        return True

    def represent_word(self, text: str) -> yaml.ScalarNode:
        style = None if means_itself(text) else "'"
        return self.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _Dumper.represent_word)
