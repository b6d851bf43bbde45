"""Tensors in files as `torch.save` writes them, read without torch.

`torch.load(weights_only=True)` runs no code either, but it unpacks what is packed to any degree, allocates what a file
asks for, and believes what it says of the sizes of its parts.
"""

import io
import math
import pickle
import pickletools
import zipfile
from collections import OrderedDict
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import torch

MOST_PICKLE_BYTES = 2**24
"""Of what says how the tensors belong together; some kB in all networks of mimoc's."""
_CODES = """
    PROTO STOP MARK EMPTY_DICT EMPTY_LIST EMPTY_TUPLE TUPLE TUPLE1 TUPLE2 TUPLE3 LIST DICT APPEND APPENDS SETITEM
    SETITEMS GLOBAL REDUCE BUILD BINPERSID NONE NEWTRUE NEWFALSE BININT BININT1 BININT2 LONG1 BINFLOAT BINUNICODE
    SHORT_BINUNICODE BINPUT LONG_BINPUT BINGET LONG_BINGET MEMOIZE
"""
OPCODES = frozenset(_CODES.split())
"""Opcodes of pickles of tensors in dictionaries and lists."""
DTYPES = {
    "FloatStorage": "<f4",
    "DoubleStorage": "<f8",
    "HalfStorage": "<f2",
    "LongStorage": "<i8",
    "IntStorage": "<i4",
    "ByteStorage": "u1",
    "BoolStorage": "?",
}
"""Kinds of numbers, by torch's name."""


def read_tensors(content: bytes) -> Any:
    """Return the tensors in a file of torch's; anything else in it is refused.

    Raises:
        ValueError: If the file holds anything but tensors, or is damaged.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            is_plain = all(member.compress_type == zipfile.ZIP_STORED for member in members)
            if not is_plain or sum(member.file_size for member in members) > len(content):
                raise ValueError("it is packed")
            (described,) = (member.filename for member in members if member.filename.endswith("/data.pkl"))
            home = described.removesuffix("data.pkl")
            if f"{home}byteorder" in archive.namelist() and archive.read(f"{home}byteorder") != b"little":
                raise ValueError("its byte order is another one")
            pickled = _checked(archive.read(described))
            return _Unpickler(pickled, lambda key: archive.read(f"{home}data/{key}"), len(content)).load()
    except Exception as error:  # Whatever a stranger's archive makes the readers of ZIP and pickles raise.
        raise ValueError(f"no tensors: {error}") from None


def _checked(pickled: bytes) -> io.BytesIO:
    """Return a pickle that can do nothing but put tensors together, and needs no more memory than its size."""
    if len(pickled) > MOST_PICKLE_BYTES:
        raise ValueError("its description is too long")
    for opcode, argument, _ in pickletools.genops(pickled):
        if opcode.name not in OPCODES:
            raise ValueError(f"it contains {opcode.name}")
        if opcode.name == "LONG_BINPUT" and (argument or 0) > len(pickled):
            raise ValueError("it asks for memory that it does not need")
    return io.BytesIO(pickled)


class _Unpickler(pickle.Unpickler):
    """Puts tensors together: the only things that a pickle can name are those that `torch.save` needs for them."""

    def __init__(self, pickled: io.BytesIO, read: Callable[[str], bytes], most_bytes: int):
        """Begin a pickle.

        Args:
            pickled: The pickle, which `_checked` has returned.
            read: Returns the numbers that are known by some key.
            most_bytes: Of all tensors together; tensors that are the same are only counted once.
        """
        super().__init__(pickled)
        self._read, self._left = cache(read), most_bytes
        self._tensor = cache(self._new_tensor)

    def find_class(self, module_name: str, global_name: str, /) -> Any:
        """Return what stands for a name."""
        match module_name, global_name:
            case "collections", "OrderedDict":
                return OrderedDict
            case "torch._utils", "_rebuild_tensor_v2":
                return lambda part, offset, shape, strides, *_: self._tensor(part, offset, shape, strides)
            case "torch._utils", "_rebuild_parameter":
                return lambda tensor, *_: tensor
            case "torch", name if name in DTYPES:
                return DTYPES[name]
        raise ValueError(f"it names {module_name}.{global_name}")

    def persistent_load(self, pid: Any, /) -> tuple[str, str]:
        """Return key and type of the numbers that tensors are parts of."""
        what, dtype, key, _, count = pid
        if what != "storage" or len(self._read(key)) != count * np.dtype(dtype).itemsize:
            raise ValueError("its parts are not as long as it says")
        return key, dtype

    def _new_tensor(
        self, part: tuple[str, str], offset: int, shape: tuple[int, ...], strides: tuple[int, ...]
    ) -> torch.Tensor:
        """Return a tensor whose numbers stand one after the other."""
        key, dtype = part
        numbers, size = np.frombuffer(self._read(key), dtype), math.prod(shape)
        in_order = [math.prod(shape[place + 1 :]) for place in range(len(shape))]
        orderly = all(stride == own or length < 2 for stride, own, length in zip(strides, in_order, shape, strict=True))
        if min(shape, default=0) < 0 or (size and not orderly) or not 0 <= offset <= offset + size <= len(numbers):
            raise ValueError("a tensor is no part of the numbers that it is said to be a part of")
        self._left -= size * numbers.itemsize
        if self._left < 0:
            raise ValueError("its tensors are larger than it is")
        return torch.from_numpy(numbers[offset : offset + size].reshape(shape).copy())
