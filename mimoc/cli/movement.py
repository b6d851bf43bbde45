"""`mimoc movement` and `mimoc retarget`: filmed infants, and how real and simulated ones move."""

import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import mimoc
from mimoc.base.errors import MimocError, RecordingError, counted
from mimoc.base.kinds import announced
from mimoc.cli.arguments import Beside, load_counterpart, load_spec
from mimoc.cli.pictures import parse_seeds
from mimoc.cli.run import POLICY_NAMES
from mimoc.cli.terminal import printable
from mimoc.schema.kinds import FORMATS

if TYPE_CHECKING:
    from mimoc.motion.point_recording import Camera
    from mimoc.movement.filming import Filmed, Progress, SourceOptions
    from mimoc.movement.retargeting.result import Account, Interval, Retargeted

Rate = Annotated[
    float | None,
    typer.Option("--rate", metavar="HZ", min=0.1, help="Frames per second of points, if their files lack it."),
]
Infant = Annotated[str | None, typer.Option(metavar="ID", help="Which person is the infant; default: the largest.")]
MinScore = Annotated[
    float | None,
    typer.Option(
        "--min-score",
        metavar="0-1",
        min=0,
        max=1,
        help="Confidence below which points are taken not to be seen; default: what their format's own programs use.",
    ),
]
ViewName = Annotated[
    str,
    typer.Option(
        metavar="VIEW",
        help="What the camera sees: the infant's front; its back, if it lies on its belly; mirrored, if the picture is"
        " or y counts upwards; swapped, if left is right.",
    ),
]
Picture = Annotated[
    str | None,
    typer.Option(metavar="W,H", help="Size of the picture in pixels, if points are shares of it, as MediaPipe's are."),
]
UpAxis = Annotated[
    str | None,
    typer.Option(
        "--up", metavar="AXIS", help="Axis that points upwards, of points in space: x, y, z, -x, -y or -z; default: z."
    ),
]
Names = Annotated[
    list[str] | None,
    typer.Option(
        "--name", metavar="LABEL=POINT", help="Which point a label is, if mimoc does not know it; may be repeated."
    ),
]
_OPTIONS = (
    (r"\brate_hz=(\S+)", r"--rate \1"),
    (r"\bmin_score=(\S+)", r"--min-score \1"),
    (r"\bview='(\w+)'", r"--view \1"),
    (r"\bup='(-?\w)'", r"--up \1"),
    (r"\binfant='([^']*)'", r"--infant \1"),
    (r"\bpicture_px=\((\d+), (\d+)\)", r"--picture \1,\2"),
    (r"\bcamera_pitch_deg=", "--camera-pitch "),
    (r"\bpose='(\w+)'", r"--pose \1"),
    (r"\bnames=\{'label': '(\w+)'\}", r"--name label=\1"),
)
"""Arguments of `read_points` and `retarget` in messages, and the options that stand for them."""


def names_of(texts: Sequence[str] | None) -> dict[str, str] | None:
    """Return the names of points by label in texts such as `p7=left_foot`, or None for none."""
    pairs = [text.rpartition("=") for text in texts or ()]
    for label, _, point in pairs:
        if not label or not point:
            raise MimocError(f"--name: '{label or point}' is no label with its point; write it as p7=left_foot")
    return {label: point for label, _, point in pairs} or None


def picture_of(text: str | None) -> tuple[int, int] | None:
    """Return width and height in a text such as `1920,1080`, or None for none."""
    if text is None:
        return None
    match = re.fullmatch("([1-9][0-9]{0,5})[,x]([1-9][0-9]{0,5})", text.replace(" ", ""))
    if match is None:
        raise MimocError(f"--picture: '{text}' is not the size of a picture; give W,H in pixels, such as 1920,1080")
    return int(match[1]), int(match[2])


@contextmanager
def options_in_messages() -> Iterator[None]:
    """Let errors about recorded points name the options of a command instead of the arguments of `read_points`."""
    try:
        yield
    except RecordingError as error:
        text = str(error)
        for argument, option in _OPTIONS:
            text = re.sub(argument, option, text)
        raise RecordingError(text) from None


Source = Annotated[
    Path,
    typer.Argument(
        metavar="RECORDING|RUN|COHORT|INFANT",
        help="Recorded points of a filmed infant; a folder written with --record or by `mimoc retarget`; a folder of "
        "such, or of a cohort whose steps record; or a bundle or a spec, with --policy.",
    ),
]
Against = Annotated[
    str | None, typer.Option(metavar="real|PATH", help="Compare with 12 real infants, or with recordings of your own.")
]
PolicyName = Annotated[
    str | None,
    typer.Option(metavar="NAME", help=f"How a bundle or a spec moves: {POLICY_NAMES}; or a trained policy.zip."),
]
Phase = Annotated[Path | None, typer.Option(metavar="FILE", help="Plot knees over hips, if points are known in space.")]
REAL, FRONT, SEEDS = "real", "front", "0:12"
SIMULATED = "is for an infant that is simulated; name a spec or a bundle, and its --policy, or leave it out"
NO_POINTS = "says how points are read, which mimoc did not write itself, and there are none here; leave it out"
MAX_ANIMATED = 2  # Simulated or measured infants that are animated beside one of those they are compared with.


def movement(
    source: Source,
    against: Against = None,
    policy: PolicyName = None,
    seeds: Annotated[
        str | None, typer.Option(metavar="FIRST:END", help="Its seeds; END is excluded.", show_default=SEEDS)
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(min=2, max=3600, help="How long it moves for each.", show_default="33")
    ] = None,
    rate: Rate = None,
    infant: Infant = None,
    view: ViewName = FRONT,
    name: Names = None,
    min_score: MinScore = None,
    picture: Picture = None,
    up: UpAxis = None,
    beside: Beside = None,
    full: Annotated[bool, typer.Option("--full", help="Print all measures, not only the 21.")] = False,
    json: Annotated[Path | None, typer.Option(metavar="FILE", help="Write all as JSON.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Plot the 21 measures: .png, .svg ...")] = None,
    phase: Phase = None,
    gif: Annotated[Path | None, typer.Option(metavar="FILE", help="Animate stick figures: .gif or .mp4.")] = None,
) -> None:
    """Measure how infants move, real or simulated, and compare them with real infants or with others."""
    from mimoc.cli import console
    from mimoc.cli.tables import print_movement_measures
    from mimoc.movement import filming
    from mimoc.movement.report import measure_all
    from mimoc.policies.class_policy import class_or_text

    _check_files(json, plot, phase, gif)
    if against and against != REAL and not Path(against).exists():
        raise MimocError(f"{against}: does not exist; compare with `{REAL}`, or name recordings")
    if not policy:
        _refuse({"beside": beside, "seeds": seeds, "seconds": seconds}, SIMULATED)
    if not any(filming.reads_points(path) for path in (source, Path(against or REAL)) if str(path) != REAL):
        of_points = {"rate": rate, "infant": infant, "view": view != FRONT or None, "name": name}
        _refuse({**of_points, "min-score": min_score, "picture": picture, "up": up}, NO_POINTS)
    chosen = mimoc.load_policy(policy) if policy and policy.endswith(".zip") else class_or_text(policy or "") or None
    reading = {"rate_hz": rate, "infant": infant, "view": view, "names": names_of(name), "min_score": min_score}
    reading |= {"picture_px": picture_of(picture), "up": up}
    options = filming.SourceOptions(chosen, parse_seeds(seeds or SEEDS), seconds or filming.SECONDS, reading)
    others = {beside: load_counterpart(source, beside)} if beside else {}
    with console.progress("simulating") as show, options_in_messages():
        films = filming.films_in(source, options, show)
        filmed = {name: filming.films_of(other, options, show) for name, other in others.items()}
    sample = _recordings(against, options) if against and against != REAL else []
    with console.progress("measuring") as show:
        counterparts = {name: measure_all(some, show) for name, some in filmed.items()}
        measured = replace(_measured(films, against, sample, show), beside=counterparts)
    print_movement_measures(measured, full)
    _write(measured, films, sample, (json, plot, phase, gif))


def _refuse(given: dict[str, object], reason: str) -> None:
    for name, value in given.items():
        if value is not None:
            raise MimocError(f"--{name} {reason}")


def _measured(films: "list[Filmed]", against: str | None, others: "list[Filmed]", show: "Progress") -> Any:
    import numpy as np

    from mimoc.movement.report import compare, measure_all
    from mimoc.movement.sample import real_infants

    if against is None:
        return measure_all(films, show)
    sample = [film.seen for film in others] or real_infants()
    return compare(films, sample, np.random.default_rng(0), show)


def _recordings(path: str, options: "SourceOptions") -> "list[Filmed]":
    from mimoc.cli import console
    from mimoc.movement import filming

    with console.progress("reading") as show, options_in_messages():
        others = filming.films_in(Path(path), replace(options, policy=None), show)
    if len(others) < 2:
        raise MimocError(f"{path}: one infant is no sample; name a folder with recordings of two or more")
    return others


def _check_files(json: Path | None, plot: Path | None, phase: Path | None, gif: Path | None) -> None:
    """Refuse, before anything takes time, names that no picture can have and folders that do not exist."""
    from mimoc.recording.video import check_video
    from mimoc.render import plots

    for path in (plot, phase):
        if path:
            plots.check_plot_name(path)
            plots.require_matplotlib()
    if gif:
        check_video(gif)
    for path in (json, plot, phase):
        if path and not path.expanduser().parent.is_dir():
            raise MimocError(f"{path}: there is no folder {path.parent}; create it, or choose another file")


def _write(measured: Any, films: "list[Filmed]", others: "list[Filmed]", paths: tuple[Path | None, ...]) -> None:
    from mimoc.base.rounding import render_json
    from mimoc.bundle.files import write_file
    from mimoc.cli import console
    from mimoc.movement.stick_figures import MAX_FIGURES, animate, write_measures, write_phases

    json, plot, phase, gif = paths
    if phase:
        write_phases(films, phase)  # The only one that may refuse, so the first.
    if json:
        write_file(json, render_json(measured.to_data()))
    if plot:
        write_measures(measured, plot)
    if gif:
        chosen = [film.seen for film in (*others[:MAX_ANIMATED], *films)][:MAX_FIGURES]
        with console.progress("drawing") as show:
            animate(chosen, gif, columns=min(4, len(chosen)), progress=show)
    for path in paths:
        if path:
            print(printable(path))


INTERRUPTED = 130  # Exit code after Ctrl-C, as shells have it.
MAX_NAMED = 6  # Joints that a line of the summary names.
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
    share = 100 * account.error_median / account.trunk
    worst = 100 * account.error_p95 / account.trunk
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
    words = [f"{name.removeprefix('robot:')} {number}".rstrip() for name, number in joints[:MAX_NAMED]]
    more = f" and {len(joints) - MAX_NAMED} more" if len(joints) > MAX_NAMED else ""
    return ", ".join(words) + more if words else "none"


def _line(what: str, text: str) -> None:
    print(printable(f"{what:15} {text}"))
