"""Words that name nothing: which names of a module are among them."""

import ast

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
