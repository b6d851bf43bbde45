"""Pages of the repository that are also pages of the site, and links that hold in both."""

import os
import re
from pathlib import Path

import cli_reference
import spec_reference
from sphinx.application import Sphinx

CHECKOUT = Path(__file__).resolve().parents[2]
DOCS = CHECKOUT / "docs"
PAGES = {
    "contributing": "CONTRIBUTING.md",
    "changelog": "CHANGELOG.md",
    "benchmarks": "benchmarks/README.md",
    "data": "data/README.md",
    "plugin": "examples/plugin/README.md",
}
"""Pages of the site that are files elsewhere in the repository."""
ENTRANCES = {
    CHECKOUT / "README.md": DOCS / "index.md",
    CHECKOUT / "examples" / "gallery" / "README.rst": DOCS / "gallery" / "index.rst",
}
"""Pages of the site that stand in for a file of the repository."""
MADE = {
    "spec_reference": lambda: spec_reference.reference("spec"),
    "cohort_reference": lambda: spec_reference.reference("cohort"),
    "world_reference": lambda: spec_reference.reference("world"),
    "cli_reference": cli_reference.reference,
    "experiments/README": lambda: "```{toctree}\n:hidden:\n:glob:\n\n*/*\n```\n",
}
"""Pages of the site that end with what a function returns."""
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#:\s]+)(#[^)\s]*)?\)")


def setup(app: Sphinx) -> dict[str, bool]:
    """Let Sphinx read pages through this module."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True}


def _read(app: Sphinx, page: str, source: list[str]) -> None:
    """Replace the text of a page by what the site has in its place."""
    if page in MADE:
        source[0] += "\n" + MADE[page]()
    if Path(app.env.doc2path(page)).suffix != ".md":
        return
    path = CHECKOUT / PAGES[page] if page in PAGES else DOCS / f"{page}.md"
    text = path.read_text(encoding="utf-8") if page in PAGES else source[0]
    if page in PAGES:
        app.env.note_dependency(str(path))
    source[0] = LINK.sub(lambda link: _resolved(link, path.parent, (DOCS / page).parent), text)


def _resolved(link: re.Match[str], folder: Path, here: Path) -> str:
    """Return a link of a file in `folder` as a page in `here` has it: a page, a file to download, or only its name."""
    text, target, anchor = link[1], (folder / link[2]).resolve(), link[3] or ""
    elsewhere = {CHECKOUT / path: DOCS / f"{page}.md" for page, path in PAGES.items()} | ENTRANCES
    target = elsewhere.get(target, target)
    if target.is_dir():
        return text if text.startswith("`") else f"`{text}`" if "/" in text else f"{text} (`{target.name}/`)"
    return f"[{text}]({os.path.relpath(target, here)}{anchor})"
