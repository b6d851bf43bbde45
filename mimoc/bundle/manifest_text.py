"""The manifest, read from its file, and the plug-ins it needs: it names kinds, never the code that runs them."""

import json
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from mimoc.actuation import ACTUATIONS
from mimoc.bundle.json_files import problems_in
from mimoc.bundle.manifest import MANIFEST_VERSION, Manifest
from mimoc.errors import BundleError
from mimoc.kinds import Kinds
from mimoc.senses import SENSES
from mimoc.tasks import TASKS

MANIFEST = "manifest.json"
MOST_BYTES = 2**22
"""4 MB; a room with fifty toys and an infant with ten fingers have 56 kB."""


def read_manifest(content: bytes) -> Manifest:
    """Return the manifest that a file contains.

    Raises:
        BundleError: If a plug-in is missing that it needs, or if it is not what mimoc writes.
    """
    if len(content) > MOST_BYTES:
        raise BundleError(f"{MANIFEST}: it has more than {MOST_BYTES >> 20} MB, which no infant needs")
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        raise BundleError(f"{MANIFEST}: it is damaged; build it again") from None
    check_plugins(data)
    if not isinstance(data, dict) or data.get("manifest", MANIFEST_VERSION) != MANIFEST_VERSION:
        advice = f"this version of mimoc reads manifests of version {MANIFEST_VERSION} only; build it again"
        raise BundleError(advice)
    try:
        return Manifest.model_validate_json(content)
    except ValidationError as error:
        raise BundleError(f"{MANIFEST}: {problems_in(error)}; build it again") from None


RUNNING: Mapping[str, Kinds[Any]] = {"senses": SENSES, "tasks": TASKS, "actuation": ACTUATIONS}
"""The kinds of things that a bundle runs, by the section that a manifest names them in."""
BUILDING = ("scenes", "toys", "parts")
"""Those that it is only built from."""


def check_plugins(manifest: Any) -> None:
    """Pass the data of a manifest whose plug-ins are all here.

    Raises:
        BundleError: If one is missing, or another distribution has a kind of that name.
    """
    plugins = manifest.get("plugins", {}) if isinstance(manifest, dict) else {}
    if not isinstance(plugins, dict):
        raise BundleError("its plug-ins are listed in a way that mimoc never writes; build it again")
    problems = [_problem(str(key), str(distribution)) for key, distribution in plugins.items()]
    if missing := [problem for problem in problems if problem]:
        raise BundleError("; ".join(missing))


def _problem(key: str, distribution: str) -> str | None:
    section, _, name = key.partition(".")
    if section in BUILDING:
        return None
    if section not in RUNNING or not name.isidentifier() or not distribution.isprintable():
        return f"its plug-in {key!r} is named in a way that mimoc never writes; build it again"
    table, source = RUNNING[section], f"the plug-in '{distribution}'" if distribution else "a script"
    if name not in table:
        advice = f"install '{distribution}'" if distribution else "register it with mimoc.register first"
        return f"this bundle needs the {table.what} '{name}' from {source}, which is not here; {advice}"
    current = table.distribution(name)
    if current != distribution:
        other = f"'{current}'" if current else "a script"
        return f"this bundle needs the {table.what} '{name}' from {source}, but here it comes from {other}"
    return None
