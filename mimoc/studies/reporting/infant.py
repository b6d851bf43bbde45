"""The page of an infant: who it is, its picture, its size on WHO's charts, its measurements, and what it can do."""

import base64
import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import mujoco
from PIL import Image

from mimoc.base.errors import RenderingError
from mimoc.base.quantities.child import AVERAGE, DIFFERENCE, INDICATORS, MEASURED
from mimoc.base.units import m_to_cm
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ChildEntry
from mimoc.bundle.model import load_model
from mimoc.compiler.measuring import measure_body
from mimoc.compiler.notes import DIFFERS
from mimoc.compiler.provenance import SCALE_NOT_KNOWN, who_percentiles
from mimoc.fits import load_tables, measure
from mimoc.render.picture_files import Picture as Pixels
from mimoc.render.plots.drawing import Drawing, box, draw_svg, line
from mimoc.render.plots.plot import Dots, Plot
from mimoc.render.portrait import portrait
from mimoc.schema.kinds import TASKS
from mimoc.studies.growth import TOLERANCE
from mimoc.studies.growth_plots import who_chart
from mimoc.studies.reporting import words
from mimoc.studies.reporting.page import Cell, Drawings, Page, Picture, Section, TextBlock, Tile, Tiles, number, table
from mimoc.studies.reporting.senses import senses
from mimoc.studies.reporting.sources import Sources, origin
from mimoc.studies.reporting.strength import UNCHECKED, beside, stability, strength
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


WIDTH_PX, HEIGHT_PX = 800, 600  # Size of the picture: twice as large as it is shown, for screens with small pixels.
QUALITY = 82  # Quality of the WebP picture, which has some 20 kB.
NOUNS = {"male": "A boy", "female": "A girl", None: "An infant, the mean of boys and girls,"}
POSES = {"standing": "stands", "sitting": "sits", "supine": "lies on its back", "prone": "lies on its belly"}


def introduce(bundle: Bundle) -> tuple[tuple[str, ...], tuple[Picture, ...]]:
    """Return what an infant is, where it is and what it is to do, and its picture; none where there is no OpenGL."""
    lead = tuple(sentences(bundle))
    try:
        pixels = portrait(bundle, width=WIDTH_PX, height=HEIGHT_PX)
    except RenderingError:
        return (*lead, "There is no portrait, because there is no OpenGL on the machine that made this page."), ()
    return lead, (picture_of(pixels, f"{bundle.manifest.name}, {bundle.manifest.pose}"),)


def picture_of(pixels: Pixels, about: str) -> Picture:
    """Return a picture of a page, shape (HEIGHT_PX, WIDTH_PX, 3)."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "WEBP", quality=QUALITY, method=6)
    data = f"data:image/webp;base64,{base64.b64encode(buffer.getvalue()).decode()}"
    return Picture(data, about, str(WIDTH_PX // 2), str(HEIGHT_PX // 2))


def sentences(bundle: Bundle) -> Iterator[str]:
    """Yield what an infant is, where it is, and what it is to do."""
    manifest = bundle.manifest
    child = manifest.child
    length, weight = words.quantity(child.length_cm, "cm"), words.quantity(child.weight_kg, "kg")
    head = words.quantity(child.head_circumference_cm, "cm")
    noun = f"{NOUNS[child.sex]} {words.of_age(child.age_months)}"
    yield f"{noun}, {length} long and {weight} heavy, with a head of {head} around."
    if not child.size_is_known:
        yield words.sentence(f"{SCALE_NOT_KNOWN}.")
    if child.months_early:
        corrected = f"its corrected age, {child.corrected_age_months:.1f} months, counts"
        yield f"It was born {child.months_early:.1f} months early: {corrected}."
    yield from (f"It {note}." for note in manifest.notes if note.startswith(DIFFERS))
    begins = POSES.get(manifest.pose, f'takes the pose "{words.name(manifest.pose)}"')
    toys = f" among {words.count(len(manifest.toys), 'toy')}" if manifest.toys else ""
    yield f"At the start of an episode it {begins}{toys}. {_task(bundle)}"


def _task(bundle: Bundle) -> str:
    kind = bundle.manifest.task.kind
    if kind == "free":
        return "It has no task."
    about = (TASKS[kind].spec.__doc__ or "").strip().splitlines() if kind in TASKS else []
    return f"Its task, {words.name(kind)}: {about[0][:1].lower() + about[0][1:]}" if about else f"Its task: {kind}."


AMONG = {**words.CHILDREN, None: "the mean of boys and girls, since this infant is the mean of both"}


def growth(child: ChildEntry, sources: Sources) -> Section:
    """Return the section on an infant's size."""
    percentiles = who_percentiles(child)
    if not child.size_is_known:
        return Section("size", "Size", (Tiles(tuple(_tiles(child, percentiles, sources))),))
    charts = [draw_svg(_chart(indicator, child, percentiles)) for indicator in load_tables().who]
    caption = (
        f"WHO Child Growth Standards (2006, 2007), {AMONG[child.sex]}. The line is the median; 7 of 10 children "
        "are in the inner band, and 94 of 100 in the outer one. The dot is this infant."
    )
    tiles = Tiles(tuple(_tiles(child, percentiles, sources)))
    return Section("size", "Size", (tiles, Drawings(tuple(charts), caption, "pair")))


def _tiles(child: ChildEntry, percentiles: Mapping[str, float], sources: Sources) -> Iterator[Tile]:
    measures = child.model_dump()
    for indicator, quantity in INDICATORS.items():
        if measures[indicator] is None:
            continue
        text = "WHO has no standard for this age" if child.size_is_known else SCALE_NOT_KNOWN
        if indicator in percentiles:
            text = words.rank(indicator, percentiles[indicator], child.sex, child.corrected_age_months)
        links = sources.links(f"child.{indicator}", f"who.{indicator}.percentile")
        value = words.quantity(measures[indicator], quantity.unit)
        yield Tile(quantity.label, value, f"{words.sentence(text)}.", links)


def _chart(indicator: str, child: ChildEntry, percentiles: Mapping[str, float]) -> Plot:
    quantity, value, text = INDICATORS[indicator], getattr(child, indicator), "this infant has none to measure"
    dots: tuple[Dots, ...] = ()
    if value is not None:
        text = f"{words.quantity(value, quantity.unit)} at {words.age(child.corrected_age_months)}"
        dots = (Dots((child.corrected_age_months,), (value,), "", "infant", (text,), 5.5),)
    if indicator in percentiles:
        text += f", percentile {percentiles[indicator]:.0f}"
    chart = who_chart(indicator, child.sex or "mean", () if value is None else (value,))
    about = f"{quantity.label} by age, WHO percentiles 3 to 97; this infant: {text}"
    return replace(chart, dots=dots, about=about)


BAR_WIDTH, BAR_HEIGHT = 150.0, 14.0
MAX_DEVIATION = 0.12  # Largest deviation that a bar shows, relative to the average.
FAR = "bar-far"

ABOUT = (
    "Taken on the body with tape and calipers, as on children, and compared with the growth curve of the average child "
    "of this age, which is fitted to the AnthroKids survey (Snyder et al. 1977). The shaded middle is ±{tolerance:g} %."
)
UNKNOWN = " The scale is not known: only how these differ from each other is this child's own."


def proportions(model: mujoco.MjModel, child: ChildEntry, sources: Sources) -> Section:
    """Return the section on an infant's measurements."""
    about = ABOUT.format(tolerance=100 * TOLERANCE) + ("" if child.size_is_known else UNKNOWN)
    age_months = child.corrected_age_months
    headings = ("measurement", MEASURED.heading, AVERAGE.heading, DIFFERENCE.heading, "")
    rows = list(_rows(model, age_months, sources))
    return Section("proportions", "Proportions", (TextBlock(about), table(headings, rows)))


def _rows(model: mujoco.MjModel, age_months: float, sources: Sources) -> Iterator[tuple[Cell, ...]]:
    average, surveyed = measure(age_months), load_tables().anthrokids
    for name, value_m in sorted(measure_body(model).items()):
        deviation = value_m / average[name] - 1
        marked = "" if name in surveyed else "*"
        yield (
            Cell(words.sentence(words.name(name)) + marked, links=sources.links(f"measurements.{name}_cm")),
            number(f"{m_to_cm(value_m):.1f}"),
            number(f"{m_to_cm(average[name]):.1f}"),
            number(words.signed(100 * deviation)),
            Cell("", drawings=(_bar(words.name(name), deviation),)),
        )


def _bar(name: str, deviation: float) -> Drawing:
    middle, scale = BAR_WIDTH / 2, BAR_WIDTH / 2 / MAX_DEVIATION
    shown = scale * min(max(deviation, -MAX_DEVIATION), MAX_DEVIATION)
    kind = FAR if abs(deviation) > TOLERANCE else "bar"
    shapes = [
        box(middle - scale * TOLERANCE, 0, 2 * scale * TOLERANCE, BAR_HEIGHT, "tolerance"),
        box(min(middle, middle + shown), 4, abs(shown), BAR_HEIGHT - 8, kind),
        line([(middle, 0), (middle, BAR_HEIGHT)], "axis"),
    ]
    title = f"{name}: {words.signed(100 * deviation)} % from the average child"
    return Drawing(title, (BAR_WIDTH, BAR_HEIGHT), shapes, kind="small")
