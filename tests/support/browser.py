"""Waiting for pages in a browser."""

from typing import Any


def wait_for(page: Any, condition: str) -> None:
    """Wait until a condition holds; Playwright's own way makes functions of text, which pages forbid themselves."""
    page.evaluate(f"(async () => {{ while (!({condition})) await new Promise((next) => setTimeout(next, 20)); }})()")
