"""How surely a figure of real infants is known, the same words for all figures that infants are judged by."""

from typing import Literal

Certainty = Literal["read", "read in another source", "recorded", "derived", "assumption"]
"""Read in the source or its abstract, or in another text that reports it; measured on recordings of real infants;
derived from such figures; or an assumption: nobody is judged by it."""
ASSUMPTION = "assumption"
READ: tuple[Certainty, ...] = ("read", "read in another source")
Basis = Literal["fitted", "predicted"]
"""Whether a number of the law `maturing` was chosen for a figure, so that it is reproduced, or none was."""
