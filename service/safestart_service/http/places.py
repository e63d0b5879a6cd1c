"""A fixed number of places, to take and give back; one name may hold half of them."""

from __future__ import annotations


class Places:
    """``most`` places. One name may hold half of them, so that the rest stays for others; None has no such limit."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.share = max(1, most // 2)
        self.taken = 0
        self._by: dict[str, int] = {}

    def take(self, name: str | None) -> bool:
        """Take a place; False when none is left for this name."""
        if self.taken >= self.most:
            return False
        if name is not None:
            own = self._by.get(name, 0)
            if own >= self.share:
                return False
            self._by[name] = own + 1
        self.taken += 1
        return True

    def leave(self, name: str | None) -> None:
        """Give back a place taken under this name."""
        self.taken -= 1
        if name is not None:
            own = self._by.pop(name) - 1
            if own:
                self._by[name] = own
