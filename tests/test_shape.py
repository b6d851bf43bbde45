"""How the code is cut: files and functions that fit on a page or two, and no folder that holds most of it."""

import ast
from collections import Counter
from pathlib import Path
from statistics import median

import pytest

import mimoc

ROOT = Path(mimoc.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
LINES = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in FILES}
FUNCTION_LINES = 40


def test_no_folder_holds_more_than_a_fifth_of_the_code():
    folders = Counter[str]()
    for path, lines in LINES.items():
        folders[path.relative_to(ROOT).parts[0]] += lines
    name, most = folders.most_common(1)[0]
    assert most <= LINES_IN_ALL / 5, name


LINES_IN_ALL = sum(LINES.values())


def test_files_are_short():
    assert median(LINES.values()) < 150
    assert {str(path): lines for path, lines in LINES.items() if lines > 400} == {}


@pytest.mark.parametrize("folder", sorted({path.relative_to(ROOT).parts[0] for path in FILES}))
def test_functions_are_short(folder):
    """Their docstrings, which say shapes and units, do not count."""
    here = [path for path in FILES if path.relative_to(ROOT).parts[0] == folder]
    long = {
        f"{path}:{node.name}": length
        for path in here
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and (length := _length(node)) > FUNCTION_LINES
    }
    assert long == {}


def _length(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    end = function.end_lineno or function.lineno
    text = function.body[0]
    if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
        return end - function.lineno + 1 - ((text.end_lineno or text.lineno) - text.lineno + 1)
    return end - function.lineno + 1
