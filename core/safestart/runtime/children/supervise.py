"""Keep child commands running: start them, restart those that die, stop all of them together.

Each command runs under :mod:`safestart.runtime.children.orphan_guard`, a small process that reads from a pipe
this process holds open. When this process ends for any reason, the pipe closes and the guard ends its command.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

FIRST_PAUSE_S = 0.5
LONGEST_PAUSE_S = 30.0
# A child that ran this long was healthy: the restart pause begins again at its shortest.
WELL_AFTER_S = 30.0
GRACE_S = 10.0
_TICK_S = 0.1
# Exit code of our command line on wrong settings; a restart would end the same way.
_USAGE_ERROR = 2
_GUARD = Path(__file__).with_name("orphan_guard.py")


@dataclass(frozen=True, slots=True)
class Child:
    """A command to keep running, and its name in messages."""

    name: str
    command: Sequence[str]


class Supervisor:
    """Runs children until it is told to stop."""

    def __init__(
        self,
        children: Sequence[Child],
        *,
        grace_s: float = GRACE_S,
        say: Callable[[str], None] | None = None,
    ) -> None:
        self._kept = [_Kept(child, grace_s) for child in children]
        self._grace_s = grace_s
        self._say = say or _print
        self._stop = threading.Event()

    def run(self) -> int:
        """Run until SIGINT or SIGTERM (exit code 0), or until a child refuses to start (its exit code).

        Call it in the main thread only: it handles the two signals while it runs.
        """
        before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
        for number in before:
            signal.signal(number, lambda *_: self._stop.set())
        try:
            return self._keep()
        finally:
            self._end_all()
            for number, handler in before.items():
                signal.signal(number, handler)

    def stop(self) -> None:
        """Make :meth:`run` return; safe from any thread."""
        self._stop.set()

    def _keep(self) -> int:
        for kept in self._kept:
            kept.start()
        while not self._stop.wait(_TICK_S):
            for kept in self._kept:
                code = kept.ended()
                if code is None:
                    continue
                if code == _USAGE_ERROR and not kept.was_well:
                    self._say(f"{kept.child.name} cannot run (exit code {code}); its reason is above")
                    return code
                pause = kept.plan_restart()
                self._say(f"{kept.child.name} ended ({describe(code)}); starts again in {pause:g} s")
        return 0

    def _end_all(self) -> None:
        for kept in self._kept:
            kept.ask_to_end()
        deadline = time.monotonic() + self._grace_s
        for kept in self._kept:
            if not kept.end(max(deadline - time.monotonic(), 0.0)):
                self._say(f"{kept.child.name} did not stop within {self._grace_s:g} s and was killed")


class _Kept:
    """One child with its current process."""

    def __init__(self, child: Child, grace_s: float) -> None:
        self.child = child
        self.was_well = False
        self._grace_s = grace_s
        self._process: subprocess.Popen[bytes] | None = None
        self._hold: int | None = None
        self._started = 0.0
        self._again_at = 0.0
        self._pause = FIRST_PAUSE_S

    def start(self) -> None:
        """Start the command under its guard, in a session of its own: Ctrl-C at a terminal reaches only us."""
        read, self._hold = os.pipe()
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", str(_GUARD), str(read), str(self._grace_s), *self.child.command],
                pass_fds=(read,),
                stdin=subprocess.DEVNULL,
                start_new_session=True,
            )
        finally:
            os.close(read)
        self._started = time.monotonic()

    def ended(self) -> int | None:
        """Exit code (negative: signal) when the process has just ended; restarts it when its pause is over."""
        if self._process is None:
            if time.monotonic() >= self._again_at:
                self.start()
            return None
        code = self._process.poll()
        if code is None:
            self.was_well = self.was_well or time.monotonic() - self._started >= WELL_AFTER_S
        else:
            self._sweep()
        return code

    def plan_restart(self) -> float:
        """Seconds until the next start: doubled every time, reset after a good run."""
        if time.monotonic() - self._started >= WELL_AFTER_S:
            self._pause = FIRST_PAUSE_S
        pause, self._pause = self._pause, min(2 * self._pause, LONGEST_PAUSE_S)
        self._again_at = time.monotonic() + pause
        return pause

    def ask_to_end(self) -> None:
        """Send SIGTERM; the guard passes it to the command alone, which ends its own processes in order."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()

    def end(self, within_s: float) -> bool:
        """Wait, then kill whatever is left of the session. Returns False when it had to kill."""
        if self._process is None:
            return True
        in_time = True
        try:
            self._process.wait(within_s)
        except subprocess.TimeoutExpired:
            in_time = False
        self._sweep()
        return in_time

    def _sweep(self) -> None:
        """Kill what the command left behind in its process group, and forget the process."""
        assert self._process is not None
        with suppress(ProcessLookupError, PermissionError):  # no process is left (macOS raises the second)
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._process = None
        if self._hold is not None:
            os.close(self._hold)
            self._hold = None


def describe(code: int) -> str:
    """An exit code in words: ``exit code 3`` or ``signal 9, SIGKILL``."""
    if code >= 0:
        return f"exit code {code}"
    try:
        return f"signal {-code}, {signal.Signals(-code).name}"
    except ValueError:
        return f"signal {-code}"


def _print(line: str) -> None:
    print(f"safestart: {line}", file=sys.stderr, flush=True)
