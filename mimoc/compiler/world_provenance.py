"""Where each number of a world with several infants comes from; keys of an infant's numbers begin with its name."""

from collections.abc import Collection, Iterator, Mapping

from mimoc.body.origins import Entry
from mimoc.bundle.world import file_of
from mimoc.compiler.provenance import SPEC_FILE


def trace_around(origins: Mapping[str, Entry], shared: Collection[str], infant: str) -> Iterator[tuple[str, Entry]]:
    """Yield where the numbers of what is around all infants come from.

    Args:
        origins: What is said of them as in the scene of a single infant.
        shared: The numbers that belong to no infant.
        infant: The infant whose numbers all others are.
    """
    for key, entry in origins.items():
        sources = [source if source in shared else f"{infant}.{source}" for source in entry.get("from", ())]
        yield key, {**entry, "from": sources}


def trace_infant(name: str, prefix: str, entries: Mapping[str, Entry]) -> Iterator[tuple[str, Entry]]:
    """Yield where the numbers of an infant come from, in its world, by what is said of it alone."""
    for key, entry in entries.items():
        changed = dict(entry)
        if key.startswith("spec."):
            is_shared = key.startswith("spec.scene.") and key not in ("spec.scene.pose", "spec.scene.held")
            rule = entry["rule"].replace(SPEC_FILE, file_of(name, SPEC_FILE))
            changed["rule"] = "the scene of the world" if is_shared else rule
        if "from" in entry:
            changed["from"] = [f"{name}.{source}" for source in entry["from"]]
        if "xml" in entry:
            changed["xml"] = _xml_in_world(entry["xml"], prefix)
        yield f"{name}.{key}", changed


def _xml_in_world(xml: str, prefix: str) -> str:
    """Return where in the world's MJCF what is in an infant's stands."""
    if xml.startswith("scene.xml"):
        return xml  # Things of its task, whose names have their prefix already.
    in_world_file = xml.replace("infant.xml:", "scene.xml:").replace("[@name='", f"[@name='{prefix}")
    return in_world_file.replace("default/", f"default[@class='{prefix}infant']/")
