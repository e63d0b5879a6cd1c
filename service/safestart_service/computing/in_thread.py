"""Work in a thread of a pool, which is never done where it was refused."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

Answer = TypeVar("Answer")


def begun(pool: ThreadPoolExecutor, work: Callable[[], Answer]) -> asyncio.Future[Answer]:
    """The work, in line for a thread; raises ``RuntimeError`` where the system gives us none, or the pool is closed.

    A pool that cannot start another thread has queued the work all the same: a thread that it already has would do
    later what was refused, and submit a job.
    """
    done: Future[Answer] = Future()

    def do() -> None:
        if done.set_running_or_notify_cancel():
            try:
                done.set_result(work())
            except BaseException as error:  # whoever waits gets it
                done.set_exception(error)

    try:
        pool.submit(do).add_done_callback(lambda queued: queued.cancelled() and done.cancel())
    except RuntimeError:
        if done.cancel():
            raise
    return asyncio.wrap_future(done)
