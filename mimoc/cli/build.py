"""`mimoc build`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import SpecPath
from mimoc.cli.infants import take_spec

EXAMPLE = "Example:  mimoc build configs/nine_months.yaml -o out/nine_months"


def build(
    spec: SpecPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder to write the bundle to.")],
    force: Annotated[bool, typer.Option("--force", help="Replace the bundle that is there.")] = False,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the scene; the spec's.")] = None,
    target: Annotated[str | None, typer.Option("--for", help="Other software that is to read it: mimo.")] = None,
) -> None:
    """Compile SPEC into a bundle: MuJoCo XML, textures, and all that is known of them."""
    from mimoc.bundle import folder
    from mimoc.cli import console
    from mimoc.compiler.building import builder
    from mimoc.compiler.provenance.child import who_percentiles

    infant = take_spec(spec)
    with console.status("building"):
        built = builder(infant, target)(infant.scene.seed if seed is None else seed)
    folder = folder.write_bundle(built, out, force=force)
    console.print_child(built.manifest, who_percentiles(built.manifest.child))
    console.print_toys(built.manifest)
    print(f"{folder}: open {folder / built.manifest.scene} with MuJoCo, or try: mimoc run {folder}")
