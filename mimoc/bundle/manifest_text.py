"""The manifest, read from its file."""

import json

from pydantic import ValidationError

from mimoc.bundle.json_files import problems_in
from mimoc.bundle.manifest import MANIFEST_VERSION, Manifest
from mimoc.bundle.plugins_needed import check_plugins
from mimoc.errors import BundleError

MANIFEST = "manifest.json"
MOST_BYTES = 2**22
"""4 MB; a room with fifty toys and an infant with ten fingers have 56 kB."""


def read_manifest(content: bytes) -> Manifest:
    """Return the manifest that a file contains.

    Raises:
        BundleError: If a plug-in is missing that it needs, or if it is not what mimoc writes.
    """
    if len(content) > MOST_BYTES:
        raise BundleError(f"{MANIFEST}: it has more than {MOST_BYTES >> 20} MB, which no infant needs")
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        raise BundleError(f"{MANIFEST}: it is damaged; build it again") from None
    check_plugins(data)
    if not isinstance(data, dict) or data.get("manifest", MANIFEST_VERSION) != MANIFEST_VERSION:
        advice = f"this version of mimoc reads manifests of version {MANIFEST_VERSION} only; build it again"
        raise BundleError(advice)
    try:
        return Manifest.model_validate_json(content)
    except ValidationError as error:
        raise BundleError(f"{MANIFEST}: {problems_in(error)}; build it again") from None
