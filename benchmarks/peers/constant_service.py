"""Peer of the go-no-go call: a bare FastAPI application whose endpoint returns a constant document.

``CONSTANT_DOCUMENT`` (JSON) is the document, so that both servers send bodies of the same size. ``/constant`` returns
it the way FastAPI's tutorial does; ``/encoded`` returns bytes encoded at start, the least FastAPI can do.
"""

from __future__ import annotations

import json
import os
from typing import Any

from fastapi import FastAPI
from fastapi.responses import Response

DOCUMENT: dict[str, Any] = json.loads(os.environ.get("CONSTANT_DOCUMENT", "{}"))
ENCODED = json.dumps(DOCUMENT, separators=(",", ":")).encode()

app = FastAPI()


@app.get("/constant")
async def constant() -> dict[str, Any]:
    """The document, encoded by FastAPI."""
    return DOCUMENT


@app.get("/encoded")
async def encoded() -> Response:
    """The document as bytes."""
    return Response(ENCODED, media_type="application/json")
