"""Triton's compiler kept apart from Mesa's, so that a process can draw and then learn."""

import ctypes
import os
import sys
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

_LIBRARY = "triton._C.libtriton"


def keep_apart() -> None:
    """Load triton's library so that it uses its own LLVM, if triton is installed and not loaded yet.

    Mesa draws without a graphics card by means of LLVM, whose symbols the OpenGL libraries make global in the process.
    A triton that is loaded later finds that LLVM before the one it brings, and the process ends without a message;
    torch builds for CUDA load it with the first optimizer. RTLD_DEEPBIND makes it look at itself first. What is
    loaded stays so when triton is imported. A library that cannot be loaded is left for triton itself to tell of.
    """
    if sys.platform != "linux" or not hasattr(os, "RTLD_DEEPBIND") or _LIBRARY in sys.modules:
        return
    with suppress(ImportError, ValueError, OSError):  # ValueError: something else is called triton here.
        triton = find_spec("triton")
        for folder in (triton.submodule_search_locations or ()) if triton else ():
            library = Path(folder, "_C", "libtriton.so")
            if library.is_file():
                ctypes.CDLL(str(library), os.RTLD_LAZY | os.RTLD_LOCAL | os.RTLD_DEEPBIND)
