"""Stick figures of recordings side by side, as an animation: a recorded infant beside a simulated one."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from mimoc.base.errors import MovementError
from mimoc.base.movement_quantities import CORE
from mimoc.base.quantities import Quantity
from mimoc.motion.labels import BONES
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.filming import Filmed
from mimoc.movement.measured import joint_angles
from mimoc.movement.measures import MIN_RATE_HZ
from mimoc.movement.report import MovementMeasures
from mimoc.recording.video import Picture, open_video
from mimoc.render.picture_files import tile_pictures
from mimoc.render.plots import Band, Dots, Line, Plot, Sheet, write_sheet

COLUMNS, PANEL_PX = 7, (390, 300)
PHASE_PX = 420, 400
MAX_PHASES = 12
INFANT = Quantity("infant", "Infant", about="Which of the infants that were measured", steps=())
HIP = Quantity("hip_deg", "Angle of the hip", "°", "between trunk and thigh; 180 if straight", steps=())
KNEE = Quantity("knee_deg", "Angle of the knee", "°", "between thigh and shank; 180 if straight", steps=())


def write_measures(measured: MovementMeasures, path: str | Path) -> None:
    """Draw the 21 measures, a plot each: a dot for every infant, and a band of the sample's mean +- 2 SD.

    Raises an OutputError or MissingExtraError if the file cannot be written or matplotlib is missing.
    """
    caption = ""
    if measured.distance is not None and measured.sample:
        caption = f"Distance of the mean to {measured.sample.name}: {measured.distance:.2f}"
    plots = tuple(_measure(measured, quantity) for quantity in CORE)
    write_sheet(Sheet(plots, COLUMNS, PANEL_PX, caption, shared_legend=True), path)


def _measure(measured: MovementMeasures, quantity: Quantity) -> Plot:
    values = [one[quantity.name] for one in measured.infants]
    ends, bands, shown = (0.5, len(values) + 0.5), (), list(values)
    if measured.sample:
        mean, deviation = (part[quantity.name] for part in (measured.sample.means, measured.sample.deviations))
        low, high = mean - 2 * deviation, mean + 2 * deviation
        narrow = Band(ends, (mean - deviation,) * 2, (mean + deviation,) * 2, "mean ± 1 SD", "window")
        bands = (Band(ends, (low,) * 2, (high,) * 2, "mean ± 2 SD", "band"), narrow)
        shown = [*values, low, high]
    room = 0.08 * (max(shown) - min(shown) or 1.0)
    dots = Dots([*range(1, len(values) + 1)], values, "measured", "row")
    y_range = (min(shown) - room, max(shown) + room)
    return Plot(INFANT, quantity, bands=bands, dots=(dots,), x_range=ends, x_ticks=(), y_range=y_range)


def write_phases(films: Sequence[Filmed], path: str | Path) -> None:
    """Draw the angle of the knee over that of the hip, a plot for each infant, a line for each leg.

    Raises a MovementError if no infant's points are known in space, and what `write_measures` does.
    """
    plots = []
    for film in films[:MAX_PHASES]:
        angles = joint_angles(film.space or film.seen)
        if angles:
            lines = tuple(Line(angles[f"{side}_hip"], angles[f"{side}_knee"], side) for side in ("left", "right"))
            plots.append(Plot(HIP, KNEE, lines, title=film.seen.name))
    if not plots:
        raise MovementError("--phase needs angles of hip and knee: simulated infants, or points in space")
    write_sheet(Sheet(tuple(plots), min(4, len(plots)), PHASE_PX), path)


FRAMES_HZ = 15
TRUNKS, RAISED = 3.4, 0.2
"""Width and height of the view, and how far its middle is above the hips, in lengths of the trunk."""
SHARP = 2  # Pictures are drawn in so many times their size, and reduced.
TRAIL_S = 0.7  # Time over which ends of limbs leave a trail.
COLOURS = {"left": (51, 102, 154), "right": (200, 67, 31), "": (70, 70, 70)}
"""Colours of the left and of the right side, which colour-blind readers can distinguish, and of the middle."""
TRAIL_COLOUR = (214, 214, 214)
ENDS = "left_hand", "right_hand", "left_foot", "right_foot"
MAX_FIGURES = 12


def animate(
    recordings: Sequence[PointRecording],
    file: str | Path,
    titles: Sequence[str] = (),
    *,
    seconds: float | None = None,
    columns: int = 0,
    size_px: int = 300,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Path:
    """Write recordings of points side by side as an animated GIF (or, with PyAV, an MP4); return its path.

    Every infant is drawn in the same size with its head up; left is blue, right is red, ends of limbs leave a grey
    trail. Points that are not seen are left out.

    Args:
        recordings: At most 12, of any rates; those of points in space are drawn as from above.
        file: The file to write.
        titles: What stands above each; by default their names.
        seconds: Length; by default that of the shortest.
        columns: Figures in a row; 0 is all.
        size_px: Width and height of each figure.
        progress: Called with the number of frames done and their total.

    Raises:
        MovementError: If there are no recordings or too many, or one has no trunk.
        OutputError: If the file cannot be written.
    """
    if not 0 < len(recordings) <= MAX_FIGURES:
        raise MovementError(f"{len(recordings)} recordings to draw; choose 1 to {MAX_FIGURES}")
    longest = min(recording.frames / recording.rate_hz for recording in recordings)
    frames = max(1, int(min(seconds or longest, longest) * FRAMES_HZ))
    figures = [_StickFigure(recording, size_px) for recording in recordings]
    captions = tuple(titles) or tuple(recording.name for recording in recordings)
    across = columns or len(figures)
    video = open_video(file, Fraction(FRAMES_HZ))
    try:
        for frame in range(frames):
            drawn = [figure.draw(frame / FRAMES_HZ) for figure in figures]
            rows = [
                tile_pictures([drawn[first : first + across]], captions[first : first + across])
                for first in range(0, len(drawn), across)
            ]
            video.add(_stacked(rows))
            progress(frame + 1, frames)
        return video.save()
    except BaseException:
        video.discard()
        raise


class _StickFigure:
    """One infant, whose points are placed in a square picture with the trunk upright on average."""

    def __init__(self, recording: PointRecording, size_px: int):
        self._size_px, self._rate_hz, names = size_px, recording.rate_hz, recording.names
        missing = [name for name in ("neck", "left_hip", "right_hip") if name not in names]
        if missing:
            raise MovementError(f"{recording.name}: has no {', '.join(missing)}, without which it cannot be drawn")
        is_known = recording.rate_hz >= MIN_RATE_HZ
        self._places = _upright(recording.smoothed() if is_known else recording.filled()) * size_px * SHARP / TRUNKS
        self._places += size_px * SHARP * np.array([0.5, 0.5 + RAISED / TRUNKS])
        self._seen = np.isfinite(self._places).all(axis=-1) & (recording.confidence > 0)
        index = {name: number for number, name in enumerate(names)}
        self._bones = [(index[a], index[b], _colour(b)) for a, b in _bones_of(names)]
        self._colours = [_colour(name) for name in names]
        self._ends = [index[name] for name in ENDS if name in index]

    def draw(self, time_s: float) -> Picture:
        """Return the picture of a moment, shape (size, size, 3)."""
        frame = min(round(time_s * self._rate_hz), len(self._places) - 1)
        canvas = Image.new("RGB", (SHARP * self._size_px, SHARP * self._size_px), "white")
        pen = ImageDraw.Draw(canvas)
        width = max(2, self._size_px * SHARP // 75)
        start = max(0, frame - round(TRAIL_S * self._rate_hz))
        for end in self._ends:
            trail = self._places[start : frame + 1, end][self._seen[start : frame + 1, end]]
            if len(trail) > 1:
                pen.line([*map(tuple, trail.tolist())], TRAIL_COLOUR, width // 2, joint="curve")
        places, seen = self._places[frame], self._seen[frame]
        for first, last, colour in self._bones:
            if seen[first] and seen[last]:
                pen.line([*map(tuple, places[[first, last]].tolist())], colour, width)
        joints = {point for first, last, _ in self._bones for point in (first, last) if seen[point]}
        for point in sorted(joints):
            x, y = places[point].tolist()
            pen.ellipse([x - width, y - width, x + width, y + width], self._colours[point])
        return np.asarray(canvas.resize((self._size_px, self._size_px), Image.Resampling.LANCZOS))


def _upright(recording: PointRecording) -> FloatArray:
    """Return places in trunk lengths from the mean of the hips, shape (t, k, 2), x to the right and y downwards.

    The picture is turned so that the mean direction from the hips to the neck points upwards.
    """
    flat = np.array(recording.positions[..., :2])
    if recording.unit == "m":
        flat[..., 1] *= -1  # World y points away from who looks down at x to the right.
    hips = np.nanmean([flat[:, recording.names.index(f"{side}_hip")] for side in ("left", "right")], axis=0)
    up = np.nanmean(flat[:, recording.names.index("neck")] - hips, axis=0)
    length = float(np.linalg.norm(up))
    if not length > 0:
        raise MovementError(f"{recording.name}: its trunk has no length; check the names of the points")
    along = up / length
    turned = np.array([[-along[1], along[0]], [-along[0], -along[1]]])  # Takes `along` to (0, -1).
    return (flat - np.nanmean(hips, axis=0)) @ turned.T / length


def _bones_of(names: Sequence[str]) -> list[tuple[str, str]]:
    """Return the bones between some points; those that skip a wrist or an ankle only where it is not known."""
    skipped = {("elbow", "hand"): "wrist", ("knee", "foot"): "ankle"}
    bones = []
    for first, last in BONES:
        side = last.partition("_")[0]
        between = skipped.get((first.partition("_")[2], last.partition("_")[2]))
        if first in names and last in names and f"{side}_{between}" not in names:
            bones.append((first, last))
    return bones


def _colour(point: str) -> tuple[int, int, int]:
    side = point.partition("_")[0]
    return COLOURS.get(side, COLOURS[""])


def _stacked(rows: Sequence[Picture]) -> Picture:
    width = max(row.shape[1] for row in rows)
    return np.concatenate(
        [np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0)), constant_values=255) for row in rows]
    )
