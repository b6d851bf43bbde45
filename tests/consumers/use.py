"""Run consumers on a folder that `prepare.py` has written: python use.py FOLDER CONSUMER..."""

import sys
from importlib import import_module
from pathlib import Path

if __name__ == "__main__":
    folder, *names = sys.argv[1:]
    for name in names:
        print(f"{name}: {import_module(name).use(Path(folder))}", flush=True)
