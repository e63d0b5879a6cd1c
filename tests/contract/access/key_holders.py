"""The holders of keys in the tests of access."""

from __future__ import annotations

import re

from safestart.runtime.access import Caller, Role
from tests.contract.api.service_client import POINT

KEY_FORM = re.compile(r"sst_([0-9a-f]{12})_[A-Za-z0-9_-]{43}")
"""The public id, then 256 random bits."""

BY = Caller(None, "test", Role.ADMIN)

ASK = {**POINT, "x_m": 5, "y_m": 40}


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}
