"""Memory of bodies in flight: one budget for all of a kind, a growing share for each request."""

from __future__ import annotations

from collections import Counter

from safestart.runtime.children.forks import Forkable


class Budget(Forkable):
    """At most ``most`` bytes at once, half of them for one name; whoever has nothing gets any size where it is alone.

    None is no name, and has no such limit.
    """

    def __init__(self, most: int) -> None:
        self.most = most
        self.forked()
        self.tell_of_forks()

    def forked(self) -> None:
        """Nothing is in flight here."""
        self.taken = 0
        self._by: Counter[str] = Counter()

    def take(self, name: str | None, size: int) -> bool:
        """Take ``size`` bytes; False when they are not left for this name."""
        if self.taken and self.taken + size > self.most:
            return False
        if name is not None:
            own = self._by[name]
            if own and own + size > self.most // 2:
                return False
            self._by[name] += size
        self.taken += size
        return True

    def give_back(self, name: str | None, size: int) -> None:
        """Give back what was taken under this name."""
        self.taken -= size
        if name is not None:
            self._by[name] -= size
            if self._by[name] <= 0:
                del self._by[name]


class Share:
    """What one request has taken of a budget, under a name."""

    def __init__(self, budget: Budget, name: str | None = None) -> None:
        self._budget, self._name = budget, name
        self._own = 0

    def grow(self, size: int) -> bool:
        """Take ``size`` bytes more; False when they are not left."""
        if not self._budget.take(self._name, size):
            return False
        self._own += size
        return True

    def end(self) -> None:
        """Give all of it back."""
        if self._own:
            self._budget.give_back(self._name, self._own)
            self._own = 0
