"""Requests that offer another protocol, as every Java client's do: they are answered in HTTP/1.1, bodies and all."""

from __future__ import annotations

import json

import pytest

from tests.contract.server.raw_http import HOST, problem_in, said

OFFER = b"Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n"
OFFERS = {
    "HTTP/2": OFFER,
    "WebSocket": b"Connection: keep-alive, Upgrade\r\nUpgrade: websocket\r\n",
    "none": b"",
}
BODY = json.dumps({"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 3, "ny": 3}}).encode()
LAST = b"GET /healthz HTTP/1.1\r\n" + HOST + b"Connection: close\r\n\r\n"


def posted(offer: bytes, *, chunked: bool, body: bytes = BODY) -> bytes:
    head = b"POST /certificates HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\n" + offer
    if chunked:
        middle = len(body) // 2
        parts = b"".join(b"%x\r\n%s\r\n" % (len(part), part) for part in (body[:middle], body[middle:]))
        return head + b"Transfer-Encoding: chunked\r\n\r\n" + parts + b"0\r\n\r\n"
    return head + b"Content-Length: %d\r\n\r\n%s" % (len(body), body)


@pytest.mark.parametrize("piece", [1, 7, 100_000])
@pytest.mark.parametrize("chunked", [False, True])
@pytest.mark.parametrize("offer", OFFERS)
def test_the_body_is_read_and_the_next_requests_too(address, offer, chunked, piece):
    """Three posts in a row and what ends the connection, however the bytes are cut into packets."""
    asked = posted(OFFERS[offer], chunked=chunked) * 3 + LAST
    answer = said(address, *(asked[k : k + piece] for k in range(0, len(asked), piece)))
    assert answer.count(b"HTTP/1.1 200 ") == 4, answer[:300]
    assert answer.count(b'"safe_fraction"') == 3


def test_without_a_body(address):
    asked = b"GET /healthz HTTP/1.1\r\n" + HOST + OFFER + b"\r\n"
    assert said(address, asked * 5 + LAST).count(b"HTTP/1.1 200 ") == 6


@pytest.mark.parametrize("offer", OFFERS)
def test_what_follows_an_offer_is_bounded_and_checked(address, offer):
    """The same refusals as without an offer, and nothing behind the body is taken for a part of it."""
    twice = posted(OFFERS[offer], chunked=False).replace(
        b"Content-Type", b"Content-Length: 3\r\nContent-Type"
    )
    problem_in(said(address, twice), 400)
    large = b"POST /certificates HTTP/1.1\r\n" + HOST + OFFERS[offer] + b"Content-Type: application/json\r\n"
    large += b"Content-Length: 99999999\r\n\r\n"
    assert said(address, large + LAST).startswith(b"HTTP/1.1 413 ")
    answer = said(address, posted(OFFERS[offer], chunked=False, body=b"{}") + LAST)
    assert answer.count(b"HTTP/1.1 422 ") == 1
    assert answer.count(b"HTTP/1.1 200 ") == 1
