"""The programs in `sculpt/`, which make what ships with mimoc, as modules to import."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "sculpt"))
