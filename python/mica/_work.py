"""Long work on a thread of its own, so that Ctrl-C is heard while the engine computes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from queue import SimpleQueue
from threading import Thread
from typing import Generic, TypeVar

from mica._mica import CancellationToken

Result = TypeVar("Result")
Progress = Callable[[int, int], object]
Report = Callable[[int, int], None]

_PATIENCE = 0.3  # seconds that work has to stop in before it is left to end by itself


@dataclass
class _Ended(Generic[Result]):
    result: Result | None = None
    error: BaseException | None = None


def run(work: Callable[[CancellationToken, Report | None], Result], progress: Progress | None = None) -> Result:
    """Runs `work(cancellation, report)` and returns its result, or raises what it raised.

    `progress(done, all)` is called on the caller's thread. What it raises, and KeyboardInterrupt, cancels the
    work and passes through. Work that does not stop at once keeps what it needs, and ends unheard.
    """
    cancellation = CancellationToken()
    news: SimpleQueue[tuple[int, int] | _Ended[Result]] = SimpleQueue()
    report = None if progress is None else lambda done, whole: news.put((done, whole))

    def body() -> None:
        try:
            news.put(_Ended(result=work(cancellation, report)))
        except BaseException as error:  # noqa: BLE001: the caller's thread raises it
            news.put(_Ended(error=error))

    thread = Thread(target=body, name="mica")
    try:
        thread.start()
        while not isinstance(message := news.get(), _Ended):
            if progress is not None:
                progress(*message)
    except BaseException:
        cancellation.cancel()
        if thread.ident is not None:
            thread.join(_PATIENCE)
        raise
    thread.join()
    try:
        if message.error is not None:
            raise message.error
        return message.result  # type: ignore[return-value]
    finally:
        del message  # an error's traceback holds this frame
