"""A picture of an infant, as part of a page."""

import base64
import io

import numpy as np
from PIL import Image

from mimoc.bundle.io import Bundle
from mimoc.errors import RenderingError
from mimoc.render.portrait import portrait
from mimoc.reporting.page import Picture

WIDTH_PX, HEIGHT_PX = 800, 600
"""Of the picture, twice as large as it is shown, for screens with small pixels."""
QUALITY = 82
"""Of the WebP: some 20 kB."""


def picture(bundle: Bundle) -> tuple[tuple[Picture, ...], str]:
    """Return a picture of an infant in its pose, and what is to be said of it; none where there is no OpenGL."""
    try:
        pixels = portrait(bundle, width=WIDTH_PX, height=HEIGHT_PX)
    except RenderingError:
        return (), "There is no portrait, because there is no OpenGL on the machine that made this page."
    buffer = io.BytesIO()
    Image.fromarray(np.asarray(pixels, np.uint8)).save(buffer, "WEBP", quality=QUALITY, method=6)
    data = f"data:image/webp;base64,{base64.b64encode(buffer.getvalue()).decode()}"
    about = f"{bundle.manifest.name}, {bundle.manifest.pose}"
    return (Picture(data, about, str(WIDTH_PX // 2), str(HEIGHT_PX // 2)),), ""
