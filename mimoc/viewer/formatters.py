"""How IPython shows bundles."""

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle


def register_formatters() -> None:
    """Let notebooks show a bundle as a picture with its measures; outside of IPython this does nothing."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is not None:
        shell.display_formatter.formatters["text/html"].for_type_by_name("mimoc.bundle.io", "Bundle", _bundle_html)


def _bundle_html(bundle: "Bundle") -> str:
    from mimoc.viewer.notebook import bundle_html

    return bundle_html(bundle)
