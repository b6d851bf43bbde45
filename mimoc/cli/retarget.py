"""`mimoc retarget`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.base.errors import MimocError, counted
from mimoc.base.kinds import announced
from mimoc.cli.arguments import load_spec
from mimoc.cli.points import (
    Infant,
    MinScore,
    Names,
    Picture,
    Rate,
    UpAxis,
    ViewName,
    names_of,
    options_in_messages,
    picture_of,
)
from mimoc.cli.terminal import printable
from mimoc.schema.components.motion import FORMATS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mimoc.motion.point_recording import Camera
    from mimoc.movement.retargeting.result import Account, Interval, Retargeted

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""
MOST_NAMED = 6
"""Joints that a line of the summary names."""
_FORMATS = ", ".join((*FORMATS, *announced("mimoc.motion")))
PointsPath = Annotated[
    Path, typer.Argument(metavar="RECORDING", help="File or folder of points on a filmed infant; see `--format`.")
]
Format = Annotated[str | None, typer.Option(help=f"Format of the recording, if it is not recognised: {_FORMATS}.")]
CameraText = Annotated[
    str | None,
    typer.Option(metavar="FX,FY,CX,CY,W,H", help="Focal lengths, centre and size of its pictures, in pixels."),
]
Height = Annotated[
    float | None,
    typer.Option(metavar="M", min=0.1, help="Height of the camera above the floor, measured to millimetres."),
]
Pitch = Annotated[
    float | None,
    typer.Option(
        metavar="DEG",
        min=0.1,
        max=90,
        help="Angle by which the camera looks down, below the horizon: 90 is straight down. Default: straight down,"
        " unless the trunk is clearly foreshortened.",
    ),
]


def retarget(
    recording: PointsPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder to write.")],
    age: Annotated[
        float | None, typer.Option(metavar="MONTHS", min=0, max=24, help="Age; required, unless a spec gives it.")
    ] = None,
    spec: Annotated[
        Path | None,
        typer.Option(metavar="SPEC", help="Child to begin with (.yaml); its length, if it is given, fixes the scale."),
    ] = None,
    rate: Rate = None,
    format: Format = None,
    camera: CameraText = None,
    height: Height = None,
    camera_pitch: Pitch = None,
    pose: Annotated[str | None, typer.Option(help="How the infant lies: supine or prone.")] = None,
    infant: Infant = None,
    view: ViewName = "front",
    name: Names = None,
    min_score: MinScore = None,
    picture: Picture = None,
    up: UpAxis = None,
    senses: Annotated[
        str | None, typer.Option(help="Senses of the child, with commas between, such as proprioception,touch,vision.")
    ] = None,
    actuation: Annotated[str | None, typer.Option(help="What moves it: torque, muscle or position.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier result in OUT.")] = False,
) -> None:
    """Put a filmed infant on its own body: fit a child and its motion to recorded points.

    OUT is a recording: `mimoc view OUT` shows the child beside its points, `mimoc run OUT --policy motion` replays the
    motion by the infant's own strength. Ctrl-C keeps the best motion so far.
    """
    from mimoc.cli import console
    from mimoc.motion.reading import read_points
    from mimoc.movement.retargeting.folder import altered, check_writable, write_retargeted
    from mimoc.movement.retargeting.retarget import retarget as fit

    check_writable(out, force)
    if age is None and not spec:
        raise MimocError(f"{recording}: how old the infant is, is not known; give its age with --age, or a --spec")
    start = load_spec(spec) if spec else None
    who = {"infant": infant, "view": view, "names": names_of(name), "min_score": min_score}
    place = {"camera": camera_of(camera), "picture_px": picture_of(picture), "up": up}
    with options_in_messages():
        points = read_points(recording, format=format, rate_hz=rate, **place, **who)
    with console.progress("fitting") as show, options_in_messages():
        known = {"camera_height_m": height, "camera_pitch_deg": camera_pitch, "pose": pose}
        fitted = fit(points, age, start, **known, progress=show)
    result = altered(fitted, senses.split(",") if senses else None, actuation)
    with console.progress("writing") as show:
        write_retargeted(result, out, force=force, progress=show)
    print_account(result)
    print(printable(out))
    if is_unfinished(result):
        print(printable(f"stopped; {out} has the best motion so far"), file=sys.stderr)
        raise typer.Exit(INTERRUPTED)


def camera_of(text: str | None) -> "Camera | None":
    """Return the camera in a text of six numbers, or None for none."""
    if text is None:
        return None
    from mimoc.motion.point_recording import Camera

    try:
        fx, fy, cx, cy, width, height = (float(word) for word in text.split(","))
        if not (fx > 0 and fy > 0 and width > 0 and height > 0 and abs(cx) < float("inf") and abs(cy) < float("inf")):
            raise ValueError
    except ValueError:
        example = "give FX,FY,CX,CY,W,H in pixels, such as 589,590,322,237,640,480"
        raise MimocError(f"--camera: '{text}' is not a camera; {example}") from None
    return Camera((fx, fy), (cx, cy), (round(width), round(height)))


def is_unfinished(result: "Retargeted") -> bool:
    """Return whether Ctrl-C ended a fit."""
    from mimoc.movement.retargeting.fitting import INTERRUPTED as NOTE

    return NOTE in result.account.notes


def print_account(result: "Retargeted") -> None:
    """Print what came of a fit, and what is not known."""
    account, child = result.account, result.bundle.manifest.child
    share, worst = 100 * account.error_median / account.trunk, 100 * account.error_p95 / account.trunk
    error = f"{share:.2f} % of the trunk (median), {worst:.1f} % (95th percentile)"
    rate = account.frames / max(account.seconds, 1e-9)
    _line("recording", f"{counted(account.frames, 'frame')}, {result.rate_hz:g} a second")
    _line("error", error)
    _line("fitted in", f"{account.seconds:.1f} s, {rate:.0f} frames a second")
    known = "overall size is known" if account.size_is_known else "scale not known: the average child's size was taken"
    _line("child", f"{child.age_months:g} months, {child.length_cm:.1f} cm; {known}")
    for name, interval in account.lengths_m.items():
        _line(f"  {name}", f"{100 * interval.value:.1f} cm ({_range(interval, 100, 1)})")
    if interval := account.camera_height_m:
        _line("camera", f"{interval.value:.2f} m above the floor ({_range(interval, 1, 2)})")
    if (pitch := account.camera_pitch_deg) and pitch.value < 90:
        _line("  looks down", f"{pitch.value:.0f}° below the horizon ({_range(pitch, 1, 0)})")
    _print_joints(account)
    for note in account.notes:
        print(printable(f"note: {note}"), file=sys.stderr)


def _range(interval: "Interval", scale: float, decimals: int) -> str:
    from mimoc.movement.retargeting.result import LEVEL

    low, high = scale * interval.low, scale * interval.high
    return f"{LEVEL:.0%}: {low:.{decimals}f} to {high:.{decimals}f}".replace("%", " %")


def _print_joints(account: "Account") -> None:
    deviations = sorted(account.angle_sd_deg.items(), key=lambda item: -item[1])
    known = [(name, f"{value:.0f}°") for name, value in deviations if name not in account.unseen]
    _line("least known", _named(known))
    _line("not seen", _named([(name, "") for name in account.unseen]))
    touched = sorted(account.limits_touched.items(), key=lambda item: -item[1])
    _line("at its limit", _named([(name, f"{share:.0%}") for name, share in touched]))


def _named(joints: "Sequence[tuple[str, str]]") -> str:
    """Return the first of some joints, each with a number, and how many there are besides."""
    words = [f"{name.removeprefix('robot:')} {number}".rstrip() for name, number in joints[:MOST_NAMED]]
    more = f" and {len(joints) - MOST_NAMED} more" if len(joints) > MOST_NAMED else ""
    return ", ".join(words) + more if words else "none"


def _line(what: str, text: str) -> None:
    print(printable(f"{what:15} {text}"))
