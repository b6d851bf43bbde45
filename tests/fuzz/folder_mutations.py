"""Changes by chance to folders: to what files contain, by type, and to the files, folders, links and pipes in them."""

import csv
import io
import json
import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from fuzz.crafted_policies import packed, unpacked
from fuzz.mutations import TEXTS, Generator, changed_bytes, changed_data, pick

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
    """Return a table in which some cells, columns or rows are others."""
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
