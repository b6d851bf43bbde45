"""Which tests run one after the other in the same worker of pytest-xdist."""

import pytest

TOGETHER = ("tests/runtime/device/",)
"""Folders whose tests run in one worker, so that kernels are compiled once where nothing is cached yet."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log):
    """Let `--dist loadfile` keep the files of some folders together, too."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler.loadfile import LoadFileScheduling

    class ByFileOrFolder(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return next((folder for folder in TOGETHER if nodeid.startswith(folder)), super()._split_scope(nodeid))

    return ByFileOrFolder(config, log)
