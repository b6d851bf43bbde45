"""Toys: what they look like, what they touch with, what they weigh; and where they come from, a folder each."""

from mimoc.kinds import Kinds, ToySource, by_name
from mimoc.toys.builtin import BUILTIN
from mimoc.toys.toys4k import TOYS4K

TOY_SOURCES: Kinds[ToySource] = Kinds("source of toys", by_name((BUILTIN, TOYS4K)))
