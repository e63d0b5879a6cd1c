"""Guard of one supervised command: ends the command when the supervisor dies. A script that imports nothing of ours.

``orphan_guard.py FD GRACE_S COMMAND...``: FD is the reading end of a pipe whose writing end only the supervisor
holds. It works wherever pipes exist, and needs no help from the command.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from types import FrameType


def main() -> None:
    """Run the command, pass SIGTERM and SIGINT on to it, and exit with its code."""
    pipe, grace_s, command = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3:]
    try:
        child = subprocess.Popen(command)
    except OSError as error:
        sys.stderr.write(f"safestart: cannot start {command[0]}: {error}\n")
        sys.exit(127)

    def pass_on(number: int, _frame: FrameType | None) -> None:
        child.send_signal(number)

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, pass_on)
    orphaned = threading.Event()
    threading.Thread(target=_watch, args=(pipe, grace_s, child, orphaned), daemon=True).start()
    code = child.wait()
    if orphaned.is_set():
        _sweep()
    if code < 0:
        # End by the same signal, so that the supervisor can name it.
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    sys.exit(code)


def _watch(pipe: int, grace_s: float, child: subprocess.Popen[bytes], orphaned: threading.Event) -> None:
    os.read(pipe, 1)  # returns when the supervisor has died
    orphaned.set()
    child.terminate()
    time.sleep(grace_s)
    _sweep()


def _sweep() -> None:
    """Kill the command, its children and this process: the supervisor made us a process group."""
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    main()
