"""`mimoc check`."""

import typer

from mimoc.cli.arguments import BundlePath
from mimoc.cli.exits import FAILED_CHECK

EXAMPLE = "Example:  mimoc check out/nine_months"


def check(out: BundlePath) -> None:
    """Check that a bundle is whole, compiles, and stays calm under a second of random control from each pose."""
    from mimoc import bundle, console
    from mimoc.runtime.check import check_stability

    whole = bundle.read_bundle(out)
    print(f"ok     all {len(whole.files)} files are as they were written")
    if not console.print_check(check_stability(whole)):
        raise typer.Exit(FAILED_CHECK)
