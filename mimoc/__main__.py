"""`python -m mimoc` is `mimo`."""

from mimoc.cli import main

main()
