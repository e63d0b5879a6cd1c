"""Progress of one job, as its worker measures it: percent, message, estimated seconds left."""

from __future__ import annotations

from dataclasses import dataclass, field

# Weight of a new estimate of the time left, against the previous estimate minus the time since.
_SMOOTHING = 0.3
# A running job never shows 100, which means successful.
_MOST = 99.9


@dataclass(slots=True)
class Track:
    """Turns units done into percent and time left; percent never falls while the same task process runs.

    ``found`` is the share done before this run: finished shards of an earlier worker.
    """

    percent: float = 0.0
    message: str = ""
    eta_s: float | None = None
    found: float = 0.0
    _elapsed: float = 0.0
    _fresh: bool = field(default=False)

    def restart(self) -> None:
        """The task starts from nothing in another process."""
        self.percent, self.message, self.eta_s, self._elapsed, self._fresh = 0.0, "", None, 0.0, False

    def update(self, done: float, total: float, elapsed_s: float, message: str) -> None:
        """Handle one report.

        The time left is the time so far scaled by the work left, smoothed with the last estimate minus the time
        since.
        """
        share = min(max(done / total, 0.0), 1.0) if total > 0 else 0.0
        percent = max(self.percent, min(100.0 * share, _MOST))
        if share > self.found:
            estimate = elapsed_s * (1.0 - share) / (share - self.found)
            if self.eta_s is not None:
                expected = max(self.eta_s - (elapsed_s - self._elapsed), 0.0)
                estimate = expected + _SMOOTHING * (estimate - expected)
            self.eta_s = estimate
        self._fresh = self._fresh or percent > self.percent or message != self.message
        self.percent, self.message, self._elapsed = percent, message, elapsed_s

    def take(self) -> tuple[float, str, float | None] | None:
        """Percent, message and time left if they changed since the last call, else None."""
        if not self._fresh:
            return None
        self._fresh = False
        eta = None if self.eta_s is None else round(self.eta_s, 2)
        return round(self.percent, 2), self.message, eta
