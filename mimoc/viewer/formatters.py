"""How IPython shows bundles: notebooks show a picture and measures instead of the `repr`."""

import base64
import sys
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle


def register_formatters() -> None:
    """Let IPython show a bundle as a picture with its measures, if a shell of it runs."""
    shell = sys.modules["IPython"].get_ipython()
    if shell is not None:
        shell.display_formatter.formatters["text/html"].for_type_by_name("mimoc.bundle.io", "Bundle", bundle_html)


PICTURE_PX = (320, 240)
MEASURES = {
    "length_cm": ("length", "cm"),
    "weight_kg": ("weight", "kg"),
    "head_circumference_cm": ("head circumference", "cm"),
    "arm_circumference_cm": ("arm circumference", "cm"),
}


def bundle_html(bundle: "Bundle") -> str:
    """Return a picture of an infant, if one can be drawn here, and its measures with WHO's percentiles."""
    from mimoc.compiler.provenance import AMONG, SCALE_NOT_KNOWN, who_percentiles

    child = bundle.manifest.child
    percentiles = who_percentiles(bundle.manifest.child)
    rows = [
        (name, f"{value:.1f} {unit}", f"{percentiles[key]:.0f}" if key in percentiles else "")
        for key, (name, unit) in MEASURES.items()
        if (value := getattr(child, key)) is not None
    ]
    heading = ("", "", f"WHO percentile, {AMONG[child.sex]}" if child.size_is_known else SCALE_NOT_KNOWN)
    table = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in (heading, *rows))
    title = f"<b>{escape(bundle.manifest.name)}</b>, {child.age_months:g} months"
    return f"<div>{title}<br>{_picture(bundle)}<table>{table}</table></div>"


def _picture(bundle: "Bundle") -> str:
    """Return a portrait as an element that contains it; nothing where there is no OpenGL."""
    from mimoc.base.errors import RenderingError
    from mimoc.render.picture_files import encoded
    from mimoc.render.portrait import portrait

    try:
        png = encoded(portrait(bundle, None, *PICTURE_PX), ".png")
    except RenderingError:
        return ""
    data = base64.b64encode(png).decode()
    return f'<img alt="{escape(bundle.manifest.name)}" src="data:image/png;base64,{data}">'
