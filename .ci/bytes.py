"""Build every config and print a digest of all files of all bundles: the same wherever and with whatever it is run."""

import hashlib
from pathlib import Path

import mimoc

CONFIGS = sorted((Path(__file__).resolve().parents[1] / "configs").glob("*.yaml"))


def main() -> None:
    """Print the digest."""
    digest = hashlib.sha256()
    for config in CONFIGS:
        for name, content in sorted(mimoc.build(config).files.items()):
            digest.update(f"{config.stem}/{name} {hashlib.sha256(content).hexdigest()}\n".encode())
    print(digest.hexdigest())


if __name__ == "__main__":
    main()
