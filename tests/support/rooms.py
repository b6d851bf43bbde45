"""The rooms of mimoc and the imports between them; `python -m tests.support.rooms` prints what the house looks like."""

import ast
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import mimoc

ROOT = Path(mimoc.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
MODULES = {
    ".".join(("mimoc", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__"): path for path in FILES
}
FLOORS = (  # The rooms from the ground up. Each may import those on the floors below it, and none beside it.
    ("base",),
    ("anatomy", "fits"),
    ("schema",),
    ("body", "bundle"),
    ("compiler", "render", "motion"),
    ("runtime",),
    ("components", "policies", "plugin"),
    ("recording", "compat"),
    ("training", "movement"),
    ("studies",),
    ("viewer",),
    ("mimoc",),
    ("cli",),
)
FLOOR_OF = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
ALIASES = {"version": "base", "__main__": "cli"}
NAMED_RECORDS = ("mimoc.schema.kinds", "mimoc.base.quantities", "mimoc.base.movement_quantities")
"""Tables that name the code of their records by module, to be imported when it is asked for."""


@dataclass(frozen=True)
class Import:
    module: str  # Full name of the importing module.
    line: int
    name: str  # Full name of what is imported.

    @property
    def target(self) -> str:
        """The module that it is imported from: the name itself, or all of it but its end."""
        return self.name if self.name in MODULES or "." not in self.name else self.name.rpartition(".")[0]


def room_of(module: str) -> str:
    """Return the room of a module of mimoc: its folder, or itself if it is at the top."""
    room = "mimoc" if module == "mimoc" else module.split(".")[1]
    return ALIASES.get(room, room)


def imports(module: str, source: str, *, is_package: bool = False) -> list[Import]:
    """Return every import of a module, wherever it stands, and those that a string names."""
    nodes = [*ast.walk(ast.parse(source))]
    found = [Import(module, node.lineno, name) for node in nodes for name in _imported(node, module, is_package)]
    if not module.startswith(NAMED_RECORDS):
        found += [Import(module, node.lineno, name) for node in nodes for name in _named(node)]
    return found


def all_imports() -> list[Import]:
    return [
        each
        for module, path in MODULES.items()
        for each in imports(module, path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py")
    ]


def arrows(found: list[Import]) -> dict[tuple[str, str], list[Import]]:
    """Return the pairs of rooms of which the first imports from the second, with these imports."""
    result = defaultdict(list)
    for each in found:
        if each.name.startswith("mimoc") and (ends := (room_of(each.module), room_of(each.target)))[0] != ends[1]:
            result[ends].append(each)
    return result


def runs_up(arrow: tuple[str, str]) -> bool:
    return FLOOR_OF.get(arrow[0], -1) <= FLOOR_OF.get(arrow[1], len(FLOORS))


def module_graph(found: list[Import]) -> dict[str, set[str]]:
    """Return the modules that each imports, but for the packages around it and the front door."""
    graph: dict[str, set[str]] = {name: set() for name in MODULES}
    for each in found:
        front_door = "mimoc" in (each.module, each.target)
        if each.target in graph and not front_door and not each.module.startswith((each.target, f"{each.target}.")):
            graph[each.module].add(each.target)
    return graph


def report() -> list[str]:
    found = all_imports()
    pairs = arrows(found)
    top = [path for path in ROOT.iterdir() if not path.name.startswith((".", "__pycache__"))]
    up = {arrow: where for arrow, where in pairs.items() if runs_up(arrow)}
    lines = [
        f"{sum(path.is_dir() for path in top)} folders, {sum(path.suffix == '.py' for path in top)} files at the top",
        f"{len(FLOORS)} floors, {len(pairs)} arrows between them, {len(up)} that run up, {len(circles(pairs))} circles",
    ]
    for (room, other), where in sorted(up.items()):
        lines += [f"{room} -> {other}", *sorted({f"  {each.module}:{each.line} imports {each.name}" for each in where})]
    return lines


def circles(pairs: Iterable[tuple[str, str]]) -> list[set[str]]:
    """Return the largest sets of rooms each of which imports all others of its set, directly or through others."""
    reach = defaultdict(set)
    for room, other in pairs:
        reach[room].add(other)
    for _ in range(len(FLOOR_OF)):
        for room in [*reach]:
            reach[room] |= {further for other in reach[room] for further in reach.get(other, ())}
    together = {frozenset(other for other in reach[room] if room in reach.get(other, ())) for room in reach}
    return [set(rooms) for rooms in together if rooms]


def _imported(node: ast.AST, module: str, is_package: bool) -> Iterator[str]:
    """Yield full names; of `from mimoc import body` a module's, of `from mimoc.body import grow_body` a function's."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        package = module.split(".") if is_package else module.split(".")[:-1]
        above = package[: len(package) - node.level + 1] if node.level else []
        origin = [*above, node.module] if node.module else above
        yield from (".".join([*origin, alias.name]) for alias in node.names)


def _named(node: ast.AST) -> Iterator[str]:
    """Yield what a string imports: `"mimoc.body.grow"`, `import_module("torch")`, `import_module(f"av.{x}")`."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        name = node.value.partition(":")[0]
        if name in MODULES and name not in ("mimoc", "mimoc.motion", "mimoc.policies"):  # Groups of entry points.
            yield name
    elif isinstance(node, ast.Call) and node.args and ast.unparse(node.func).split(".")[-1] == "import_module":
        (first, *_) = getattr(node.args[0], "values", [node.args[0]])  # The first part of an f-string.
        if isinstance(first, ast.Constant) and not first.value.startswith("mimoc"):
            yield first.value.rstrip(".")


if __name__ == "__main__":
    print(*report(), sep="\n")
