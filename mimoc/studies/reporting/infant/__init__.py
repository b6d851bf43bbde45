"""The page of an infant."""

from collections.abc import Callable, Mapping

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.studies.reporting import words
from mimoc.studies.reporting.infant.senses import senses
from mimoc.studies.reporting.infant.sources import Sources, origin
from mimoc.studies.reporting.infant.strength import UNCHECKED, beside, stability, strength
from mimoc.studies.reporting.infant.who import growth, introduce, proportions
from mimoc.studies.reporting.page import Page, Section
from mimoc.version import __version__


def infant_page(
    bundle: Bundle,
    progress: Callable[[int, int], None],
    *,
    check: bool,
    counterparts: Mapping[str, Bundle] | None = None,
) -> Page:
    """Return the page of an infant, with a *check* that its simulation is stable or without, and its counterparts."""
    steps = (len(bundle.manifest.poses) if check else 0) + 2  # Poses to check, the other sections, and the portrait.
    progress(0, steps)
    model, sources = load_model(bundle), Sources(bundle)
    size, body, sensed = infant_sections(bundle, model, sources)
    measured = proportions(model, bundle.manifest.child, sources)
    progress(1, steps)
    others = [beside(bundle, other, name) for name, other in (counterparts or {}).items()]
    checked = stability(bundle, lambda done: progress(1 + done, steps)) if check else UNCHECKED
    lead, pictures = introduce(bundle)
    progress(steps, steps)
    return Page(
        kind="An infant, compiled by mimoc",
        title=words.sentence(words.name(bundle.manifest.name)),
        lead=lead,
        sections=(size, measured, body, *others, sensed, checked, sources.section(), origin(bundle)),
        made_by=f"Made by mimoc {__version__}.",
        pictures=pictures,
    )


def infant_sections(bundle: Bundle, model: mujoco.MjModel, sources: Sources) -> tuple[Section, Section, Section]:
    """Return the sections on size, on masses and strength, and on the senses of an infant."""
    size = growth(bundle.manifest.child, sources)
    return size, strength(bundle, model, sources), senses(bundle, model, sources)
