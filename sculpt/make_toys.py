"""Make the toys that ship with mimoc: `python sculpt/make_toys.py`, or `.ci/task toys`."""

import json

from toys import animals, food, household, playthings, vehicles

from mimoc.bundle.io import Array, pack_arrays
from mimoc.compiler.toys import ToyModel
from mimoc.components.toys.builtin import FIGURES, MESHES

TOYS = {
    animals: "bunny chicken elephant fish octopus penguin pig whale",
    food: "apple banana cookie cupcake donut hamburger ice_cream mushroom pear",
    household: "bottle bowl chair cup hat mug sofa",
    playthings: "ball chess_piece drum hammer key robot",
    vehicles: "airplane boat bus car tractor train truck",
}
"""Names of the functions of each module that return a toy: the toys, each of which belongs to a category of Toys4K."""


def main() -> None:
    """Write the meshes and everything else of all toys."""
    toys = make_toys()
    lines = [f" {json.dumps(toy.name)}: {json.dumps(figures(toy))}" for toy in toys]
    FIGURES.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    MESHES.write_bytes(pack_arrays({name: array for toy in toys for name, array in arrays(toy).items()}))


def make_toys() -> list[ToyModel]:
    """Return all toys, sorted by name."""
    functions = {name: getattr(module, name) for module, names in TOYS.items() for name in names.split()}
    return [functions[name]() for name in sorted(functions)]


def figures(toy: ToyModel) -> dict[str, object]:
    """Return what is known of a toy besides the meshes of its parts."""
    return {
        "density_kg_m3": toy.density_kg_m3,
        "volume": toy.volume,
        "source": toy.source,
        "tints": [part.tint for part in toy.parts],
        "solids": [
            {"type": solid.type, "size": solid.size, "pos": solid.pos, "quat": solid.quat} for solid in toy.solids
        ],
    }


def arrays(toy: ToyModel) -> dict[str, Array]:
    """Return the meshes of a toy's parts, by their names in the archive."""
    return {
        f"{toy.name}/{part.tint}/{name}": array
        for part in toy.parts
        for name, array in (("vertices", part.mesh.vertices), ("faces", part.mesh.faces.astype("uint16")))
    }


if __name__ == "__main__":
    main()
