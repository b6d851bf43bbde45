"""The `mimoc` command: thin commands over the library, errors as one line each."""

import io
import json
import os
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.errors import MimocError, OutputError, UnknownNameError
from mimoc.version import __version__

if TYPE_CHECKING:
    from mimoc.runtime.rollout import PolicyMaker

BAD_INPUT, FAILED_CHECK = 2, 1
MOST_ROOMS = 400
"""On one sheet."""

app = typer.Typer(
    name="mimoc",
    help="Compile simulated infants: from a YAML spec to plain MuJoCo XML and a Gymnasium environment.",
    epilog="Start with:  mimoc build configs/nine_months.yaml -o out/nine_months",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)

SpecPath = Annotated[Path, typer.Argument(metavar="SPEC", help="YAML file that describes the infant.")]
BundlePath = Annotated[Path, typer.Argument(metavar="OUT", help="Folder of a bundle that `mimoc build` wrote.")]


def main() -> None:
    """Run the command line; what a user did wrong ends in exit code 2, without a traceback."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # For names of folders that the terminal cannot show.
    try:
        app(standalone_mode=True)
    except MimocError as error:
        print(error, file=sys.stderr)
        sys.exit(BAD_INPUT)
    except Exception as error:
        if "MUJOCO_GL" not in os.environ or "mujoco" in sys.modules:
            raise
        wished = os.environ["MUJOCO_GL"]
        print(f"MuJoCo does not start with MUJOCO_GL={wished} ({error}); unset it or choose another", file=sys.stderr)
        sys.exit(BAD_INPUT)


def _say_version(wanted: bool) -> None:
    if wanted:
        print(f"mimoc {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Say which version this is.", callback=_say_version, is_eager=True)
    ] = False,
) -> None:
    pass


@app.command(epilog="Example:  mimoc build configs/nine_months.yaml -o out/nine_months")
def build(
    spec: SpecPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder to write the bundle to.")],
    force: Annotated[bool, typer.Option("--force", help="Replace the bundle that is there.")] = False,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the scene; the spec's.")] = None,
) -> None:
    """Compile SPEC into a bundle: MuJoCo XML, textures, and all that is known of them."""
    from mimoc import bundle, console, pipeline

    infant = pipeline.load_spec(spec)
    with console.status("building"):
        built = pipeline.builder(infant)(infant.scene.seed if seed is None else seed)
    folder = bundle.write_bundle(built, out, force=force)
    console.print_child(built.manifest, pipeline.who_percentiles(built.manifest.child))
    console.print_toys(built.manifest)
    print(f"{folder}: open {folder / built.manifest.scene} with MuJoCo, or try: mimoc run {folder}")


@app.command(epilog="Example:  mimoc validate --against who --plot growth.png")
def validate(
    spec: Annotated[
        Path | None, typer.Argument(metavar="[SPEC]", help="Infant to grow from 0 to 24 months; the average child.")
    ] = None,
    against: Annotated[str, typer.Option("--against", help="Growth standard: who.")] = "who",
    as_json: Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")] = False,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw growth against WHO.")] = None,
) -> None:
    """Compare the compiled infant with WHO's growth standards, month by month; exit 1 if it is off by over one SD."""
    from mimoc import console, pipeline, validation

    if against != "who":
        raise UnknownNameError("growth standard", against, ["who"])
    infant = pipeline.load_spec(spec) if spec else None
    with console.progress("growing") as show:
        report = validation.grow_against_who(infant, progress=show)
    if plot:
        from mimoc.plot import plot_growth

        plot_growth(report.series, plot)
    print(json.dumps(report.to_data(), indent=1)) if as_json else console.print_growth(report)
    if not report.within_one_sd:
        raise typer.Exit(FAILED_CHECK)


@app.command(epilog="Example:  mimoc run out/nine_months --policy random --steps 500 --seed 1")
def run(
    out: BundlePath,
    policy: Annotated[
        str,
        typer.Option(
            "--policy",
            help="What acts: random, zero, reach (by inverse dynamics; not for servos), or a training's policy.zip.",
        ),
    ] = "random",
    steps: Annotated[int, typer.Option("--steps", min=1, help="Control steps to run.")] = 1000,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Of the policy and the episodes: the same gives the same.")
    ] = 0,
    window: Annotated[bool, typer.Option("--window", help="Show it in a window, in real time.")] = False,
) -> None:
    """Run the infant under a policy, with progress and a closing summary."""
    from mimoc import bundle, console
    from mimoc.runtime.env import InfantEnv
    from mimoc.runtime.rollout import Run

    with closing(InfantEnv(bundle.read_bundle(out), render_mode="human" if window else None)) as env:
        running = Run(env, _read_policy(policy), seed)
        with console.progress("running") as show:
            for step in range(steps):
                running.step()
                show(step + 1, steps)
    console.print_run(running.summary())


@contextmanager
def _can_go_on() -> Iterator[None]:
    """Say, where Ctrl-C ends something long, that nothing but the last part is lost."""
    try:
        yield
    except KeyboardInterrupt:
        print("stopped; the same command goes on from what is there", file=sys.stderr)
        raise


def _read_policy(policy: str) -> "str | PolicyMaker":
    """Return what the name of a file makes act; any other name as it is."""
    if not policy.endswith(".zip"):
        return policy
    from mimoc.training import load_policy

    return load_policy(policy)


@app.command(epilog="Example:  mimoc train configs/reach.yaml -o runs/reach --algo ppo --steps 4096")
def train(
    source: Annotated[Path, typer.Argument(metavar="OUT", help="Folder of a bundle, or a spec (.yaml) to build.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="RUN", help="Folder of the training.")],
    algo: Annotated[str, typer.Option("--algo", help="How it learns: ppo or sac.")] = "ppo",
    steps: Annotated[
        int, typer.Option("--steps", min=1, help="Control steps to learn from, of all infants.")
    ] = 500_000,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed: the same learns the same.")] = 0,
    envs: Annotated[int, typer.Option("--envs", min=1, max=1024, help="Infants that act at a time.")] = 8,
    every: Annotated[
        int, typer.Option("--checkpoint-every", min=1, help="Steps between checkpoints; a kill loses at most these.")
    ] = 20_480,
    knobs: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="A hyper-parameter, such as gamma=0.99; a wrong name lists them."
        ),
    ] = None,
    processes: Annotated[
        bool | None,
        typer.Option(
            "--processes/--one-process",
            help="Whether each infant has a process of its own; by itself, where that is faster.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Begin anew what is in the folder.")] = False,
) -> None:
    """Train the infant; the same command again goes on with a training that was interrupted."""
    from mimoc import console, training
    from mimoc.training import hyper

    chosen = hyper.read(algo, knobs or [])
    with console.progress("training") as show, _can_go_on():
        done = training.train(
            source,
            out,
            algo=algo,
            steps=steps,
            seed=seed,
            envs=envs,
            checkpoint_every=every,
            hyper=chosen,
            processes=processes,
            force=force,
            progress=show,
        )
    console.print_training(done)
    print(f"{out}: see {out / 'curve.png'}, or try: mimoc run {out / 'bundle'} --policy {done.policy}")


@app.command(epilog="Example:  mimoc experiment growth -o out/growth --quick")
def experiment(
    name: Annotated[str, typer.Argument(metavar="NAME", help="growth, strength, acuity, delays, inverse, rooms.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder for tables, pictures and page.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer ages, seeds or steps: seconds, or minutes for delays.")
    ] = False,
) -> None:
    """Repeat an experiment of the paper: CSV, PNG, and a page with what was measured next to what the paper says."""
    from mimoc import console, experiments

    with console.progress(name) as show, _can_go_on():
        page = experiments.run_experiment(name, out, quick=quick, progress=show)
    print(page)


@app.command(epilog="Example:  mimoc check out/nine_months")
def check(out: BundlePath) -> None:
    """Check that a bundle is whole, compiles, and stays calm under random and under alternating commands.

    From each pose, a second of each: commands drawn anew for every control step, then all joints to and fro as hard as
    they can, switched every 50 to 100 ms.
    """
    from mimoc import bundle, console
    from mimoc.runtime.check import check_stability

    whole = bundle.read_bundle(out)
    print(f"ok     all {len(whole.files)} files are as they were written")
    if not console.print_check(check_stability(whole)):
        raise typer.Exit(FAILED_CHECK)


@app.command(epilog="Example:  mimoc explain out/nine_months body.left_foot.mass")
def explain(
    out: BundlePath,
    key: Annotated[str, typer.Argument(metavar="KEY", help="A number: `actuator.act:left_elbow.gear`, ...")],
) -> None:
    """Say where a number comes from: table row, growth curve, rule, XML attribute."""
    from mimoc import bundle, console
    from mimoc.explain import explain

    console.print_explanation(explain(bundle.read_bundle(out), key))


@app.command(epilog="Example:  mimoc render out/nine_months -o nine_months.png --pose supine")
def render(
    outs: Annotated[list[Path], typer.Argument(metavar="OUT...", help="Bundles; several stand in a row, to scale.")],
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.png", help="Picture to write.")],
    pose: Annotated[str | None, typer.Option("--pose", help="supine, prone, sitting or standing; the spec's.")] = None,
    width: Annotated[int, typer.Option("--width", min=16, max=4096, help="In pixels.")] = 960,
    height: Annotated[int, typer.Option("--height", min=16, max=4096, help="In pixels.")] = 720,
    skin: Annotated[bool, typer.Option("--skin", help="Show its skin points, and what they feel.")] = False,
) -> None:
    """Draw a picture of the infant, or of several in a row."""
    from mimoc import bundle, files
    from mimoc.runtime.portrait import lineup, portrait
    from mimoc.scene.drawing import encode_png

    if len(outs) > 1 and pose not in (None, "standing"):
        raise UnknownNameError("pose for several infants", str(pose), ["standing"])
    infants = [bundle.read_bundle(out) for out in outs]
    if len(infants) > 1:
        picture = lineup(infants, width, height, skin=skin)
    else:
        picture = portrait(infants[0], pose, width, height, skin=skin)
    print(files.write_file(file, encode_png(picture)))


@app.command(epilog="Example:  mimoc see out/nine_months -o seen.png --pose sitting --ages 1,3,9")
def see(
    out: BundlePath,
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.png", help="Picture to write.")],
    ages: Annotated[str, typer.Option("--ages", metavar="MONTHS,...", help="Whose acuity: 0 to 36.")] = "1,2,4,6,12",
    profile: Annotated[
        str | None, typer.Option("--profile", help="Acuity by age: tac2, mayer1995 or mimo_v2; the spec's.")
    ] = None,
    foveation: Annotated[
        float | None, typer.Option("--foveation", min=0, max=1000, help="Its strength; the spec's, or 5 if that is 0.")
    ] = None,
    pose: Annotated[str | None, typer.Option("--pose", help="supine, prone, sitting or standing; the spec's.")] = None,
    eye: Annotated[str, typer.Option("--eye", help="left or right.")] = "left",
    down: Annotated[float, typer.Option("--down", min=-90, max=90, help="How far the eye looks down, degrees.")] = 50,
    size: Annotated[int, typer.Option("--size", min=16, max=1024, help="Of each picture, pixels.")] = 256,
) -> None:
    """Draw what the infant sees: as drawn, as fine as several ages see it, and foveated as well."""
    from mimoc import bundle, files, schema, source
    from mimoc.runtime.glimpse import glimpse
    from mimoc.scene.drawing import encode_png
    from mimoc.scene.sheet import draw_sheet
    from mimoc.scene.sights import compare_ages, read_ages

    infant = bundle.read_bundle(out)
    spec = schema.read_spec(source.parse(infant.files["resolved.yaml"].decode(), "resolved.yaml"))
    vision = spec.senses.vision or schema.VisionSpec()
    compared = compare_ages(vision, eye, read_ages(ages), size, profile=profile, foveation=foveation)
    pictures = glimpse(infant, compared.sights, pose, down)
    print(files.write_file(file, encode_png(draw_sheet(pictures, compared.columns, compared.rows))))


@app.command(epilog="Example:  mimoc rooms configs/playroom.yaml --seeds 0:12 -o rooms.png")
def rooms(
    spec: SpecPath,
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.png", help="Picture to write.")],
    seeds: Annotated[str, typer.Option("--seeds", metavar="FIRST:END", help="Seeds of the scenes.")] = "0:12",
    size: Annotated[int, typer.Option("--size", min=32, max=1024, help="Width of each picture, pixels.")] = 320,
) -> None:
    """Draw the scenes that several seeds give, on one sheet."""
    from mimoc import console, files, pipeline
    from mimoc.runtime.overview import overview
    from mimoc.scene.drawing import encode_png
    from mimoc.scene.sheet import draw_grid

    wanted, builder, pictures = read_range(seeds), pipeline.builder(pipeline.load_spec(spec)), []
    with console.progress("drawing") as show:
        for number, seed in enumerate(wanted, start=1):
            pictures.append(overview(builder(seed, check=False), size, size * 3 // 4))
            show(number, len(wanted))
    print(files.write_file(file, encode_png(draw_grid(pictures, [f"seed {seed}" for seed in wanted]))))


@app.command("import", epilog="Example:  mimoc import babybench configs/babybench.yml -o self_touch.yaml")
def import_config(
    system: Annotated[str, typer.Argument(metavar="FORMAT", help="Whose configuration it is: babybench.")],
    config: Annotated[Path, typer.Argument(metavar="CONFIG", help="The configuration, a YAML file.")],
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.yaml", help="Spec to write.")],
    force: Annotated[bool, typer.Option("--force", help="Replace the spec that is there.")] = False,
) -> None:
    """Turn the configuration of another system into a spec, and say what of it has no counterpart."""
    from mimoc import files, importers

    imported = importers.import_config(system, config)
    if file.resolve() == config.resolve():
        raise OutputError(f"{file}: this is the configuration itself; choose another place")
    if file.exists() and not force:
        raise OutputError(f"{file}: is there already; choose another place, or replace it with --force")
    written = files.write_file(file, imported.text.encode())
    for note in imported.notes:
        print(note)
    print(f"{written}: try it with: mimoc build {written} -o out/{imported.spec['name']}")


def read_range(text: str) -> range:
    """Return the seeds that a text such as `0:12` names: the first, and the first that is not.

    Raises:
        MimocError: If it names none.
    """
    first, colon, end = text.partition(":")
    if not (first.isdecimal() and (end if colon else first).isdecimal()):
        raise MimocError(f"'{text}' names no seeds; write the first and the end, such as 0:12")
    found = range(int(first), int(end) if colon else int(first) + 1)
    if not 0 < len(found) <= MOST_ROOMS:
        raise MimocError(f"'{text}' names {len(found)} seeds; give 1 to {MOST_ROOMS}")
    return found
