"""`python -m mimoc` is the command `mimoc`."""

from mimoc.cli import main

main()
