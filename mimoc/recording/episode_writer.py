"""Writing of episodes: in parts while they are recorded, each whole or absent, and in one set of files at their end."""

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from mimoc.recording import frames, tables
from mimoc.recording.blocks import Block
from mimoc.recording.described import Described
from mimoc.recording.description import as_json, read_sidecar
from mimoc.recording.folder import PART, WHOLE, EpisodeFiles, part_stem, remove_files, with_extension, write_json
from mimoc.units import ms_to_s


def rate_hz(step_ms: float) -> Fraction:
    """Return how many control steps, and pictures, there are in a second."""
    return 1 / Fraction(ms_to_s(step_ms)).limit_denominator(1_000_000)


def write_part(stem: Path, number: int, block: Block, described: Described, told: Mapping[str, Any]) -> None:
    """Write some rows of an episode; its sidecar comes last, and without it the rest counts for nothing.

    Args:
        stem: Path of the episode's files, without extension.
        number: Number of this part.
        block: The rows.
        described: What their numbers are.
        told: What its sidecar says.

    Raises:
        OutputError: If a file cannot be written.
    """
    part = part_stem(stem, number)
    for reading in described.readings:
        if reading.kind == "picture":
            pictures = block.dense[reading.name][: block.rows]
            frames.write_pictures(with_extension(part, f".{reading.name}"), pictures, rate_hz(described.step_ms))
    tables.write_block(with_extension(part, PART), block, described)
    write_json(with_extension(part, ".json"), {**told, "rows": block.rows})


def finish(episode: EpisodeFiles, ended: str, described: Described | None = None) -> None:
    """Join the parts of an episode.

    Args:
        episode: Where they are.
        ended: How it ended.
        described: What its numbers are; by default what its files say.

    Raises:
        OutputError: If a file cannot be written.
        RecordingError: If a part is damaged.
    """
    stem = episode.stem
    described = described or tables.describe(episode.tables)
    for reading in described.readings:
        for extension in (frames.LOSSLESS, frames.VIDEO) if reading.kind == "picture" else ():
            parts = episode.pictures(reading.name, extension)
            whole = with_extension(stem, f".{reading.name}{extension}")
            frames.join_videos(whole, parts, rate_hz(described.step_ms))
    tables.join(with_extension(stem, WHOLE), episode.tables)
    sidecar = read_sidecar(episode.sidecars, below=episode.folder)
    write_json(with_extension(stem, ".json"), as_json(sidecar.model_copy(update={"ended": ended})))
    remove_files(sorted(stem.parent.glob(f"{stem.name}.part*"), key=lambda path: path.suffix != ".json"))
