"""What a user reads who wrote something wrong: golden texts, in `__snapshots__/test_bad_specs.ambr`.

Renew them with `pytest tests/test_bad_specs.py --snapshot-update`, and read the difference.
"""

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from support.bad_specs import SPECS

from mimoc.base.errors import SpecError
from mimoc.schema import read_spec
from mimoc.schema.source import read


@pytest.mark.parametrize("case", SPECS)
def test_bad_specs_get_these_texts(case, snapshot, tmp_path, monkeypatch):
    content = SPECS[case]
    monkeypatch.chdir(tmp_path)
    Path("spec.yaml").write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(SpecError) as refusal:
        read_spec(read("spec.yaml"))
    readable = isinstance(content, str) and "\x1b" not in content
    shown = content if readable else f"{content[:60]!r}\n"
    assert f"{shown}\n{refusal.value}" == snapshot


FILES: dict[str, Callable[[Path], object]] = {
    "a missing file": lambda path: None,
    "a folder": lambda path: path.mkdir(),
    "100 MB of YAML": lambda path: (path.touch(), os.truncate(path, 100_000_000)),
    "a pipe": os.mkfifo,
    "a link to itself": lambda path: path.symlink_to(path),
}


@pytest.mark.parametrize("case", FILES)
def test_what_is_no_spec_file_gets_these_texts(case, snapshot, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    FILES[case](tmp_path / "spec.yaml")
    with pytest.raises(SpecError) as refusal:
        read("spec.yaml")
    assert str(refusal.value) == snapshot
