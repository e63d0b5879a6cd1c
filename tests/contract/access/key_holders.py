"""The holders of keys in the tests of access."""

from __future__ import annotations

from safestart.runtime.access import Caller, Role
from tests.contract.api.service_client import POINT

BY = Caller(None, "test", Role.ADMIN)

ASK = {**POINT, "x_m": 5, "y_m": 40}


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}
