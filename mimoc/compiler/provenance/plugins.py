"""Where the kinds that are not mimoc's own come from."""

from collections.abc import Mapping

from mimoc.body.origins import Entry
from mimoc.body.parts import PARTS

SOURCES = {
    "actuation": ["spec.actuation.model"],
    "tasks": ["spec.task.kind"],
    "scenes": ["spec.scene.kind"],
    "toys": ["spec.scene.toys.source"],
}
"""Key of the spec that asks for a kind; a sense is a section, which has none of its own."""


def trace_plugins(plugins: Mapping[str, str]) -> dict[str, Entry]:
    """Return an entry for each kind that is not mimoc's own: the distribution that it comes from.

    Args:
        plugins: Distributions by kind, such as `senses.sound`; empty for a kind that a script registered.
    """
    return {f"plugins.{kind}": _entry(kind, distribution) for kind, distribution in plugins.items()}


def _entry(kind: str, distribution: str) -> Entry:
    rule = "the installed distribution that declares this kind" if distribution else "registered by a script"
    section, _, name = kind.partition(".")
    sources = SOURCES.get(section, [])
    if section == "parts":
        sources = ["spec.body.hands" if PARTS[name].replaces else "spec.body.extra"]
    return {"value": distribution, "rule": rule, "from": sources}
