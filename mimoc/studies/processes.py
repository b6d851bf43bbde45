"""Processes that studies run their trials in."""

import signal
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context


def process_pool(processes: int) -> ProcessPoolExecutor:
    """Return a pool of processes that start anew, and leave Ctrl-C to the one that asks for it."""
    return ProcessPoolExecutor(processes, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN))
