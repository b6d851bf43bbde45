"""The contracts of senses and of terms: a term gives the same on one infant, on many, and on a device.

Senses, tasks and terms of plug-ins and scripts are held to this where an environment first uses them, not after that.
Nothing here needs a GPU: what a term may not do shows on arrays that refuse it.
"""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import mujoco
import numpy as np
from gymnasium import Space
from gymnasium.spaces import Box

from mimoc.base.errors import KindError, MissingExtraError
from mimoc.runtime.term import Put, Term, is_amount, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_many, worlds_of_one

KINDS = {"f": "real", "i": "whole", "u": "whole", "b": "truth"}  # Types that are cast, by NumPy's letter.


def check_observation(what: str, observed: Any, spaces: Mapping[str, Space[Any]]) -> None:
    """Check what a sense or a task observes; *what* names it with its class."""
    if not isinstance(observed, Mapping) or observed.keys() != spaces.keys():
        given = ", ".join(map(str, observed)) if isinstance(observed, Mapping) else f"{observed!r:.60}"
        raise KindError(f"{what}: observe() returns {given or 'nothing'}; expected {', '.join(spaces) or 'nothing'}")
    for name, space in spaces.items():
        if isinstance(space, Box):
            check_numbers(
                f"{what}: '{name}' in its observation", observed[name], space.shape, space.dtype, exactly=True
            )
        elif not space.contains(observed[name]):
            raise KindError(f"{what}: '{name}' in its observation is {told(observed[name])}; expected one of {space}")


def check_rows(what: str, given: Any, infants: int) -> None:
    """Check that something is an array with a row for each infant."""
    if np.shape(given)[:1] != (infants,):
        raise KindError(f"{what} returns {told(given)}; expected an array of shape ({infants}, ...): one row an infant")


def check_numbers(what: str, given: Any, shape: tuple[int, ...], dtype: Any, *, exactly: bool = False) -> None:
    """Check the shape and type of an array: exactly this type, or any precision of the same kind."""
    dtype, expected = np.dtype(dtype), f"expected an array of {np.dtype(dtype)}, shape {shape}"
    try:
        array = np.asarray(given)
    except ValueError:  # Lists of different lengths.
        array = np.asarray(None)
    is_type = array.dtype == dtype if exactly else KINDS.get(array.dtype.kind) == KINDS[dtype.kind]
    if array.shape != shape or not is_type:
        raise KindError(f"{what} is {told(given)}; {expected}")
    if np.isnan(array).any():
        raise KindError(f"{what} has a NaN; {expected}, with numbers only")


def told(value: Any) -> str:
    """Describe a value in a few words, for an error."""
    if isinstance(value, (np.ndarray, np.generic)):
        return f"an array of {value.dtype}, shape {value.shape}"
    return f"{value!r:.60}"


INFANTS = 7
TOLERANCE = 1e-5  # Tolerance of 32-bit numbers, in terms of the larger of 1 and the number itself.
RESULT = "the result"
STEPS = 20  # Physics steps with random controls from the first keyframe, after which contacts press.


class TermError(KindError):
    """A term breaks the contract that lets it run on one infant, on many, and on a device."""


def check_term(term: Term, model: mujoco.MjModel, *args: Any) -> None:
    """Check that a term keeps the contract, in random states of a model.

    1. One infant equals row i of seven to the bit.
    2. It runs under `array_api_strict`, so it asks for no more than the array API standard.
    3. It runs under torch's `FakeTensorMode`, so it reads no value, which would stop a device.
    4. With torch's 32-bit numbers it is within 1e-5 of NumPy.

    Args:
        term: The term of one infant.
        model: The model that it is bound to.
        args: What its kind gives it besides worlds, in the same nest of dictionaries: arrays with a leading axis of 7.

    Raises:
        TermError: If it breaks the contract; the text says how.
        MissingExtraError: If `array_api_strict` or torch is not installed.
    """
    datas = _states(model)
    terms = [_varied(term, index) for index in range(INFANTS)]
    many = _call(terms, _stacked_worlds(datas), args, "NumPy", np.asarray)
    for index, data in enumerate(datas):
        row = _mapped(args, lambda array, index=index: array[index : index + 1])
        one = _call([terms[index]], worlds_of_one(data), row, "NumPy", np.asarray)
        for name, array in one.items():
            if array.shape != (1, *many[name].shape[1:]) or array.tobytes() != many[name][index].tobytes():
                raise TermError(
                    f"{_name(term)}: {name} of one infant is not row {index} of {INFANTS} infants' to the bit"
                )
    try:
        import array_api_strict as xp
    except ImportError:
        raise MissingExtraError("array-api-strict", "gpu") from None
    with warnings.catch_warnings(), xp.ArrayAPIStrictFlags(boolean_indexing=False, data_dependent_shapes=False):
        warnings.simplefilter("ignore")  # Which version of the standard it is.
        put = xp.asarray
        result = _call(terms, _worlds_in(xp, datas, put), _mapped(args, put), "array_api_strict", put)
    for name, array in result.items():
        if not isinstance(array, type(put(0))):
            raise TermError(f"{_name(terms[0])}: {name} is {type(array).__name__}, not an array of worlds.xp")
    _check_torch(terms, datas, args, many)


def _check_torch(terms: list[Term], datas: list[mujoco.MjData], args: Any, expected: Mapping[str, np.ndarray]) -> None:
    try:
        import array_api_compat.torch as xp
        from torch import as_tensor, float32
        from torch._subclasses.fake_tensor import FakeTensorMode
    except ImportError:
        raise MissingExtraError("torch", "gpu") from None

    def put(values: np.ndarray) -> Any:
        return as_tensor(np.ascontiguousarray(values), dtype=float32 if values.dtype.kind == "f" else None)

    result = _call(terms, _worlds_in(xp, datas, put), _mapped(args, put), "torch", put)
    for name, array in result.items():
        if not np.allclose(array.numpy(), expected[name], TOLERANCE, TOLERANCE, equal_nan=True):
            raise TermError(f"{_name(terms[0])}: {name} with torch is not within {TOLERANCE:g} of NumPy")
    mode, originals = FakeTensorMode(), dict[Any, np.ndarray]()

    def fake(values: np.ndarray) -> Any:
        tensor = mode.from_tensor(put(values))
        originals[tensor] = values
        return tensor

    with mode:
        worlds = _worlds_in(xp, datas, fake, originals.__getitem__)
        _call(terms, worlds, _mapped(args, fake), "torch's FakeTensorMode", fake)


def _call(terms: list[Term], worlds: Worlds, args: Any, library: str, put: Put) -> dict[str, Any]:
    try:
        return dict(_arrays(RESULT, stack_terms(terms, put)(worlds, *args)))
    except Exception as error:
        text = str(error).partition("\n")[0]
        raise TermError(f"{_name(terms[0])} does not run with {library}: {type(error).__name__}: {text}") from error


def _states(model: mujoco.MjModel) -> list[mujoco.MjData]:
    generator = np.random.default_rng(0)
    datas = list[mujoco.MjData]()
    for index in range(INFANTS):
        data = mujoco.MjData(model)
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        for _ in range(STEPS + index):
            data.ctrl[:] = generator.uniform(-1.0, 1.0, model.nu)
            mujoco.mj_step(model, data)
        datas.append(data)
    return datas


def _stacked_worlds(datas: list[mujoco.MjData]) -> Worlds:
    return worlds_of_many(datas, lambda field: np.stack([getattr(data, field) for data in datas]))


def _worlds_in(
    xp: Any, datas: list[mujoco.MjData], put: Put, numbers: Callable[[Any], np.ndarray] = np.asarray
) -> Worlds:
    worlds = _stacked_worlds(datas)
    return Worlds(
        xp,
        lambda field: put(getattr(worlds, field)),
        lambda groups: put(worlds.pressing(numbers(groups))),
        lambda groups: put(worlds.loads(numbers(groups))),
    )


def _varied(term: Any, index: int) -> Any:
    """Return a term whose amounts are *index* percent larger, as another infant has them."""
    if isinstance(term, tuple):
        items: tuple[Any, ...] = term
        return tuple(_varied(item, index) for item in items)
    if isinstance(term, Term):
        return replace(term, **{field.name: _varied(getattr(term, field.name), index) for field in fields(term)})
    return term * (1.0 + index / 100) if is_amount(term) else term


def _mapped(values: Any, function: Callable[[Any], Any]) -> Any:
    if isinstance(values, tuple):
        items: tuple[Any, ...] = values
        return tuple(_mapped(value, function) for value in items)
    if isinstance(values, dict):
        mapping: dict[str, Any] = values
        return {name: _mapped(value, function) for name, value in mapping.items()}
    return function(values)


def _arrays(name: str, result: Any) -> list[tuple[str, Any]]:
    """Return the arrays in the result of a term by name; a function in it is called."""
    parts: dict[str, Any] = {}
    if isinstance(result, Mapping):
        parts = dict(result)
    elif hasattr(result, "_asdict"):
        parts = result._asdict()
    elif isinstance(result, tuple):
        items: tuple[Any, ...] = result
        parts = {f"{name}[{index}]": value for index, value in enumerate(items)}
    elif is_dataclass(result):
        parts = {field.name: getattr(result, field.name) for field in fields(result)}
    elif callable(result):
        return _arrays(name, result())
    elif not isinstance(result, (bool, int, str, type(None))):
        return [(name, result)]
    prefix = "" if name == RESULT else f"{name} "
    return [item for key, value in parts.items() for item in _arrays(f"{prefix}{key}", value)]


def _name(term: Term) -> str:
    return f"the term {type(term).__name__}"
