"""Long work on threads of their own, so that Ctrl-C is heard while the engine computes."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from queue import SimpleQueue
from typing import TypeVar

from mica._errors import DeviceError
from mica._mica import CancellationToken

Result = TypeVar("Result")
Progress = Callable[[int, int], object]
Report = Callable[[int, int], None]

_PATIENCE = 0.3  # seconds that work has to stop in before it is left to end by itself
_MOST_THREADS = 64  # that wait for devices; the engine computes on its own


@cache
def _threads() -> tuple[ThreadPoolExecutor, int]:
    """Threads that last, since OpenCL keeps something of each that it sees; and the process that they are of."""
    return ThreadPoolExecutor(_MOST_THREADS, "mica"), os.getpid()


def run(work: Callable[[CancellationToken, Report | None], Result], progress: Progress | None = None) -> Result:
    """Runs `work(cancellation, report)` and returns its result, or raises what it raised.

    `progress(done, all)` is called on the caller's thread. What it raises, and KeyboardInterrupt, cancels the
    work and passes through. Work that does not stop at once keeps what it needs, and ends unheard.
    """
    threads, process = _threads()
    if process != os.getpid():
        raise DeviceError(
            "this process was forked from one that had used Mica, without its threads; expected one that was spawned: "
            'multiprocessing.get_context("spawn")'
        )
    cancellation = CancellationToken()
    news: SimpleQueue[tuple[int, int] | None] = SimpleQueue()
    report = None if progress is None else lambda done, whole: news.put((done, whole))
    future = threads.submit(work, cancellation, report)
    future.add_done_callback(lambda _: news.put(None))
    try:
        while (message := news.get()) is not None:
            if progress is not None:
                progress(*message)
    except BaseException:
        cancellation.cancel()
        wait([future], _PATIENCE)
        raise
    return future.result()
