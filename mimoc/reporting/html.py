"""From a page to HTML, by templates."""

from functools import cache

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from mimoc.mjcf.printing import TEMPLATES
from mimoc.reporting.page import Page


def render(page: Page) -> bytes:
    """Return a page as HTML, all that it shows included; the same page gives the same bytes."""
    return _environment().get_template("report/page.html.j2").render(page=page).encode()


@cache
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
