"""Reports: one HTML page on an infant, a training run or a cohort, which needs nothing besides itself."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import MimocError
from mimoc.bundle.files import check_page, write_file
from mimoc.bundle.io import LOCK, Bundle
from mimoc.compiler.building import build
from mimoc.compiler.provenance import SPEC_FILE
from mimoc.compiler.worlds import world_of
from mimoc.recording.description import RECORDING
from mimoc.recording.folder import read_infant
from mimoc.schema.counterparts import counterpart
from mimoc.schema.infant import SPEC_SUFFIXES, InfantSpec, load_spec
from mimoc.studies.jobs import Progress
from mimoc.studies.reporting.page import render

if TYPE_CHECKING:
    from mimoc.studies.cohorts.cohort import Cohort

RUN, COHORT = "run.json", "cohort.json"  # Files that are in the folder of a training run, and of a cohort.


@takes(
    "a bundle, a spec, a world, the path of one, or the folder of a training run or a cohort",
    *("Bundle", "InfantSpec", "WorldBundle", "WorldPlan", Mapping, *PATH),
)
def report(
    source: Any,
    path: str | Path,
    *,
    check: bool = True,
    cohort: "Cohort | None" = None,
    progress: Progress | None = None,
    beside: str | None = None,
) -> Path:
    """Write a page on an infant, a world, a training run or a cohort; return its path. The same gives the same bytes.

    Args:
        source: A bundle, its folder, a spec or its file (.yaml, .yml); a world of several infants, in any form that
            `mimoc.make_parallel` takes; the folder of a recording of one infant, such as `mimoc retarget` writes; or
            the folder of a training run or of a cohort.
        path: The page, which ends in .html; an existing one is replaced.
        check: Whether to check that the simulation of an infant or a world is stable, which takes a second or so.
        cohort: The cohort in the folder, so that jobs which are not done yet are counted as well.
        progress: Called with how much is done, and how much there is to do.
        beside: `healthy` also shows where the joints of the same child without what impairs it differ; for a spec, its
            file, or the folder of a bundle; or for a world, of which it shows those that are impaired.

    Raises:
        OutputError: If the page cannot be written there.
        SpecError: If a spec cannot be built.
        BundleError: If a bundle is damaged.
        TrainingError: If the folder of a training run is damaged.
        MissingExtraError: If it is a training run, and `mimoc[train]` is not installed.
        MimocError: If a folder is none of these.

    Example:
        >>> import mimoc
        >>> mimoc.report("out/nine_months", "infant_report.html", check=False).name
        'infant_report.html'
    """
    place = check_page(path)
    show = progress or (lambda done, total: None)
    folder = Path(os.path.expanduser(source)) if isinstance(source, PATH) else None
    kind = next((name for name in (COHORT, RUN) if folder and (folder / name).is_file()), None)
    world = world_of(source) if kind is None and cohort is None else None
    others = {beside: build(counterpart(_spec(source), beside))} if beside and not world else {}
    if world:
        from mimoc.studies.reporting.infant import world_page

        page = world_page(world, show, check=check, counterpart=beside)
    elif folder and kind == COHORT:
        from mimoc.studies.reporting.cohort import cohort_page

        page = cohort_page(folder, cohort, show)
    elif cohort is not None:
        name = folder or repr(source)
        raise MimocError(f"{name}: not the folder of a cohort; name the one given to 'mimoc cohort run'")
    elif folder and kind == RUN:
        from mimoc.studies.reporting.training import training_page

        page = training_page(folder)
    else:
        from mimoc.studies.reporting.infant import infant_page

        page = infant_page(_infant(source, show), show, check=check, counterparts=others)
    return write_file(place, render(page))


def _spec(source: Any) -> InfantSpec:
    if isinstance(source, InfantSpec):
        return source
    place = Path(os.path.expanduser(str(source)))
    file = place / SPEC_FILE if place.is_dir() else place
    if isinstance(source, Bundle) or not file.is_file():
        raise MimocError(f"{source}: 'beside' changes the spec of an infant; give one, its file, or a bundle's folder")
    return load_spec(file)


def _infant(source: Any, progress: Progress) -> Bundle:
    if isinstance(source, Bundle):
        return source
    if isinstance(source, InfantSpec):
        return build(source, progress=progress)
    place = Path(os.path.expanduser(source))
    if place.suffix.lower() in SPEC_SUFFIXES and not place.is_dir():
        return build(load_spec(place), progress=progress)
    kinds = "a folder written by 'mimoc build', 'mimoc train' or 'mimoc cohort run', or a spec that ends in .yaml"
    if not place.exists():
        raise MimocError(f"{place}: there is no such folder; name {kinds}")
    if not any((place / mark).is_file() for mark in (LOCK, RECORDING)):
        raise MimocError(f"{place}: neither an infant, a training run nor a cohort; name {kinds}")
    return read_infant(place)
