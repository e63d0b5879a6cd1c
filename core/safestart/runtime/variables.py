"""The names of our variables, beside the settings that have them: every command refuses others, most read no setting.

The settings themselves are ten times as much to load as a verdict takes.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from safestart.errors import InvalidInput

PREFIX = "SAFESTART_"
NAMES = (
    *(
        "database_url",
        "database_password_file",
        "host",
        "port",
        "scheduler",
        "processes",
        "warm_up",
        "lease_s",
    ),
    *("poll_s", "job_timeout_s", "max_attempts", "silence_s", "keep_days", "log_format", "max_body_bytes"),
    *("max_states", "max_queued", "allowed_hosts", "root_path", "trusted_proxies", "rate_per_s"),
    *("submit_rate_per_s", "request_timeout_s", "answer_timeout_s", "answer_processes", "max_bodies_bytes"),
    *("max_answers_bytes", "max_connections", "max_followers"),
)
"""The fields of :class:`safestart.runtime.settings.Settings` (a test compares)."""
_OTHERS = ("SAFESTART_TEST_POSTGRESQL", "SAFESTART_CHROMIUM", "SAFESTART_SCREENSHOTS")
"""Variables of the test suite; the processes it starts inherit them."""


def require_known(variables: Iterable[str]) -> None:
    """Raise ``InvalidInput`` for a ``SAFESTART_`` variable that names no setting: a misspelt one would be ignored.

    So would one of ``SAFESTART_PORT`` and ``safestart_port``: names are as they are documented, in capital letters.
    """
    known = [PREFIX + name.upper() for name in (*NAMES, "config")]
    for name in sorted(variables):
        if name.upper().startswith(PREFIX) and name not in (*known, *_OTHERS):
            near = get_close_matches(name.upper(), known, n=1)
            like = f", such as {near[0]}" if near else ""
            required = f"the name of a setting{like} (docs/settings.md)"
            # Its value may be a password.
            raise InvalidInput(f"{name}: required {required}", field=name, required=required, received=name)
