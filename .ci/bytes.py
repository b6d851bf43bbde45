"""Build every config as it is and at five ages, and print one digest; `--files FILE` also keeps that of each file.

A change that is to keep all bundles runs it before with `--files before.json`, and after with `--against before.json`,
which lists every file that differs.
"""

import argparse
import hashlib
import json
from pathlib import Path

import mimoc
from mimoc.base.errors import MimocError

CONFIGS = sorted((Path(__file__).resolve().parents[1] / "configs").glob("*.yaml"))
AGES = (0, 3, 9, 18, 24)
"""Months."""


def main() -> None:
    """Print the digest, and what differs from another run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--files", type=Path, help="write the digest of each file")
    parser.add_argument("--against", type=Path, help="compare with the digests of another run; exit 1 if any differ")
    options = parser.parse_args()
    digests = {
        f"{config.stem}@{age}/{name}": hashlib.sha256(content).hexdigest()
        for config in CONFIGS
        for age in (None, *AGES)
        for name, content in built(config, age).items()
    }
    if options.files:
        options.files.write_text(json.dumps(digests, indent=1, sort_keys=True))
    print(hashlib.sha256(json.dumps(digests, sort_keys=True).encode()).hexdigest())
    if options.against:
        before = json.loads(options.against.read_text())
        differing = sorted(name for name in {*before, *digests} if before.get(name) != digests.get(name))
        print("\n".join(differing) or f"{len(digests)} files, all the same")
        raise SystemExit(bool(differing))


def built(config: Path, age_months: float | None) -> dict[str, bytes]:
    """Return the files of a config at an age, or the error why there is none, which is to stay the same too."""
    spec = mimoc.load_spec(config)
    if age_months is not None:
        spec = spec.model_copy(update={"age_months": age_months})
    try:
        return dict(mimoc.build(spec).files)
    except MimocError as error:
        return {"error": str(error).encode()}


if __name__ == "__main__":
    main()
