"""`mimoc build`, `mimoc check` and `mimoc explain`: what is made of specs, and what is in it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.cli.arguments import InfantPath, SpecPath, find_world, load_infant, load_spec
from mimoc.cli.terminal import FAILED_CHECK, printable

if TYPE_CHECKING:
    from mimoc.bundle.manifest import Manifest
    from mimoc.bundle.world import WorldManifest


def build(
    spec: SpecPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder for the bundle.")],
    force: Annotated[bool, typer.Option("--force", help="Replace an existing bundle.")] = False,
    seed: Annotated[int | None, typer.Option(min=0, help="Random seed of the scene; default: the spec's.")] = None,
    target: Annotated[
        str | None,
        typer.Option(
            "--for", help="Write a model for other code to load: mimo (MIMo to v2, BabyBench) or mimo3 (MIMo 3)."
        ),
    ] = None,
) -> None:
    """Compile SPEC into a bundle: MuJoCo XML, textures, manifest, and the provenance of every number."""
    from mimoc.bundle.io import write_bundle
    from mimoc.cli import console
    from mimoc.compiler.building import builder
    from mimoc.compiler.provenance import who_percentiles

    if world := find_world(spec, seed, **{"for": target}):
        written = write_bundle(world, out, force=force)
        for one in world.infants.values():
            console.print_child(one.manifest, who_percentiles(one.manifest.child))
        _print_scene(world.manifest, written)
        return
    infant = load_spec(spec)
    with console.progress("building") as show:
        built = builder(infant, target).with_progress(show)(infant.scene.seed if seed is None else seed)
    written = write_bundle(built, out, force=force)
    console.print_child(built.manifest, who_percentiles(built.manifest.child))
    _print_scene(built.manifest, written)


def _print_scene(manifest: "Manifest | WorldManifest", folder: Path) -> None:
    from mimoc.cli import console

    console.print_toys(manifest)
    print(printable(f"{folder}: open {folder / manifest.scene} with MuJoCo, or try: mimoc run {folder}"))


def check(infant: InfantPath) -> None:
    """Check that a bundle is intact, compiles, and stays stable under random and alternating commands.

    Runs two one-second trials from each pose: random commands, drawn anew at every control step, and alternating
    commands, which drive all joints to and fro at full strength and switch direction every 50 to 100 ms.
    """
    from mimoc.cli import console
    from mimoc.runtime.check import check_stability, check_world

    if world := find_world(infant):
        print(f"ok     all {len(world.files)} files {'are unchanged' if world.path else 'of the world compile'}")
        trial = check_world(world)
        console.print_check(trial)
        if not trial.passed:
            raise typer.Exit(FAILED_CHECK)
        return
    bundle = load_infant(infant)
    if bundle.path:
        print(f"ok     all {len(bundle.files)} files are unchanged")
    else:
        print(f"ok     the spec is valid and compiles to {len(bundle.files)} files")
    poses, passed = len(bundle.manifest.poses), list[bool]()
    with console.progress("checking") as show:
        show(0, poses)
        for trial in check_stability(bundle):
            console.print_check(trial)
            passed.append(trial.passed)
            show(len(passed), poses)
    if not all(passed):
        raise typer.Exit(FAILED_CHECK)


def explain(
    infant: InfantPath,
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="NUMBER",
            help="Name of the number, such as `actuator.act:left_elbow.gear`, or part of it: `weight`, `left_foot`, "
            "`toy1`, `*.mass`. Several matches are listed with their values; without a name, all numbers are listed.",
        ),
    ] = None,
) -> None:
    """Explain where a number comes from: table row, growth curve, rule, XML attribute."""
    from mimoc.cli import console
    from mimoc.compiler.explain import contents, explain, find, legend

    bundle = find_world(infant) or load_infant(infant)
    if key is None:
        console.print_contents(contents(bundle))
        return
    numbers = find(bundle, key)
    if len(numbers) == 1:
        explanation = explain(bundle, *numbers)
        console.print_explanation(explanation, legend(explanation))
    else:
        console.print_numbers(numbers)
