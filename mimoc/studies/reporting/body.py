"""An infant's body on a page: its outline, what parts weigh, how strong joints are, and whether it stays stable."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.quantities import BEYOND_LIMITS, BODY_SHARE, ENERGY, JOINT_RANGE, PART_MASS, PEAK_TORQUE
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees, load_model, solid_extents
from mimoc.compiler.measuring import Figure, own_solids
from mimoc.render.drawing import Drawing, Point, Shape, area, dot, label, line
from mimoc.runtime.actuation import torque_limits
from mimoc.runtime.check import CHECKED_S, MAX_BEYOND_DEG, MAX_ENERGY_J_PER_KG, PoseCheck, check_stability
from mimoc.studies.reporting import words
from mimoc.studies.reporting.page import Cell, Details, Drawings, Section, TextBlock, number, table
from mimoc.studies.reporting.sources import Sources

CORNERS = 24  # Corners of the polygon that approximates the outline of a solid.

Points = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Silhouette:
    """The outlines of an infant's solids, those behind first."""

    outlines_m: tuple[Points, ...]  # To the infant's left and up from its soles, shape (corners, 2) each.
    height_m: float
    half_width_m: float  # From its middle to the outermost point on either side.
    figure: Figure  # The posed infant.
    sole_m: float  # Height of its soles in the model.

    def at(self, point_m: Points, scale: float, foot: Point) -> Point:
        """Return where a point of the world, shape (3,), is in a drawing with some units in a metre.

        Its y axis points down, and the middle between the soles is at *foot*.
        """
        return foot[0] + scale * float(point_m[1]), foot[1] - scale * (float(point_m[2]) - self.sole_m)

    def shapes(self, scale: float, foot: Point) -> list[Shape]:
        """Return the drawing of the body; see `at`."""
        return [
            area([(foot[0] + scale * float(y), foot[1] - scale * float(z)) for y, z in outline], "skin")
            for outline in self.outlines_m
        ]


def silhouette(model: mujoco.MjModel) -> Silhouette:
    """Return the outline of the infant in a model, its arms at its sides."""
    figure = Figure(model)
    geoms = own_solids(model)
    rotations = figure.data.geom_xmat[geoms].reshape(-1, 3, 3)
    angles_rad = np.arange(CORNERS) * (2 * math.pi / CORNERS)
    around = np.stack((np.zeros(CORNERS), np.cos(angles_rad), np.sin(angles_rad)), axis=-1)
    local = np.einsum("nij,mi->mnj", rotations, around)
    farthest = solid_extents(model, geoms).farthest(local)
    points_m = figure.data.geom_xpos[geoms] + np.einsum("nij,mnj->mni", rotations, farthest)
    sole_m = float(points_m[..., 2].min())
    flat_m = points_m[..., 1:] - (0.0, sole_m)
    from_behind = np.argsort(figure.data.geom_xpos[geoms, 0], kind="stable")
    return Silhouette(
        outlines_m=tuple(flat_m[:, solid] for solid in from_behind),
        height_m=float(flat_m[..., 1].max()),
        half_width_m=float(np.abs(flat_m[..., 0]).max()),
        figure=figure,
        sole_m=sole_m,
    )


PARTS: Mapping[str, tuple[str, ...]] = {
    "head": ("head", "left_eye", "right_eye"),
    "trunk": ("upper_body", "hip", "lower_body", "chest"),
    "upper arm": ("{side}_upper_arm",),
    "forearm": ("{side}_lower_arm",),
    "hand": ("{side}_hand",),
    "thigh": ("{side}_upper_leg",),
    "lower leg": ("{side}_lower_leg",),
    "foot": ("{side}_foot",),
}
"""Bodies of each part, the one that is pointed at first; those of hands and feet with all that is attached to them."""
WITH_ALL = ("hand", "foot")
JOINTS: Mapping[str, str] = {
    "neck, nodding": "head_tilt",
    "shoulder, up and down": "{side}_shoulder_ad_ab",
    "elbow": "{side}_elbow",
    "trunk, bending": "hip_bend1",
    "wrist": "{side}_hand2",
    "hip, to and fro": "{side}_hip1",
    "knee": "{side}_knee",
    "ankle": "{side}_foot1",
}
WIDTH, HEIGHT = 540.0, 500.0
TOP, FEET = 40.0, 470.0
LEFT_TEXT, RIGHT_TEXT = 165.0, 375.0  # Where the texts at either side end and begin.
APART = 34.0  # Least distance of two texts.
CAPTION = (
    "Left, the peak torque of a joint in either direction; right, the mass of a part and its share of the body. "
    "The outline is drawn from the solids that the simulation uses, seen from the front."
)

Place = Callable[[Points], Point]  # From a point of the model to where it is drawn.


class Note(NamedTuple):
    """A text beside the body, and the point that it is about."""

    at: Point
    name: str
    text: str


def strength(bundle: Bundle, model: mujoco.MjModel, sources: Sources) -> Section:
    """Return the section on the masses of an infant's parts and the strength of its joints."""
    outline = silhouette(model)
    figure = Drawings((_figure(bundle, model, outline),), CAPTION, "wide")
    masses = table(("part", PART_MASS.heading, BODY_SHARE.heading, ""), _mass_rows(bundle, model, sources))
    joints = list(_joint_rows(bundle, model, sources))
    headings = ("joint", PEAK_TORQUE.heading, JOINT_RANGE.heading, "")
    listed = Details("All joints that muscles move", (table(headings, joints),))
    return Section("body", "Masses and strength", (figure, masses, listed))


def _figure(bundle: Bundle, model: mujoco.MjModel, outline: Silhouette) -> Drawing:
    scale = (FEET - TOP) / outline.height_m
    foot = (WIDTH / 2, FEET)
    place = partial(outline.at, scale=scale, foot=foot)
    joints = _spread(_joint_notes(bundle, outline, place))
    parts = _spread(_part_notes(bundle, model, outline, place))
    lines = outline.shapes(scale, foot)
    dots = list[Shape]()
    labels = list[Shape]()
    for notes, edge, side in ((joints, LEFT_TEXT, "end"), (parts, RIGHT_TEXT, "start")):
        for note, y in notes:
            turn = edge + (6 if side == "end" else -6)
            lines.append(line([(turn, y), note.at], "leader"))
            dots.append(dot(note.at, "mark", 2.2))
            labels.append(label((edge, y - 1), note.name, f"strong {side}"))
            labels.append(label((edge, y + 13), note.text, f"small {side}"))
    return Drawing("masses of body parts and peak torques of joints", (WIDTH, HEIGHT), (*lines, *dots, *labels))


def _joint_notes(bundle: Bundle, outline: Silhouette, place: Place) -> Iterator[Note]:
    """Yield what is said of joints of the right side, which is on the left, or of both if they differ."""
    limits = torque_limits(bundle)
    for name, pattern in JOINTS.items():
        sides = [side for side in ("right", "left") if f"robot:{pattern.format(side=side)}" in limits]
        texts = {side: words.torques(limits[f"robot:{pattern.format(side=side)}"]) for side in sides}
        if sides:
            at = place(outline.figure.data.joint(f"robot:{pattern.format(side=sides[0])}").xanchor)
            alike = len(set(texts.values())) == 1
            text = texts[sides[0]] if alike else "; ".join(f"{side} {text}" for side, text in texts.items())
            yield Note(at, words.sentence(name), text)


def _part_notes(bundle: Bundle, model: mujoco.MjModel, outline: Silhouette, place: Place) -> Iterator[Note]:
    """Yield what is said of parts: of the infant's left side, which is on the right, unless it has only the other."""
    total_kg = float(model.body(bundle.manifest.root_body).subtreemass[0])
    known = {model.body(number).name for number in range(model.nbody)}
    for name, sides in _masses(model).items():
        side, mass_kg = next(iter(sides.items()))
        body = next(body for pattern in PARTS[name] if (body := pattern.format(side=side)) in known)
        at = place(outline.figure.data.body(body).xipos)
        weight = words.quantity(mass_kg, "kg") if mass_kg >= 1 else f"{1000 * mass_kg:.0f}{words.THIN_SPACE}g"
        share = f"{100 * mass_kg / total_kg:.1f}{words.THIN_SPACE}%{' each' if len(sides) == 2 else ''}"
        yield Note(at, words.sentence(name), f"{weight}, {share}")


def _spread(notes: Iterable[Note]) -> list[tuple[Note, float]]:
    """Return the notes of one side, from above, each with the height of its text, so that texts do not overlap."""
    ordered = sorted(notes, key=lambda note: note.at[1])
    heights = np.array([note.at[1] for note in ordered])
    for _ in range(200):
        gaps = np.diff(heights) - APART
        if not (gaps < -0.01).any():
            break
        push = np.minimum(gaps, 0.0) / 2
        heights[:-1] += push
        heights[1:] -= push
        heights = np.clip(heights, TOP - 20, HEIGHT - 20)
    return list(zip(ordered, heights.tolist(), strict=True))


def _masses(model: mujoco.MjModel) -> dict[str, dict[str, float]]:
    """Return the mass of each part that an infant has, in [kg], by side; the left one first, the middle is empty."""
    bodies = {model.body(number).name: number for number in range(model.nbody)}
    masses_kg: dict[str, dict[str, float]] = {}
    for part, patterns in PARTS.items():
        for side in ("left", "right") if "{side}" in patterns[0] else ("",):
            ids = [bodies[name] for pattern in patterns if (name := pattern.format(side=side)) in bodies]
            if ids:
                weighed = in_subtrees(model, ids) if part in WITH_ALL else ids
                masses_kg.setdefault(part, {})[side] = float(model.body_mass[weighed].sum())
    return masses_kg


def _mass_rows(bundle: Bundle, model: mujoco.MjModel, sources: Sources) -> Iterator[tuple[Cell, ...]]:
    total_kg = float(model.body(bundle.manifest.root_body).subtreemass[0])
    for part, sides in _masses(model).items():
        alike = len({f"{mass:.6g}" for mass in sides.values()}) == 1 and len(sides) == 2
        for side, mass_kg in list(sides.items())[: 1 if alike else None]:
            name = f"{words.sentence(part)}, each" if alike else words.sentence(f"{side} {part}".strip())
            links = sources.links(*(f"body.{body.format(side=side)}.mass" for body in PARTS[part]))
            share = 100 * mass_kg / total_kg
            yield Cell(name), number(f"{1000 * mass_kg:.0f}"), number(f"{share:.1f}"), Cell("", links=links)
    yield Cell("The whole body"), number(f"{1000 * total_kg:.0f}"), number("100"), Cell("")


def _joint_rows(bundle: Bundle, model: mujoco.MjModel, sources: Sources) -> Iterator[tuple[Cell, ...]]:
    """Yield a row for each joint, one for both sides where they are alike."""
    actuators: dict[str, list[str]] = {}
    for actuator in bundle.manifest.actuation.actuators:
        actuators.setdefault(actuator.joint, []).append(actuator.name)
    rows: dict[tuple[str, ...], list[str]] = {}
    for joint, texts in _joints(bundle, model).items():
        unsided = joint.removeprefix("robot:").replace("left_", "").replace("right_", "")
        rows.setdefault((unsided, *texts), []).append(joint)
    for (name, torques, reach), joints in rows.items():
        sides = "" if len(joints) == 2 else next((s for s in ("left ", "right ") if f"{s[:-1]}_" in joints[0]), "")
        keys = [f"actuator.{actuator}.gear" for actuator in actuators.get(joints[0], ())]
        links = sources.links(*keys, f"joint.{joints[0]}.range")
        yield Cell(words.sentence(sides + words.name(name))), number(torques), number(reach), Cell("", links=links)


ABOUT = (
    "From each pose, {seconds:g} s of random commands and {seconds:g} s of commands that drive all joints to and fro "
    "at full strength. A simulation is stable if MuJoCo gives no warning, the kinetic energy stays below {energy:g} J "
    "per kg, and joints go no more than {beyond:g}° beyond their soft limits."
)
UNCHECKED = Section("stability", "Stability", (TextBlock("Not checked for this page. mimoc check does it.", "note"),))


def stability(bundle: Bundle, progress: Callable[[int], None]) -> Section:
    """Return the section on the stability of an infant; *progress* is told how many poses are checked."""
    checks: list[PoseCheck] = []
    for check in check_stability(bundle):
        checks.append(check)
        progress(len(checks))
    return stability_of(checks)


def stability_of(checks: Sequence[PoseCheck]) -> Section:
    """Return the section on the stability that checks showed."""
    about = ABOUT.format(seconds=CHECKED_S, energy=MAX_ENERGY_J_PER_KG, beyond=MAX_BEYOND_DEG)
    headings = ("pose", "result", "warnings", ENERGY.heading, BEYOND_LIMITS.heading, "")
    return Section("stability", "Stability", (TextBlock(about), table(headings, map(_row, checks))))


def _row(check: PoseCheck) -> tuple[Cell, ...]:
    return (
        Cell(words.sentence(check.pose)),
        Cell("stable", "good") if check.passed else Cell("not stable", "bad"),
        Cell(", ".join(check.warnings) or "none"),
        number(words.figure(check.energy_j_per_kg, 2)),
        number(f"{check.beyond_deg:.0f}"),
        Cell(words.name(check.joint.removeprefix("robot:"))),
    )


def beside(bundle: Bundle, other: Bundle, name: str) -> Section:
    """Return the section on an infant beside its counterpart, such as the `healthy` one, a row for each joint."""
    headings = ("joint", PEAK_TORQUE.heading, name, JOINT_RANGE.heading, name)
    here, there = (_joints(one, load_model(one)) for one in (bundle, other))
    rows = list(_rows(here, there))
    if not rows:
        text = "Strength and range of all joints are the same; what differs is sensed, or is said by 'mimoc explain'."
        return Section("beside", f"Beside the {name} child", (TextBlock(text),))
    said = "Joints that differ; of all others, either side is as strong and moves as far."
    return Section("beside", f"Beside the {name} child", (TextBlock(said), table(headings, rows)))


def _joints(bundle: Bundle, model: mujoco.MjModel) -> dict[str, tuple[str, str]]:
    """Return peak torques and range of each joint, as they are shown."""
    joints = {}
    for joint, limits_nm in torque_limits(bundle).items():
        low, high = (words.signed(math.degrees(limit), 0) for limit in model.joint(joint).range)
        joints[joint] = (words.torques(limits_nm), f"{low} to {high}")
    return joints


def _rows(one: Mapping[str, tuple[str, str]], other: Mapping[str, tuple[str, str]]) -> Iterator[tuple[Cell, ...]]:
    """Yield a row for each joint that differs, in the order of the joints, left and right below each other."""
    for joint in other:
        before, now = other[joint], one.get(joint, ("not there", ""))
        if before != now:
            name = Cell(words.sentence(words.name(joint.removeprefix("robot:"))))
            yield name, number(now[0]), number(before[0]), number(now[1]), number(before[1])
