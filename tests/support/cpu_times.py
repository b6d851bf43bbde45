"""How much CPU time tests take, by folder, and which of them are slow without being marked so."""

import resource
from collections import Counter
from collections.abc import Iterator
from pathlib import PurePosixPath

import pytest

SLOW_S = 5.0  # CPU time of a test, without its fixtures, from which on it is marked `slow`.


def pytest_configure(config: pytest.Config) -> None:
    """Count the CPU time of whatever runs from now on, in this process and in the workers of xdist."""
    config.pluginmanager.register(CpuTimes())


class CpuTimes:
    """CPU time of this process and of the processes that it has waited for: user and system, [s]."""

    def __init__(self) -> None:
        self._until_now_s = 0.0
        self._of_workers_s = 0.0
        self._by_folder_s: Counter[str] = Counter()
        self._tests_by_folder: Counter[str] = Counter()
        self._unmarked: list[tuple[float, str]] = []

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self) -> None:
        self._until_now_s = _cpu_s()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Iterator[None]:
        """Attach to the report of a set-up, a call or a tear-down the CPU time that it took."""
        report = yield
        now_s = _cpu_s()
        report.cpu_s = now_s - self._until_now_s
        self._until_now_s = now_s
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add up the reports; those of workers arrive in the process that started them."""
        cpu_s = getattr(report, "cpu_s", 0.0)
        folder = _folder(report.nodeid)
        self._by_folder_s[folder] += cpu_s
        self._tests_by_folder[folder] += report.when == "call"
        if report.when == "call" and cpu_s > SLOW_S and "slow" not in report.keywords:
            self._unmarked.append((cpu_s, report.nodeid))

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if hasattr(session.config, "workeroutput"):
            session.config.workeroutput["cpu_s"] = _cpu_s()  # pyright: ignore[reportAttributeAccessIssue]

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node) -> None:
        """Take the time that a worker sent; one that crashed sent none."""
        self._of_workers_s += getattr(node, "workeroutput", {}).get("cpu_s", 0.0)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        write = terminalreporter.write_line
        whole_s = self._of_workers_s or _cpu_s()
        terminalreporter.section("CPU time by folder")
        for folder, cpu_s in self._by_folder_s.most_common():
            write(f"{cpu_s:7.1f} s  {folder}: {self._tests_by_folder[folder]} tests")
        write(f"{whole_s - self._by_folder_s.total():7.1f} s  imports and collection")
        write(f"{whole_s:7.1f} s  in all")
        for cpu_s, test in sorted(self._unmarked, reverse=True):
            write(f"mark as slow, or make faster: {test} ({cpu_s:.1f} s)")


def _cpu_s() -> float:
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def _folder(test: str) -> str:
    """Return the folder right below `tests` that a test is in, or its file where it is in none."""
    return PurePosixPath(test.partition("::")[0]).parts[1]
