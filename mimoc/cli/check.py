"""`mimoc check`."""

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.exits import FAILED_CHECK
from mimoc.cli.infants import take_bundle

EXAMPLE = "Example:  mimoc check out/nine_months"


def check(infant: InfantPath) -> None:
    """Check that a bundle is whole, compiles, and stays calm under random and under alternating commands.

    From each pose, a second of each: commands drawn anew for every control step, then all joints to and fro as hard as
    they can, switched every 50 to 100 ms.
    """
    from mimoc.cli import console
    from mimoc.runtime.check import check_stability

    whole = take_bundle(infant)
    if whole.path:
        print(f"ok     all {len(whole.files)} files are as they were written")
    else:
        print(f"ok     the spec is right, and compiles to {len(whole.files)} files")
    if not console.print_check(check_stability(whole)):
        raise typer.Exit(FAILED_CHECK)
