"""Memory of request bodies in flight: one budget for all of them, a growing share for each."""

from __future__ import annotations


class Budget:
    """At most ``most`` bytes at once."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.taken = 0


class Share:
    """What one request has taken of a budget."""

    def __init__(self, budget: Budget) -> None:
        self._budget = budget
        self._own = 0

    def grow(self, size: int) -> bool:
        """Take ``size`` bytes more; False when they are not left."""
        if self._budget.taken + size > self._budget.most:
            return False
        self._budget.taken += size
        self._own += size
        return True

    def end(self) -> None:
        """Give all of it back."""
        self._budget.taken -= self._own
        self._own = 0
