"""Which plug-ins a bundle needs: a manifest names kinds, and never the code that runs them."""

from collections.abc import Mapping
from typing import Any

from mimoc.actuation import ACTUATIONS
from mimoc.errors import BundleError
from mimoc.kinds import Kinds
from mimoc.senses import SENSES
from mimoc.tasks import TASKS

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
    if found := [problem for problem in problems if problem]:
        raise BundleError("; ".join(found))


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
    here = table.distribution(name)
    if here != distribution:
        other = f"'{here}'" if here else "a script"
        return f"this bundle needs the {table.what} '{name}' from {source}, but here it comes from {other}"
    return None
