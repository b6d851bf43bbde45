"""The library of toys that come with mimoc; each belongs to a category of Toys4K."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from mimoc.toys.builtin import animals, fruit, household, playthings, sea_animals, sweets, vehicles
from mimoc.toys.model import ToyModel

BUILTIN: Mapping[str, Callable[[], ToyModel]] = MappingProxyType(
    {
        "airplane": vehicles.airplane,
        "apple": fruit.apple,
        "ball": playthings.ball,
        "banana": fruit.banana,
        "boat": vehicles.boat,
        "bottle": household.bottle,
        "bowl": household.bowl,
        "bunny": animals.bunny,
        "bus": vehicles.bus,
        "car": vehicles.car,
        "chair": household.chair,
        "chess_piece": playthings.chess_piece,
        "chicken": animals.chicken,
        "cookie": sweets.cookie,
        "cup": household.cup,
        "cupcake": sweets.cupcake,
        "donut": sweets.donut,
        "drum": playthings.drum,
        "elephant": animals.elephant,
        "fish": sea_animals.fish,
        "hamburger": sweets.hamburger,
        "hammer": playthings.hammer,
        "hat": household.hat,
        "ice_cream": sweets.ice_cream,
        "key": playthings.key,
        "mug": household.mug,
        "mushroom": fruit.mushroom,
        "octopus": sea_animals.octopus,
        "pear": fruit.pear,
        "penguin": sea_animals.penguin,
        "pig": animals.pig,
        "robot": playthings.robot,
        "sofa": household.sofa,
        "tractor": vehicles.tractor,
        "train": vehicles.train,
        "truck": vehicles.truck,
        "whale": sea_animals.whale,
    }
)
"""Functions that return each toy, by its name, which is also its category; results are cached."""
