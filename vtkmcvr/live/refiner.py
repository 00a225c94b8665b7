"""A thread that refines pictures while the interface goes on."""

from __future__ import annotations

import threading
from collections.abc import Hashable

from .job import Cancellable


class Refiner:
    """Works on the picture of each view, the one with the fewest samples first.

    No VTK is called from its thread. Kernels run without the interpreter's lock.
    """

    def __init__(self) -> None:
        self._jobs: dict[Hashable, Cancellable] = {}
        self._change = threading.Condition()
        self._closing = False
        self._running = threading.Event()
        self._running.set()
        self._thread: threading.Thread | None = None
        self.error: BaseException | None = None

    def put(self, owner: Hashable, job: Cancellable) -> None:
        """Refine this picture of `owner`, instead of the last one."""
        with self._change:
            self._drop(owner)
            self._jobs[owner] = job
            job.running = self._running
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="vtkmcvr", daemon=True)
                self._thread.start()
            self._change.notify_all()

    def drop(self, owner: Hashable) -> None:
        """Stop working for `owner`; returns at once."""
        with self._change:
            self._drop(owner)

    def pause(self) -> None:
        """Leave the processors to what draws, from the tiles at work on, until `go_on`."""
        self._running.clear()

    def go_on(self) -> None:
        """Go on after a pause."""
        self._running.set()

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until all pictures are done; False after `timeout` seconds."""
        with self._change:
            return self._change.wait_for(lambda: self._next() is None, timeout)

    def reraise(self) -> None:
        """Raise what went wrong in the thread, once."""
        error, self.error = self.error, None
        if error is not None:
            raise error

    def close(self) -> None:
        """Stop all work and end the thread."""
        with self._change:
            self._closing = True
            for owner in list(self._jobs):
                self._drop(owner)
            self._change.notify_all()
        if self._thread is not None:
            self._thread.join()

    def _drop(self, owner: Hashable) -> None:
        old = self._jobs.pop(owner, None)
        if old is not None:
            old.cancel()

    def _next(self) -> Cancellable | None:
        waiting = [job for job in self._jobs.values() if not job.done and not job.cancelled]
        return min(waiting, key=lambda job: job.samples, default=None)

    def _work(self) -> None:
        while True:
            with self._change:
                self._change.wait_for(lambda: self._closing or self._next() is not None)
                job = self._next()
                if self._closing or job is None:
                    return
            try:
                job.advance()
            except BaseException as error:
                self.error = error
                job.cancel()
            with self._change:
                self._change.notify_all()
