"""The bundle: a folder that is whole, and is what was written, or is refused."""

import errno
import json
import os
import secrets
import shutil
import socket
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from glob import escape
from hashlib import sha256
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Any

from mimoc.bundle.manifest import MANIFEST_VERSION, Manifest
from mimoc.bundle.plugins_needed import check_plugins
from mimoc.bundle.swap import exchange
from mimoc.errors import BundleError

MANIFEST, LOCK = "manifest.json", "lock.json"
MAX_LOCK_BYTES = 2**22
"""No bundle has enough files for a longer lock."""


@dataclass(frozen=True, slots=True, repr=False)
class Bundle:
    """The files of a compiled infant."""

    files: Mapping[str, bytes]
    """Content by path in the folder, sorted; read-only."""
    manifest: Manifest
    """What the runtime knows of it."""
    path: Path | None
    """Folder it was read from; None if it is only in memory."""

    def __repr__(self) -> str:
        """Return who it is, how much there is of it and where it was read from, in a line."""
        size_kb = sum(map(len, self.files.values())) / 1000
        at = f", read from {str(self.path)!r}" if self.path else ""
        who = f"{self.manifest.name!r}, {self.manifest.child.age_months:g} months"
        return f"Bundle({who}, {len(self.files)} files, {size_kb:.0f} kB{at})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Let a bundle be copied and sent to other processes, which a read-only mapping alone cannot be."""
        return _bundle, (dict(self.files), self.manifest, self.path)


def seal(
    files: Mapping[str, bytes],
    versions: Mapping[str, str],
    inputs: Mapping[str, bytes],
    manifest: Manifest | None = None,
) -> Bundle:
    """Return a bundle of some files, manifest included, and a lock over them.

    Args:
        files: Content by path in the bundle.
        versions: Of the software that made them, by name.
        inputs: Tables they were made from, by name; only their digests are kept.
        manifest: What is in the file of that name, if it need not be read again.
    """
    lock = {"lock": 1, "versions": dict(versions), "inputs": digests(inputs), "files": digests(files)}
    sealed = {**files, LOCK: (json.dumps(lock, indent=1, sort_keys=True) + "\n").encode()}
    return _bundle(sealed, manifest or _manifest(files[MANIFEST]), None)


def digests(files: Mapping[str, bytes]) -> dict[str, str]:
    """Return the digest of each file, sorted by name."""
    return {name: f"sha256:{sha256(files[name]).hexdigest()}" for name in sorted(files)}


def read_bundle(path: str | Path) -> Bundle:
    """Read the bundle in a folder; files that are not the bundle's are passed over.

    Raises:
        BundleError: If it is no bundle, or not what was written; it names every file that is not.
    """
    folder = Path(os.path.expanduser(path))
    while True:
        with _hold(folder) as was_replaced:
            try:
                return _read_folder(folder)
            except BundleError:
                if not was_replaced():
                    raise


def write_bundle(bundle: Bundle, out: str | Path, *, force: bool = False) -> Path:
    """Write a bundle into a folder, all or nothing: whoever looks sees the old folder or the new one.

    Args:
        bundle: What to write.
        out: The folder: new, empty, or with *force* a bundle.
        force: Replace the bundle that is there, and with it whatever else is in its folder.

    Raises:
        BundleError: If there is something that must not be replaced, or the folder cannot be written.
    """
    target = Path(os.path.expanduser(out))
    try:
        place = Path(os.path.realpath(target))
        _refuse_to_lose(place, target, force)
        place.parent.mkdir(parents=True, exist_ok=True)
        _sweep(place)
        staging = place.parent / f"{_staging_prefix(place)}{os.getpid()}-{secrets.token_hex(8)}"
        staging.mkdir()
        try:
            _fill(staging, bundle.files)
            _move_into_place(staging, place, target, force)
        finally:
            shutil.rmtree(staging, ignore_errors=True)
    except OSError as error:
        raise BundleError(f"{target}: cannot be written ({error.strerror}); choose another folder") from None
    except ValueError:
        raise BundleError(f"{str(target)!r}: a folder cannot have this name; choose another folder") from None
    return target


def _bundle(files: Mapping[str, bytes], manifest: Manifest, path: Path | None) -> Bundle:
    return Bundle(MappingProxyType(dict(sorted(files.items()))), manifest, path)


def _manifest(content: bytes) -> Manifest:
    return Manifest.model_validate_json(content)


@contextmanager
def _hold(folder: Path) -> Iterator[Callable[[], bool]]:
    """Yield what says if another build replaced a folder since; while it is open, no new one gets its inode."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        yield lambda: False
        return
    try:
        yield lambda: folder.exists() and not os.path.samestat(os.fstat(handle), os.stat(folder))
    finally:
        os.close(handle)


def _read_folder(folder: Path) -> Bundle:
    lock = _read_lock(folder)
    locked = _locked_files(lock)
    if locked is None:
        raise BundleError(f"{folder}: its {LOCK} is damaged; remove the folder and build it again")
    found = {name: _read(folder / name) for name in sorted(locked)}
    files = {name: content for name, content in found.items() if content is not None}
    missing = [f"{name} is missing" for name in sorted(locked.keys() - files.keys())]
    changed = [f"{name} was changed" for name, digest in digests(files).items() if digest != locked[name]]
    if missing or changed:
        raise BundleError(f"{folder}: {', '.join(missing + changed)}; build it again with 'mimoc build --force'")
    try:
        check_plugins(json.loads(files[MANIFEST]))
        manifest = _manifest(files[MANIFEST])
    except BundleError as error:
        raise BundleError(f"{folder}: {error}") from None
    except (ValueError, RecursionError):
        raise BundleError(
            f"{folder}: its manifest is not of version {MANIFEST_VERSION}, which this mimoc reads; build it again"
        ) from None
    return _bundle({**files, LOCK: lock}, manifest, folder)


def _read_lock(folder: Path) -> bytes:
    advice = "build one there with 'mimoc build SPEC -o OUT'"
    if not folder.is_dir():
        raise BundleError(f"{folder}: there is no such folder; {advice}")
    content = _read(folder / LOCK, MAX_LOCK_BYTES + 1)
    if content is None:
        raise BundleError(f"{folder}: this is not a bundle, it has no {LOCK}; {advice}")
    return content


def _locked_files(content: bytes) -> dict[str, str] | None:
    """Return the digests that a lock holds, or None if it is not a lock of a bundle."""
    try:
        lock: Any = json.loads(content)
        files = lock["files"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    inside = isinstance(files, dict) and MANIFEST in files and all(map(_is_inside, files))
    return files if inside and len(content) <= MAX_LOCK_BYTES else None


def _is_inside(name: str) -> bool:
    """Return whether a name stays within the folder it is looked up in."""
    path = PurePosixPath(name)
    return name.isprintable() and not path.is_absolute() and ".." not in path.parts and "\\" not in name


def _read(path: Path, most: int = -1) -> bytes | None:
    """Return the content of a file, or None if there is none that can be read."""
    try:
        if not path.is_file():
            return None  # Reading a pipe or a device might never end.
        with path.open("rb") as file:
            return file.read(most)
    except OSError:
        return None


def _refuse_to_lose(place: Path, target: Path, force: bool) -> None:
    """Raise a BundleError if writing to *place* would lose something."""
    if not os.path.lexists(place):
        return
    if not place.is_dir():
        raise BundleError(f"{target}: this is a file; name a new folder")
    if Path.cwd().is_relative_to(place) or os.path.ismount(place):
        reason = "a mounted folder" if os.path.ismount(place) else "the folder you are in"
        raise BundleError(f"{target}: {reason} cannot be replaced as a whole; name a new folder inside it")
    if not any(place.iterdir()):
        return
    content = _read(place / LOCK, MAX_LOCK_BYTES + 1)
    if content is None or _locked_files(content) is None:
        raise BundleError(f"{target}: this folder is not a bundle and is never replaced; name a new folder")
    if not force:
        raise BundleError(f"{target}: there is a bundle already; replace it with --force, or name a new folder")


def _fill(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files into an empty folder."""
    if outside := [name for name in files if not _is_inside(name)]:
        raise BundleError(f"'{outside[0]}' is not within the bundle; nothing is written outside its folder")
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def _move_into_place(staging: Path, place: Path, target: Path, force: bool) -> None:
    """Rename the finished folder to where it belongs; what was there is left in *staging*."""
    try:
        os.rename(staging, place)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        _refuse_to_lose(place, target, force)  # Somebody else may have written there meanwhile.
        exchange(staging, place)


def _staging_prefix(place: Path) -> str:
    """Return how the names of this machine's unfinished folders for a bundle begin; a process number follows."""
    return f".{place.name}.mimoc-{socket.gethostname()}-{_process_space()}-"


def _process_space() -> str:
    """Return what tells apart containers on one machine, which count their processes each for itself."""
    try:
        return str(os.stat("/proc/self/ns/pid").st_ino)
    except OSError:
        return "0"


def _sweep(place: Path) -> None:
    """Remove the unfinished folders of builds of the same bundle that were killed on this machine."""
    prefix = _staging_prefix(place)
    for path in place.parent.glob(f"{escape(prefix)}*"):
        process = path.name.removeprefix(prefix).split("-")[0]
        if process.isdecimal() and not _is_alive(int(process)):
            shutil.rmtree(path, ignore_errors=True)


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
