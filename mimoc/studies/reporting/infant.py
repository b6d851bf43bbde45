"""The page of an infant, or of a world with several: who they are, a picture, sizes, and what they can do and touch."""

import base64
import io
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
from PIL import Image

from mimoc.base.errors import RenderingError
from mimoc.base.quantities import AVERAGE, DIFFERENCE, INDICATORS, MEASURED, Quantity
from mimoc.base.units import m_to_cm, ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ChildEntry
from mimoc.bundle.model import load_model
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.compiler.building import build
from mimoc.compiler.manifest import DIFFERS
from mimoc.compiler.measuring import measure_body
from mimoc.compiler.provenance import SCALE_NOT_KNOWN, who_percentiles
from mimoc.compiler.variants import plan_of_bundle, spec_of
from mimoc.fits import load_tables, measure
from mimoc.render.drawing import Drawing, box, draw_svg, line
from mimoc.render.picture_files import Picture as Pixels
from mimoc.render.plots import Dots, Plot
from mimoc.render.portrait import portrait, world_portrait
from mimoc.runtime.check import check_world
from mimoc.runtime.model_fields import Constraints
from mimoc.schema.counterparts import world_counterpart
from mimoc.schema.kinds import TASKS
from mimoc.studies.growth import TOLERANCE
from mimoc.studies.growth_plots import who_chart
from mimoc.studies.reporting import words
from mimoc.studies.reporting.body import UNCHECKED, beside, stability, stability_of, strength
from mimoc.studies.reporting.page import (
    Cell,
    Details,
    Drawings,
    Page,
    Picture,
    Section,
    TextBlock,
    Tile,
    Tiles,
    number,
    table,
)
from mimoc.studies.reporting.senses import senses
from mimoc.studies.reporting.sources import Sources, origin


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
    *about, numbers = infant_sections(bundle, counterparts=counterparts)
    progress(1, steps)
    checked = stability(bundle, lambda done: progress(1 + done, steps)) if check else UNCHECKED
    lead, pictures = introduce(bundle)
    progress(steps, steps)
    return Page(
        kind="An infant, compiled by mimoc",
        title=words.sentence(words.name(bundle.manifest.name)),
        lead=lead,
        sections=(*about, checked, numbers, origin(bundle)),
        pictures=pictures,
    )


def infant_sections(
    bundle: Bundle,
    prefix: str = "",
    counterparts: Mapping[str, Bundle] | None = None,
    *,
    with_proportions: bool = True,
) -> list[Section]:
    """Return the sections on size, perhaps proportions, body, counterparts and senses of an infant, and their sources.

    Places on the page that sources refer to begin with *prefix*.
    """
    model = load_model(bundle)
    sources = Sources(bundle, prefix)
    child = bundle.manifest.child
    return [
        growth(child, sources),
        *([proportions(model, child, sources)] if with_proportions else []),
        strength(bundle, model, sources),
        *(beside(bundle, other, name) for name, other in (counterparts or {}).items()),
        senses(bundle, model, sources),
        sources.section(),
    ]


WIDTH_PX, HEIGHT_PX = 800, 600  # Size of the picture: twice as large as it is shown, for screens with small pixels.
QUALITY = 82  # Quality of the WebP picture, which has some 20 kB.
NOUNS = {"male": "A boy", "female": "A girl", None: "An infant, the mean of boys and girls,"}
POSES = {"standing": "stands", "sitting": "sits", "supine": "lies on its back", "prone": "lies on its belly"}


Introduction = tuple[tuple[str, ...], tuple[Picture, ...]]  # Paragraphs and pictures at the top of a page.


def introduce(bundle: Bundle) -> Introduction:
    """Return what an infant is, where it is and what it is to do, and its picture; none where there is no OpenGL."""
    about = f"{bundle.manifest.name}, {bundle.manifest.pose}"
    draw = partial(portrait, bundle, width=WIDTH_PX, height=HEIGHT_PX)
    return _pictured(tuple(sentences(bundle)), draw, about, "portrait")


def introduce_world(world: WorldBundle) -> Introduction:
    """Return who is in a world, and its picture; none where there is no OpenGL."""
    ages = [
        f"{words.sentence(name)} ({words.age(infant.manifest.child.age_months)})"
        for name, infant in world.infants.items()
    ]
    lead = f"{words.listed(ages)} share one world: they touch, push, see and hear each other."
    draw = partial(world_portrait, world, None, WIDTH_PX, HEIGHT_PX)
    return _pictured((lead,), draw, f"{world.manifest.name}, as it starts", "picture")


def _pictured(lead: tuple[str, ...], draw: Callable[[], Pixels], about: str, what: str) -> Introduction:
    try:
        pixels = draw()
    except RenderingError:
        return (*lead, f"There is no {what}, because there is no OpenGL on the machine that made this page."), ()
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "WEBP", quality=QUALITY, method=6)
    data = f"data:image/webp;base64,{base64.b64encode(buffer.getvalue()).decode()}"
    return lead, (Picture(data, about, str(WIDTH_PX // 2), str(HEIGHT_PX // 2)),)


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
    quantity = INDICATORS[indicator]
    value = getattr(child, indicator)
    text = "this infant has none to measure"
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


SETTLING_S, MEASURED_S = 1.0, 0.5
"""How long infants that command nothing settle, and for how long contacts are measured then."""
MIN_N = 0.01  # Mean force of a contact that is told.
FORCE = Quantity("force_n", "Force", "N")


def world_page(
    world: WorldBundle, progress: Callable[[int, int], None], *, check: bool, counterpart: str | None = None
) -> Page:
    """Return the page of a world, with a *check* that its simulation is stable or without.

    Beside each infant stands its *counterpart*, such as the `healthy` child, if it has one. A BundleError says whose
    spec is not in the bundle.
    """
    steps = len(world.infants) + 2
    progress(0, steps)
    others = world_counterpart(plan_of_bundle(world), counterpart).infants if counterpart else {}
    sections = list[Section]()
    for name, infant in world.infants.items():
        spec = spec_of(infant)
        other = {str(counterpart): build(others[name])} if others.get(name, spec) != spec else {}
        sections.append(infant_section(name, infant, other))
        progress(len(sections), steps)
    touching = contacts(world)
    progress(len(sections) + 1, steps)
    checked = stability_of([check_world(world)]) if check else UNCHECKED
    lead, pictures = introduce_world(world)
    progress(steps, steps)
    return Page(
        kind="A world with several infants, compiled by mimoc",
        title=words.sentence(words.name(world.manifest.name)),
        lead=lead,
        sections=(*sections, touching, checked, origin(world)),
        pictures=pictures,
    )


def infant_section(name: str, infant: Bundle, counterparts: Mapping[str, Bundle] | None = None) -> Section:
    """Return the section on one infant: the parts of the page that it has alone, as it is built alone from its spec."""
    alone = build(spec_of(infant))
    parts = infant_sections(alone, f"{name}-", counterparts)
    lead = TextBlock(" ".join(sentences(alone)))
    title = f"{words.sentence(name)}, {words.age(alone.manifest.child.age_months)}"
    return Section(name, title, (lead, *(Details(part.title, part.blocks) for part in parts)))


def contacts(world: WorldBundle) -> Section:
    """Return the section on what infants that command nothing touch after a while, besides themselves."""
    forces_n = rest_forces(world)
    rows = [
        [Cell(words.sentence(one)), Cell(other), number(words.figure(force_n))]
        for (one, other), force_n in forces_n.items()
        if force_n >= MIN_N
    ]
    about = TextBlock(
        f"Mean normal forces from {SETTLING_S:g} s to {SETTLING_S + MEASURED_S:g} s after the start, while all infants "
        "command nothing. Contacts of an infant with itself are left out."
    )
    blocks = (
        (about, table(("part", "touches", FORCE.heading), rows)) if rows else (about, TextBlock("Nothing touches."))
    )
    return Section("contacts", "What they touch", blocks)


def rest_forces(world: WorldBundle) -> dict[tuple[str, str], float]:
    """Return mean normal forces of the parts of infants on others and on what is around, [N]; first between infants."""
    model = load_world_model(world)
    data, parts = mujoco.MjData(model), _parts(model, world)
    mujoco.mj_resetDataKeyframe(model, data, model.key(world.manifest.pose).id)
    mujoco.mj_kinematics(model, data)
    for infant in world.infants.values():
        Constraints(infant.manifest.constraints, model).keep(data)
    step_s = ms_to_s(world.manifest.timestep_ms)
    sums = defaultdict[tuple[tuple[str, str], tuple[str, str]], float](float)
    count = round(MEASURED_S / step_s)
    mujoco.mj_step(model, data, round(SETTLING_S / step_s))
    wrench = np.empty(6)
    for _ in range(count):
        mujoco.mj_step(model, data)
        for index in range(data.ncon):
            one, other = sorted((parts[geom] for geom in data.contact.geom[index]), key=lambda part: not part[0])
            if one[0] != other[0]:
                mujoco.mj_contactForce(model, data, index, wrench)
                sums[min(one, other) if other[0] else one, max(one, other) if other[0] else other] += wrench[0] / count
    in_order = sorted(sums.items(), key=lambda item: (not item[0][1][0], item[0]))
    return {(one[1], other[1]): force_n for (one, other), force_n in in_order}


Part = tuple[str, str]  # Name of the infant, empty for what is around, and what the part is called.


def _parts(model: mujoco.MjModel, world: WorldBundle) -> list[Part]:
    """Return the part that each geom belongs to."""
    roots = {int(model.body(one.manifest.root_body).rootid[0]): name for name, one in world.infants.items()}
    parts = list[Part]()
    for geom, body in enumerate(model.geom_bodyid.tolist()):
        owner = roots.get(int(model.body_rootid[body]), "")
        part = model.body(body).name
        if owner:
            of_infant = world.infants[owner].manifest.of_infant
            parts.append((owner, f"{words.sentence(owner)}'s {words.name(of_infant(part))}"))
        else:
            parts.append(("", words.name(part if body else model.geom(geom).name)))
    return parts
