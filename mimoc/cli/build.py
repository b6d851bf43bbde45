"""`mimoc build`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import SpecPath
from mimoc.cli.infants import load_spec
from mimoc.cli.printable import printable

EXAMPLE = "Example:  mimoc build nine_months.yaml -o out/nine_months"


def build(
    spec: SpecPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder for the bundle.")],
    force: Annotated[bool, typer.Option("--force", help="Replace an existing bundle.")] = False,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Random seed of the scene; default: the spec's.")
    ] = None,
    target: Annotated[
        str | None, typer.Option("--for", help="Write a model for other code to load: mimo (MIMo's code).")
    ] = None,
) -> None:
    """Compile SPEC into a bundle: MuJoCo XML, textures, manifest, and the provenance of every number."""
    from mimoc.bundle.io import write_bundle
    from mimoc.cli import console
    from mimoc.compiler.building import builder
    from mimoc.compiler.provenance.child import who_percentiles

    infant = load_spec(spec)
    with console.progress("building") as show:
        built = builder(infant, target).watched(show)(infant.scene.seed if seed is None else seed)
    written = write_bundle(built, out, force=force)
    console.print_child(built.manifest, who_percentiles(built.manifest.child))
    console.print_toys(built.manifest)
    print(printable(f"{written}: open {written / built.manifest.scene} with MuJoCo, or try: mimoc run {written}"))
