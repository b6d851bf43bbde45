"""`mimoc check`."""

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.exit_codes import FAILED_CHECK
from mimoc.cli.infants import load_infant

EXAMPLE = "Example:  mimoc check out/nine_months"


def check(infant: InfantPath) -> None:
    """Check that a bundle is intact, compiles, and stays stable under random and alternating commands.

    Runs two one-second trials from each pose: random commands, drawn anew at every control step, and alternating
    commands, which drive all joints to and fro at full strength and switch direction every 50 to 100 ms.
    """
    from mimoc.cli import console
    from mimoc.runtime.check import check_stability

    bundle = load_infant(infant)
    if bundle.path:
        print(f"ok     all {len(bundle.files)} files are unchanged")
    else:
        print(f"ok     the spec is valid and compiles to {len(bundle.files)} files")
    poses, passed = len(bundle.manifest.poses), list[bool]()
    with console.progress("checking") as show:
        show(0, poses)
        for each in check_stability(bundle):
            console.print_check(each)
            passed.append(each.passed)
            show(len(passed), poses)
    if not all(passed):
        raise typer.Exit(FAILED_CHECK)
