"""Claims decided side by side, each in a process that can be ended: what a claim takes, it takes from no other.

A worker is a fresh interpreter. It gets items and sends results through its pipes, and is ended, and replaced, when a
claim takes more time than it may. The pipes hold what this program writes itself.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from queue import SimpleQueue
from threading import Lock, Timer

import derive
from derive.check.item import Item
from derive.check.result import Result
from derive.claim import Answer, Verdict

__all__ = ["Worker", "judge_side_by_side", "serve"]

BOOT = "import sys; sys.path.append(sys.argv[1]); from derive.check.pool import serve; serve(float(sys.argv[2]))"
STARTING = 60.0  # seconds for the interpreter to start
MEMORY = 6 * 2**30  # bytes of address space of a worker


class Worker:
    """A process that judges one claim at a time."""

    def __init__(self, seconds: float):
        self.seconds = seconds
        self.lock = Lock()
        self.closed = False
        self.process = self._start()

    def _start(self) -> subprocess.Popen[bytes]:
        root = str(Path(derive.__file__).parents[1])
        return subprocess.Popen(
            [sys.executable, "-P", "-c", BOOT, root, str(self.seconds)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )

    def judge(self, item: Item) -> Result | None:
        """Return what is said of a claim; undecided if it takes too long or ends the process."""
        if self._receive(STARTING) != "ready":
            return _given_up(item, "the process that decides claims does not start")
        late: list[bool] = []
        try:
            pickle.dump(item, self._pipe())
            self._pipe().flush()
            result = self._receive(self.seconds, late)
        except (OSError, ValueError):
            result = "ended"
        if not isinstance(result, str):
            return result
        self._again()
        why = f"not decided within {self.seconds:g} s; --timeout gives more" if late else "its decision broke off"
        return _given_up(item, why)

    def _pipe(self):
        assert self.process.stdin is not None
        return self.process.stdin

    def _receive(self, seconds: float, late: list[bool] | None = None) -> Result | str | None:
        """Return what the process sends; it is ended when that takes too long."""

        def end() -> None:
            if late is not None:
                late.append(True)
            self.process.kill()

        timer = Timer(seconds, end)
        timer.start()
        try:
            assert self.process.stdout is not None
            return pickle.load(self.process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            return "ended"
        finally:
            timer.cancel()

    def _again(self) -> None:
        """Start a fresh process in the place of the present one."""
        self.close()
        with self.lock:
            if not self.closed:
                self.process = self._start()

    def close(self, for_good: bool = False) -> None:
        """End the process."""
        with self.lock:
            self.closed = self.closed or for_good
            self.process.kill()
            self.process.communicate()


def _given_up(item: Item, why: str) -> Result:
    return Result(item.claim, "undecided", Answer(Verdict.undecided, notes=(why,)))


def judge_side_by_side(
    items: Sequence[Item], seconds: float, jobs: int, progress: Callable[[int, int], None]
) -> list[Result | None]:
    """Judge claims in ``jobs`` processes; results in the order of the claims, whatever ends first."""
    count = max(1, min(jobs, len(items)))
    workers: list[Worker] = []
    free: SimpleQueue[Worker] = SimpleQueue()

    def judged(item: Item) -> Result | None:
        worker = free.get()
        try:
            return worker.judge(item)
        finally:
            free.put(worker)

    executor = ThreadPoolExecutor(count)
    try:
        while len(workers) < count:
            workers.append(Worker(seconds))
            free.put(workers[-1])
        futures = [executor.submit(judged, item) for item in items]
        for done, _ in enumerate(as_completed(futures), 1):
            progress(done, len(items))
        return [future.result() for future in futures]
    finally:
        for worker in workers:
            worker.close(for_good=True)
        executor.shutdown(cancel_futures=True)


# ------------------------------------------------------------------------------------------------ in the process
def serve(seconds: float) -> None:
    """Judge items from standard input until it ends; results go to standard output."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what libraries print
    _bound_memory()
    from derive.check.judge import judge

    while True:
        pickle.dump("ready", answers)
        answers.flush()
        try:
            item = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        pickle.dump(judge(item, seconds), answers)


def _bound_memory() -> None:
    try:
        import resource
    except ImportError:  # not on this system
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
