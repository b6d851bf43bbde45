"""An infant in a few sentences, with its picture."""

import base64
import io
from collections.abc import Iterator

import numpy as np
from PIL import Image

from mimoc.bundle.io import Bundle
from mimoc.errors import RenderingError
from mimoc.render.portrait import portrait
from mimoc.reporting import words
from mimoc.reporting.page import Picture
from mimoc.tasks import TASKS

WIDTH_PX, HEIGHT_PX = 800, 600
"""Of the picture, twice as large as it is shown, for screens with small pixels."""
QUALITY = 82
"""Of the WebP: some 20 kB."""
NOUNS = {"male": "A boy", "female": "A girl", None: "An infant, the mean of boys and girls,"}
POSES = {"standing": "stands", "sitting": "sits", "supine": "lies on its back", "prone": "lies on its belly"}


def introduce(bundle: Bundle) -> tuple[tuple[str, ...], tuple[Picture, ...]]:
    """Return what an infant is, where it is and what it is to do, and its picture; none where there is no OpenGL."""
    sentences = tuple(_sentences(bundle))
    try:
        return sentences, (_picture(bundle),)
    except RenderingError:
        return (*sentences, "There is no portrait, because there is no OpenGL on the machine that made this page."), ()


def _picture(bundle: Bundle) -> Picture:
    pixels = portrait(bundle, width=WIDTH_PX, height=HEIGHT_PX)
    buffer = io.BytesIO()
    Image.fromarray(np.asarray(pixels, np.uint8)).save(buffer, "WEBP", quality=QUALITY, method=6)
    data = f"data:image/webp;base64,{base64.b64encode(buffer.getvalue()).decode()}"
    return Picture(data, f"{bundle.manifest.name}, {bundle.manifest.pose}", str(WIDTH_PX // 2), str(HEIGHT_PX // 2))


def _sentences(bundle: Bundle) -> Iterator[str]:
    manifest = bundle.manifest
    child = manifest.child
    length, weight = words.quantity(child.length_cm, "cm"), words.quantity(child.weight_kg, "kg")
    head = words.quantity(child.head_circumference_cm, "cm")
    noun = f"{NOUNS[child.sex]} {words.of_age(child.age_months)}"
    yield f"{noun}, {length} long and {weight} heavy, with a head of {head} around."
    begins = POSES.get(manifest.pose, f'takes the pose "{words.name(manifest.pose)}"')
    toys = f" among {words.count(len(manifest.toys), 'toy')}" if manifest.toys else ""
    yield f"At the start of an episode it {begins}{toys}. {_task(bundle)}"


def _task(bundle: Bundle) -> str:
    kind = bundle.manifest.task.kind
    if kind == "free":
        return "It has no task."
    about = (TASKS[kind].spec.__doc__ or "").strip().splitlines() if kind in TASKS else []
    return f"Its task, {words.name(kind)}: {about[0][:1].lower() + about[0][1:]}" if about else f"Its task: {kind}."
