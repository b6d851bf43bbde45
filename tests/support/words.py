"""Words that name nothing: which files of mimoc use them as names, and how often.

`python tests/support/words.py` renews `tests/words.txt`, the files that still do. It is only to become shorter.
"""

import ast
from collections import Counter
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]
LIST = CHECKOUT / "tests" / "words.txt"
REFUSED = frozenset({"told", "found", "each", "own", "here", "there"})


def refused_names(source: str) -> list[str]:
    """Return the refused names that a module gives to variables, parameters, attributes, functions and classes."""
    names = (name for node in ast.walk(ast.parse(source)) for name in _given(node))
    return [name for name in names if name in REFUSED]


def _given(node: ast.AST) -> tuple[str | None, ...]:
    """Return the names that a node of a syntax tree gives."""
    match node:
        case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()):
            return (name,)
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
            return (name,)
        case ast.arg(arg=name) | ast.alias(asname=name):
            return (name,)
        case ast.ExceptHandler(name=name) | ast.MatchAs(name=name) | ast.MatchStar(name=name):
            return (name,)
        case ast.MatchMapping(rest=name):
            return (name,)
    return ()


def now() -> Counter[str]:
    """Return how many such names each file of mimoc gives."""
    files = sorted((CHECKOUT / "mimoc").rglob("*.py"))
    counts = {path: len(refused_names(path.read_text(encoding="utf-8"))) for path in files}
    return Counter({path.relative_to(CHECKOUT).as_posix(): count for path, count in counts.items() if count})


def listed() -> Counter[str]:
    """Return how many such names the list allows each file."""
    lines = map(str.split, LIST.read_text(encoding="utf-8").splitlines())
    return Counter({path: int(count) for count, path in lines})


if __name__ == "__main__":
    LIST.write_text("".join(f"{count} {path}\n" for path, count in sorted(now().items())), encoding="utf-8")
    print(f"{now().total()} names in {len(now())} files")
