"""`mimoc render`, `mimoc see` and `mimoc rooms`: pictures of infants, of what they see and of their scenes."""

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError, SpecError, check_name
from mimoc.cli.arguments import Body, InfantPath, PicturePath, find_world, load_infant, load_spec
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mimoc.bundle.io import Bundle
    from mimoc.bundle.world import WorldBundle
    from mimoc.render.portrait import Framing
    from mimoc.render.renderer import Picture, Shown
    from mimoc.schema.infant import InfantSpec
    from mimoc.schema.scene import SceneSpec
    from mimoc.schema.source import Source

Azimuth = Annotated[
    float | None,
    typer.Option(
        min=-360,
        max=360,
        help="Where the camera stands around the infants, in degrees: 0 in front of them, 90 at their left, 180 behind "
        "them; default: a little to the right of one infant, in front of several.",
    ),
]
Elevation = Annotated[
    float | None,
    typer.Option(
        min=-90,
        max=90,
        help="How high it stands, in degrees: 0 level with them, 90 straight above; default: what suits the pose.",
    ),
]
Distance = Annotated[
    float | None,
    typer.Option(
        min=0.1,
        max=100,
        help="How far it stands from the middle of them, in metres; default: so that they fill the image.",
    ),
]
Transparent = Annotated[
    bool,
    typer.Option("--transparent", help="Draw the infants alone, on a transparent background (.png, .webp or .tiff)."),
]
ScaleBar = Annotated[
    bool,
    typer.Option("--scale-bar", help="Draw a bar of so many cm, true at the distance of the middle of the infants."),
]


PoseOfAll = Annotated[
    str | None,
    typer.Option(
        help="supine, prone, sitting or standing, or, for pictures only, crawling, playing, looking or kicking; of all "
        "infants; default: each one's spec's."
    ),
]


class Crop(StrEnum):
    """What fills a picture."""

    HEAD = "head"


CropTo = Annotated[Crop | None, typer.Option(help="Let the head alone fill the image of one infant.")]
Ages = Annotated[
    str | None,
    typer.Option(metavar="MONTHS,...", help="Draw the infant at several ages: 0,3,6,12,24 makes a sheet of images."),
]
Poses = Annotated[
    str | None,
    typer.Option(metavar="POSE,...", help="Draw it in several poses, or `all`: a column of the sheet for each."),
]
BodyOfAll = Annotated[
    Body | None, typer.Option(help="Draw the skin or the solids under it; default: skin, without --skin.")
]
Width = Annotated[
    int | None, typer.Option(min=16, max=4096, help="Width in pixels; default: 1000, of each image of a sheet 320.")
]
Height = Annotated[
    int | None, typer.Option(min=16, max=4096, help="Height in pixels; default: the width, or half of it for a row.")
]
PICTURE_PX, SHEET_PX = 1000, 320  # Width of an image, and of each in a sheet, if nothing else is said.


def render(
    infants: Annotated[
        list[Path],
        typer.Argument(
            metavar="INFANT...",
            help="Bundles or specs (.yaml, or `-` for standard input); several are drawn in a row, to scale.",
        ),
    ],
    file: PicturePath,
    pose: PoseOfAll = None,
    crop: CropTo = None,
    ages: Ages = None,
    poses: Poses = None,
    width: Width = None,
    height: Height = None,
    skin: Annotated[bool, typer.Option("--skin", help="Show the skin points and the forces on them.")] = False,
    body: BodyOfAll = None,
    azimuth: Azimuth = None,
    elevation: Elevation = None,
    distance: Distance = None,
    transparent: Transparent = False,
    scale_bar: ScaleBar = False,
) -> None:
    """Render an image of the infant, of several side by side, or of one at several ages and in several poses.

    Each pose is seen from where it shows best. Some examples:

    - `mimoc render kim.yaml -o kim.png` draws a portrait;

    - `mimoc render kim.yaml -o face.png --crop head` the head alone;

    - `mimoc render kim.yaml -o crawling.png --pose crawling --transparent` a figure for a slide;

    - `mimoc render kim.yaml -o grid.png --ages 0,3,6,12,24 --poses all` a sheet of ages and poses;

    - `mimoc render kim.yaml -o heads.png --ages 0,3,6,12,24 --crop head` a row of heads.
    """
    from mimoc.render.picture_files import check_picture_name
    from mimoc.render.portrait import Framing

    check_picture_name(file, transparent=transparent)
    framing = Framing(azimuth, elevation, distance, transparent, scale_bar, crop.value if crop else None)
    across = width or (SHEET_PX if ages or poses else PICTURE_PX)
    size_px = across, height or (across // 2 if len(infants) > 1 else across)
    shown = (body or (Body.SOLIDS if skin else Body.SKIN)).value
    if ages is not None or poses is not None:
        refused = {"--skin": skin, "--transparent": transparent, "--pose": bool(pose and poses)}
        _draw_sheet(infants, file, ages, poses or pose, size_px, shown, framing, refused)
    elif len(infants) == 1 and (world := find_world(infants[0])):
        _draw_world(world, file, pose, size_px, skin, shown, framing)
    else:
        _draw([load_infant(infant) for infant in infants], file, pose, size_px, skin, shown, framing)


def _draw(
    bundles: "list[Bundle]",
    file: Path,
    pose: str | None,
    size_px: tuple[int, int],
    skin: bool,
    shown: "Shown",
    framing: "Framing",
) -> None:
    from mimoc.components.senses.touch.run import skin_markers
    from mimoc.render.picture_files import write_picture
    from mimoc.render.picture_poses import load_in_pose
    from mimoc.render.portrait import lineup, portrait

    if framing.crop and len(bundles) > 1:
        raise MimocError("--crop head draws the head of one infant; name one, or leave it out")
    markers = [skin_markers(bundle, *load_in_pose(bundle, pose)) for bundle in bundles] if skin else None
    if len(bundles) > 1:
        picture = lineup(bundles, pose, *size_px, markers, shown, framing)
    else:
        picture = portrait(bundles[0], pose, *size_px, markers[0] if markers else None, shown, framing)
    print(printable(write_picture(file, picture)))


def _draw_world(
    world: "WorldBundle",
    file: Path,
    pose: str | None,
    size_px: tuple[int, int],
    skin: bool,
    body: "Shown",
    framing: "Framing",
) -> None:
    from mimoc.components.senses.touch.run import skin_markers
    from mimoc.render.body_camera import join_markers
    from mimoc.render.picture_files import write_picture
    from mimoc.render.picture_poses import load_world_in_pose
    from mimoc.render.portrait import world_portrait

    if framing.crop:
        raise MimocError("--crop head draws the head of one infant; leave it out")
    state = load_world_in_pose(world, pose)
    markers = join_markers(skin_markers(infant, *state) for infant in world.infants.values()) if skin else None
    print(printable(write_picture(file, world_portrait(world, pose, *size_px, markers, body, framing))))


def _draw_sheet(
    infants: list[Path],
    file: Path,
    ages: str | None,
    poses: str | None,
    size_px: tuple[int, int],
    shown: "Shown",
    framing: "Framing",
    refused: dict[str, bool],
) -> None:
    from mimoc.cli import console
    from mimoc.render.picture_files import write_picture
    from mimoc.render.portrait import check_count, contact_sheet, read_poses

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
    from mimoc.compiler.variants import spec_of

    if ages is None:
        return []
    months = read_ages(ages)
    spec = spec_of(load_infant(infant)) if infant.is_dir() else load_spec(infant)
    return [spec.with_(age_months=age_months) for age_months in months]


def _built(infant: Path, specs: "list[InfantSpec]", first: "Bundle | None" = None) -> "Iterator[Bundle]":
    """Yield the infant, or what each spec describes, one after another; the first may be there already."""
    from mimoc.compiler.building import build

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


FieldOfView = Annotated[
    float, typer.Option(min=1, max=170, help="Vertical field of view in degrees; acuity shows best if narrow.")
]
NOTHING_SEEN = (
    "note: the eye sees one plain surface (sky, floor, or skin near by), so all views are alike; let it see something: "
    "another --pose (sitting), --down, a wider --fovy, or a room with toys (`scene: {kind: room}`)"
)


def see(
    infant: InfantPath,
    file: PicturePath,
    ages: Annotated[
        str, typer.Option(metavar="MONTHS,...", help="Ages in months, 0 to 36, whose acuity is shown.")
    ] = "1,2,4,6,12",
    profile: Annotated[
        str | None, typer.Option(help="Acuity by age: tac2, mayer1995 or mimo_v2; default: the spec's.")
    ] = None,
    foveation: Annotated[
        float | None, typer.Option(min=0, max=1000, help="Strength of foveation; default: the spec's, or 5 if 0.")
    ] = None,
    pose: Annotated[str | None, typer.Option(help="supine, prone, sitting or standing; default: the spec's.")] = None,
    eye: Annotated[str, typer.Option(help="left or right.")] = "left",
    down: Annotated[
        float | None, typer.Option(min=-90, max=90, help="Downward gaze in degrees; default: towards a toy or a hand.")
    ] = None,
    fovy: FieldOfView = 18,
    size: Annotated[int, typer.Option(min=16, max=1024, help="Size of each view in pixels.")] = 256,
    name: Annotated[
        str | None, typer.Option("--infant", metavar="NAME", help="Who sees, in a world; default: the first infant.")
    ] = None,
) -> None:
    """Render what the infant sees at several ages, with and without foveation, beside the unblurred view."""
    from mimoc.compiler.variants import spec_of
    from mimoc.components.senses.vision import VisionSpec
    from mimoc.components.senses.vision.preview import compare_ages, is_blank, preview, read_ages as read_eye_ages
    from mimoc.render import picture_files
    from mimoc.render.picture_files import tile_pictures

    picture_files.check_picture_name(file)
    world = find_world(infant, pose=pose)
    bundle = _infant_of(world, name) if world else load_infant(infant)
    if name and not world:
        raise MimocError("--infant chooses from a world with several infants, and this is one; leave it out")
    vision = spec_of(bundle).senses.vision or VisionSpec()
    seeing = bundle.manifest.senses.vision
    vision = vision.model_copy(update={"body": seeing.body}) if seeing else vision
    months = read_eye_ages(ages)
    views = compare_ages(vision, eye, months, size, profile=profile, foveation=foveation)
    pictures = preview(bundle, views.entries, pose, down, fovy, world)
    print(printable(picture_files.write_picture(file, tile_pictures(pictures, views.columns, views.rows))))
    if is_blank(pictures[0][-1]):
        print(NOTHING_SEEN)


def _infant_of(world: "WorldBundle", name: str | None) -> "Bundle":
    if name is not None:
        check_name("name of an infant of this world", name, world.infants)
    return world.infants[name or next(iter(world.infants))]


MAX_ROOMS = 400  # Largest number of scenes in one image.


def rooms(
    spec: Annotated[
        Path,
        typer.Argument(
            metavar="SPEC", help="Spec with a room or toys (.yaml, or `-` for standard input), or a bundle."
        ),
    ],
    file: PicturePath,
    seeds: Annotated[str, typer.Option(metavar="FIRST:END", help="Seeds of the scenes; END is excluded.")] = "0:12",
    size: Annotated[int, typer.Option(min=32, max=1024, help="Width of each scene's image in pixels.")] = 320,
) -> None:
    """Render the scenes of several seeds in one image."""
    from mimoc.cli import console
    from mimoc.render.picture_files import captioned_grid, check_picture_name, write_picture

    check_picture_name(file)
    wanted = parse_seeds(seeds)
    pictures = list[Any]()
    size_px = (size, size * 3 // 4)
    draw = _scene_drawer(spec, size_px)
    with console.progress("drawing") as show:
        for number, seed in enumerate(wanted, start=1):
            pictures.append(draw(seed))
            show(number, len(wanted))
    print(printable(write_picture(file, captioned_grid(pictures, [f"seed {seed}" for seed in wanted]))))


def _scene_drawer(spec: Path, size_px: tuple[int, int]) -> "Callable[[int], Picture]":
    from mimoc.bundle.io import read_bundle
    from mimoc.compiler import building, variants
    from mimoc.compiler.variants import plan_of_bundle
    from mimoc.compiler.worlds import build_world
    from mimoc.render.portrait import overview, world_portrait
    from mimoc.schema.infant import as_written
    from mimoc.schema.world import in_scene

    if world := find_world(spec):
        plan = plan_of_bundle(world)
        _check_seed_matters(plan.spec.scene, plan.written)
        return lambda seed: world_portrait(build_world(in_scene(plan, seed)), None, *size_px)
    infant = variants.spec_of(read_bundle(spec)) if spec.is_dir() else load_spec(spec)
    _check_seed_matters(infant.scene, as_written(infant))
    builder = building.builder(infant)
    return lambda seed: overview(builder(seed, check=False), *size_px)


def _check_seed_matters(scene: "SceneSpec", written: "Source") -> None:
    """Print a note if only the toys depend on the seed; raise a SpecError if nothing in the scene does."""
    from mimoc.schema.kinds import SCENES

    kind = scene.kind
    if SCENES[kind].varies:
        return
    if scene.toys is None:
        others = " or ".join(f"'kind: {one.name}'" for one in SCENES.values() if one.varies)
        message = f"'{kind}' without toys is the same for every seed; write {others}, or add toys"
        raise SpecError([written.problem(("scene", "kind"), message)])
    print(f"note: in a '{kind}' scene only the toys depend on the seed", file=sys.stderr)


def parse_seeds(text: str) -> range:
    """Return the seeds given by a text such as `0:12` (the end is excluded) or `7`; a MimocError says what is wrong."""
    first, colon, end = text.partition(":")
    if not (first.isdecimal() and (end if colon else first).isdecimal()):
        raise MimocError(f"'{text}' is not a range of seeds; write FIRST:END, such as 0:12")
    seeds = range(int(first), int(end) if colon else int(first) + 1)
    if not 0 < len(seeds) <= MAX_ROOMS:
        raise MimocError(f"'{text}' is a range of {len(seeds)} seeds; give 1 to {MAX_ROOMS}")
    return seeds
