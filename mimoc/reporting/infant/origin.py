"""What an infant was made from: its spec, and the versions of the software."""

from mimoc.bundle.io import LOCK, Bundle, digests
from mimoc.compiler.provenance.spec import SPEC_FILE
from mimoc.reporting import words
from mimoc.reporting.page import Cell, Code, Details, Section, Text, table


def origin(bundle: Bundle) -> Section:
    """Return the section on what an infant was made from."""
    versions = words.listed([f"{name} {version}" for name, version in sorted(bundle.versions.items())])
    digest = digests({LOCK: bundle.files[LOCK]})[LOCK]
    rows = [(Cell("Built with"), Cell(versions)), (Cell("Digest of its lock"), Cell(digest, "code"))]
    rows += [(Cell("Note"), Cell(note)) for note in bundle.manifest.notes]
    spec = (
        Code(bundle.files[SPEC_FILE].decode(errors="replace"))
        if SPEC_FILE in bundle.files
        else Text("It has no spec.", "note")
    )
    blocks = (table(("", ""), rows), Details("The spec, as it was written", (spec,)))
    return Section("spec", "What it was made from", blocks)
