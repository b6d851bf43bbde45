"""The page of a world with several infants: each of them, what they touch, and whether the simulation is stable."""

from collections import defaultdict
from collections.abc import Callable, Mapping

import mujoco
import numpy as np

from mimoc.base.errors import RenderingError
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.compiler.pipeline import build
from mimoc.compiler.variants import spec_of
from mimoc.compiler.world_variants import plan_of_bundle
from mimoc.render.portrait import world_portrait
from mimoc.runtime.check import check_world
from mimoc.runtime.constraints import Constraints
from mimoc.schema.counterparts import world_counterpart
from mimoc.studies.reporting import words
from mimoc.studies.reporting.infant import HEIGHT_PX, WIDTH_PX, infant_sections, picture_of, proportions, sentences
from mimoc.studies.reporting.page import Cell, Details, Page, Picture, Section, TextBlock, number, table
from mimoc.studies.reporting.sources import Sources, origin
from mimoc.studies.reporting.strength import UNCHECKED, beside, stability_of
from mimoc.version import __version__

SETTLING_S, MEASURED_S = 1.0, 0.5
"""How long infants that command nothing settle, and for how long contacts are measured then."""
MIN_N = 0.01  # Mean force of a contact that is told.


def world_page(
    world: WorldBundle, progress: Callable[[int, int], None], *, check: bool, counterpart: str | None = None
) -> Page:
    """Return the page of a world, with a *check* that its simulation is stable or without.

    Args:
        world: The world.
        progress: Called with the number of steps done and their total.
        check: Whether to check it.
        counterpart: Which child stands beside each that has one, such as `healthy`.

    Raises:
        ModelError: If MuJoCo rejects its model.
        BundleError: If the spec of an infant is not in the bundle.
        MimocError: If there is no such counterpart.
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
        made_by=f"Made by mimoc {__version__}.",
        pictures=pictures,
    )


def introduce_world(world: WorldBundle) -> tuple[tuple[str, ...], tuple[Picture, ...]]:
    """Return who is in a world, and its picture; none where there is no OpenGL."""
    ages = [
        f"{words.sentence(name)} ({words.age(infant.manifest.child.age_months)})"
        for name, infant in world.infants.items()
    ]
    lead = f"{words.listed(ages)} share one world: they touch, push, see and hear each other."
    try:
        picture = world_portrait(world, None, WIDTH_PX, HEIGHT_PX)
    except RenderingError:
        return (lead, "There is no picture, because there is no OpenGL on the machine that made this page."), ()
    return (lead,), (picture_of(picture, f"{world.manifest.name}, as it starts"),)


def infant_section(name: str, infant: Bundle, counterparts: Mapping[str, Bundle] | None = None) -> Section:
    """Return the section on one infant: the parts of the page that it has alone, as it is built alone from its spec."""
    alone = build(spec_of(infant))
    model, sources = load_model(alone), Sources(alone, f"{name}-")
    size, body, sensed = infant_sections(alone, model, sources)
    measured = proportions(model, alone.manifest.child, sources)
    others = [beside(alone, other, kind) for kind, other in (counterparts or {}).items()]
    parts = (size, measured, body, *others, sensed, sources.section())
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
    blocks = (about, table(("part", "touches", "force [N]"), rows)) if rows else (about, TextBlock("Nothing touches."))
    return Section("contacts", "What they touch", blocks)


def rest_forces(world: WorldBundle) -> dict[tuple[str, str], float]:
    """Return mean normal forces of the parts of infants on others and on what is around, [N]; first between infants."""
    model = load_world_model(world)
    data, parts = mujoco.MjData(model), _parts(model, world)
    mujoco.mj_resetDataKeyframe(model, data, model.key(world.manifest.pose).id)
    mujoco.mj_kinematics(model, data)
    for infant in world.infants.values():
        Constraints(infant.manifest.constraints, model).keep(data)
    step_s, sums = (
        ms_to_s(world.manifest.timestep_ms),
        defaultdict[tuple[tuple[str, str], tuple[str, str]], float](float),
    )
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
        owner, part = roots.get(int(model.body_rootid[body]), ""), model.body(body).name
        if owner:
            of_infant = world.infants[owner].manifest.of_infant
            parts.append((owner, f"{words.sentence(owner)}'s {words.name(of_infant(part))}"))
        else:
            parts.append(("", words.name(part if body else model.geom(geom).name)))
    return parts
