"""Token buckets: how many requests one name may send."""

from __future__ import annotations

from time import monotonic

BURST_S = 10.0
MOST_NAMES = 10_000


class Buckets:
    """One bucket per name: it holds ``burst`` tokens and fills at ``rate`` per second.

    Beyond :data:`MOST_NAMES` it forgets the oldest names, so memory stays bounded.
    """

    def __init__(self, rate: float, burst: float | None = None) -> None:
        self.rate = rate
        self.burst = max(1.0, rate * BURST_S if burst is None else burst)
        self._held: dict[str, list[float]] = {}

    def take(self, name: str) -> bool:
        """Take one token; False when there is none."""
        now = monotonic()
        bucket = self._held.get(name)
        if bucket is None:
            if len(self._held) >= MOST_NAMES:
                del self._held[next(iter(self._held))]
            self._held[name] = [self.burst - 1.0, now]
            return True
        tokens = bucket[0] + (now - bucket[1]) * self.rate
        bucket[1] = now
        if tokens > self.burst:
            tokens = self.burst
        enough = tokens >= 1.0
        bucket[0] = tokens - 1.0 if enough else tokens
        return enough
