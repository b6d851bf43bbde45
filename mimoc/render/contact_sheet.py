"""Contact sheets: one infant at several ages and in several poses, as one picture with captions."""

from collections.abc import Callable, Iterable, Sequence

from mimoc.base.errors import MimocError, check_name
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.render.picture_files import tile_pictures
from mimoc.render.picture_poses import pose_in_picture, poses_in_pictures
from mimoc.render.portrait import Framing, portraits
from mimoc.render.renderer import Picture, Shown

ALL = "all"
LARGEST = 400
"""How many pictures a sheet may have."""


def read_poses(text: str, manifest: Manifest) -> list[str]:
    """Return the poses that a list such as `supine,crawling`, or `all`, names, or raise an UnknownNameError."""
    if text.strip() == ALL:
        return list(poses_in_pictures(manifest))
    names = [name.strip() for name in text.split(",")]
    if "" in names:
        check_name("pose", "", (*poses_in_pictures(manifest), ALL))
    return [pose_in_picture(manifest, name) for name in names]


def check_count(ages: int, poses: int) -> None:
    """Raise a MimocError if a sheet would have too many pictures."""
    if ages * poses > LARGEST:
        raise MimocError(f"{ages} ages in {poses} poses are {ages * poses} pictures; ask for at most {LARGEST}")


def age_label(age_months: float) -> str:
    """Return a caption for an age.

    >>> age_label(1), age_label(2.5)
    ('1 month', '2.5 months')
    """
    return f"{age_months:g} month" + ("" if age_months == 1 else "s")


def contact_sheet(
    infants: Iterable[Bundle],
    poses: Sequence[str],
    size_px: tuple[int, int],
    shown: Shown = "skin",
    framing: Framing | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> Picture:
    """Return a picture of infants in poses, shape (height, width, 3): a row for each age, a column for each pose.

    In one pose, all ages are in one row. Infants may be built as they are drawn; poses are start poses or for pictures.
    Raises an UnknownNameError for an unknown pose, a RenderingError without OpenGL.
    """
    rows: list[list[Picture]] = []
    labels: list[str] = []
    for infant in infants:
        row: list[Picture] = []
        for picture in portraits(infant, poses, *size_px, None, shown, framing or Framing()):
            row.append(picture)
            progress(len(rows) * len(poses) + len(row))
        rows.append(row)
        labels.append(age_label(infant.manifest.child.age_months))
    if len(poses) == 1:
        return tile_pictures([[picture for row in rows for picture in row]], columns=labels)
    return tile_pictures(rows, columns=poses, rows=labels)
