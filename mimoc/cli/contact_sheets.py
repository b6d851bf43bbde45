"""`mimoc render --ages --poses`: one infant at several ages and in several poses, as one picture."""

from pathlib import Path
from typing import TYPE_CHECKING

from mimoc.base.errors import MimocError
from mimoc.cli.arguments import load_infant, load_spec
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mimoc.bundle.io import Bundle
    from mimoc.render.portrait import Framing
    from mimoc.render.renderer import Shown
    from mimoc.schema.infant import InfantSpec


def draw(
    infants: list[Path],
    file: Path,
    ages: str | None,
    poses: str | None,
    size_px: tuple[int, int],
    shown: "Shown",
    framing: "Framing",
    refused: dict[str, bool],
) -> None:
    """Write a contact sheet of one infant."""
    from mimoc.cli import console
    from mimoc.render.contact_sheet import check_count, contact_sheet, read_poses
    from mimoc.render.picture_files import write_picture

    for option, is_given in refused.items():
        if is_given:
            raise MimocError(f"--ages and --poses make a sheet of pictures, without {option}; leave one of them out")
    if len(infants) != 1:
        raise MimocError(f"--ages and --poses draw one infant, and {len(infants)} are given; name one spec or bundle")
    specs = _specs(infants[0], ages)
    first = next(_built(infants[0], specs[:1]))
    names = read_poses(poses, first.manifest) if poses else [first.manifest.pose]
    count = max(len(specs), 1)
    check_count(count, len(names))
    with console.progress("drawing") as show:
        bundles = _built(infants[0], specs, first)
        picture = contact_sheet(bundles, names, size_px, shown, framing, lambda done: show(done, count * len(names)))
    print(printable(write_picture(file, picture)))


def _specs(infant: Path, ages: str | None) -> "list[InfantSpec]":
    """Return the spec of the infant at each age; none without ages."""
    from mimoc.compiler.variants import spec_of

    if ages is None:
        return []
    months = read_ages(ages)
    spec = spec_of(load_infant(infant)) if infant.is_dir() else load_spec(infant)
    return [spec.with_(age_months=age_months) for age_months in months]


def _built(infant: Path, specs: "list[InfantSpec]", first: "Bundle | None" = None) -> "Iterator[Bundle]":
    """Yield the infant, or what each spec describes, one after another; the first may be there already."""
    from mimoc.compiler.pipeline import build

    yield first or (build(specs[0]) if specs else load_infant(infant))
    yield from map(build, specs[1:])


def read_ages(text: str) -> tuple[float, ...]:
    """Return the ages that a list such as `0,3,6` names, in months; a MimocError says what is wrong."""
    from mimoc.schema.quantities import LAST_MONTH

    try:
        months = tuple(map(float, text.split(",")))
    except ValueError:
        months = ()
    if not months or not all(0 <= age_months <= LAST_MONTH for age_months in months):
        raise MimocError(f"'{text}' is not a list of ages; give months from 0 to {LAST_MONTH}, as in 0,3,6,12,24")
    return months
