"""A thread that does one piece of work whenever it is told to.

For work of a tenth of a millisecond that compiled code does without Python's lock: to hand it to a pool
through its queue takes two to three times as long as to open a lock on which the thread waits.
"""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock, Thread


class Helper:
    """A thread that waits for work, until it is closed.

    Args:
        work: called in the thread with what :meth:`begin` is given.
    """

    def __init__(self, work: Callable[[int], object]):
        self._work, self._given, self._closed = work, 0, False
        self._error: BaseException | None = None
        self._told, self._idle = Lock(), Lock()  # taken: nothing to do; at work
        self._told.acquire()
        Thread(target=self._serve, name="edl6dof-helper", daemon=True).start()

    def begin(self, given: int) -> None:
        """Let the thread do its work once, after what it is still at.

        Raises:
            RuntimeError: it is closed.
        """
        if self._closed:
            raise RuntimeError("its threads have been closed")
        self._idle.acquire()
        self._given = given
        self._told.release()

    def wait(self) -> None:
        """Wait until the work is done; raises what it raised.  Who is interrupted here may go on as ever."""
        with self._idle:
            error, self._error = self._error, None
        if error is not None:
            raise error

    def close(self) -> None:
        """Let the thread end, after what it is still at."""
        if not self._closed:
            self._idle.acquire()
            self._closed = True
            self._told.release()

    def _serve(self) -> None:
        while True:
            self._told.acquire()
            if self._closed:
                return
            try:
                self._work(self._given)
            except BaseException as error:
                self._error = error
            finally:
                self._idle.release()
