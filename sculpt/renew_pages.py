"""Run the experiments again whose pages in docs/experiments have figures of other bodies than mimoc's are now.

Those that take seconds are run, the pages of the others say so below their titles; with `--all`, all are run (hours).
"""

import argparse
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from mimoc.studies.experiment import find_experiment, run_experiment
from mimoc.studies.notebook import bodies_digest

CHECKOUT = Path(__file__).resolve().parents[1]
PAGES = sorted(CHECKOUT.glob("docs/experiments/*/*.md"))
SHORT = ("growth", "strength", "acuity", "inverse", "rooms")  # Experiments that take seconds.
COMMAND = re.compile(r"^    mimoc experiment (\w+) -o \w+(?: --development (\w+))?$", re.MULTILINE)
BODIES = re.compile(r"Bodies:\s`(\w+)`\.")
EARLIER = (
    "> **Of earlier bodies.** These figures were measured with the bodies `{bodies}`; those of this release differ.\n\n"
)
"""What a page says below its title if it has not been renewed."""


@dataclass(frozen=True)
class Page:
    """The page of an experiment."""

    path: Path

    @cached_property
    def text(self) -> str:
        """What is in the file."""
        return self.path.read_text(encoding="utf-8")

    @cached_property
    def bodies(self) -> str:
        """Digest of the bodies that it was measured with."""
        (digest,) = BODIES.findall(self.text)
        return digest

    @cached_property
    def todays(self) -> str:
        """Digest of the bodies that the experiment has now."""
        return bodies_digest(find_experiment(self.name).infants(self.law))

    @property
    def name(self) -> str:
        """Name of the experiment."""
        return COMMAND.findall(self.text)[0][0]

    @property
    def law(self) -> str | None:
        """Law of development of its infants; None if it has laws of its own."""
        return COMMAND.findall(self.text)[0][1] or None

    @property
    def command(self) -> str:
        """What runs the experiment again."""
        law = f" --development {self.law}" if self.law else ""
        return f"mimoc experiment {self.name} -o {self.path.parent.relative_to(CHECKOUT)}{law}"

    @property
    def renewed(self) -> str:
        """The text with what it has to say if its bodies are not today's, and without it if they are."""
        earlier = EARLIER.format(bodies=self.bodies)
        title, rest = self.text.replace(earlier, "").split("\n\n", 1)
        return f"{title}\n\n{earlier if self.bodies != self.todays else ''}{rest}"

    @property
    def problem(self) -> str:
        """Why its figures are not of today's bodies, and what to do, in one line; empty if they are, or it says so."""
        if self.text == self.renewed:
            return ""
        page = self.path.relative_to(CHECKOUT)
        return (
            f"{page}: of the bodies {self.bodies}, today's are {self.todays}; "
            f"run '.ci/task experiments', or {self.command}"
        )


def renew(page: Page, *, long: bool) -> None:
    """Run an experiment again if its bodies have changed and it is short, or *long*; else its page says so."""
    if page.bodies != page.todays and (long or page.name in SHORT):
        print(run_experiment(page.name, page.path.parent, development=page.law))
        return
    page.path.write_text(page.renewed, encoding="utf-8")
    if page.bodies != page.todays:
        print(f"{page.path.relative_to(CHECKOUT)}: of earlier bodies, as it says; to renew it, run {page.command}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true", help="run the long ones, too")
    asked = parser.parse_args()
    for path in PAGES:
        renew(Page(path), long=asked.all)
