"""A process of our own: what the user has configured for the libraries that we use does not reach it.

Matplotlib, Dask, Numba, JAX and libpq read variables and files of the user's, meant for notebooks and other programs:
a style that needs LaTeX, a lifetime of Dask's workers, a device that is not there, another server than the URL's. Our
settings are in :mod:`safestart.runtime.settings`. A program that imports our packages keeps its own configuration.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
from collections.abc import Callable, MutableMapping

from safestart.errors import InvalidInput, SafestartError
from safestart.runtime.logs import legible

_READ_BY_LIBRARIES = ("MPL", "MATPLOTLIB", "NUMBA_", "JAX_", "XLA_", "PG", "PSYCOPG_")
# Where caches are kept. A place that cannot be used is bypassed.
_PLACES = frozenset({"NUMBA_CACHE_DIR", "MPLCONFIGDIR"})
# How we prove who we are to PostgreSQL and it to us: dropping them would make a connection less secure, silently.
_PROOFS = (
    *("PGPASSWORD", "PGPASSFILE", "PGSSL", "PGGSS", "PGKRBSRVNAME"),
    *("PGCHANNELBINDING", "PGREQUIREAUTH", "PGREQUIREPEER", "PGREQUIRESSL"),
)
_OURS = {
    "MATPLOTLIBRC": os.devnull,  # else a file of the working or home directory is read
    "MPLBACKEND": "agg",
    "NUMBA_DISABLE_JIT": "0",  # stated, as a .numba_config.yaml in the working directory could say 1
    "JAX_PLATFORMS": "cpu",
}
# Faults of a path or a disk, which the user can mend.
_PLACE_FAULTS = frozenset(
    {
        *(errno.EACCES, errno.EDQUOT, errno.EISDIR, errno.ELOOP, errno.ENAMETOOLONG, errno.ENOENT),
        *(errno.ENOSPC, errno.ENOTDIR, errno.EPERM, errno.EROFS),
    }
)


def own_configuration(environment: MutableMapping[str, str] = os.environ) -> None:
    """Replace what libraries read from the environment; call it first in a process, its children inherit it.

    Dask's part is in the worker: with an existing scheduler its TLS configuration is wanted.
    """
    for name in list(environment):
        if name.startswith(_READ_BY_LIBRARIES) and name not in _PLACES and not name.startswith(_PROOFS):
            del environment[name]
    environment.update(_OURS)
    # Some parents leave it ignored, and then nobody learns how a child has ended.
    if hasattr(signal, "SIGCHLD") and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)


def exit_code(run: Callable[[], object]) -> int:
    """Run a command to its exit code; our own errors and faults of a place are one sentence and exit code 2."""
    try:
        run()
    except (SafestartError, OSError) as error:
        refusal = place_fault(error) if isinstance(error, OSError) else error
        if refusal is None:
            raise
        sys.stderr.write(f"safestart: {legible(refusal.detail)}\n")
        return 2
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    return 0


def place_fault(error: OSError) -> SafestartError | None:
    """A missing, closed or full place in one sentence; None for errors that say nothing to the user."""
    if error.errno not in _PLACE_FAULTS or (error.filename is None and error.errno != errno.ENOENT):
        return None
    required = "a place that exists and accepts our files"
    received = error.strerror or str(error)
    if error.filename is not None:
        received = f"{os.fspath(error.filename)!s} ({received})"
    return InvalidInput(f"required {required}, received {received}", required=required, received=received)
