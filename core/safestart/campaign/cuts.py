"""Cut a campaign into shards, by its cases alone and not by the number of workers. Light to import."""

from __future__ import annotations


def runs(total: int, most: int) -> list[tuple[int, int]]:
    """``(first, count)`` of runs of at most ``most`` cases, ``total`` in all."""
    return [(first, min(most, total - first)) for first in range(0, total, most)]


def packed(groups: int, cells: int, cases: int, most: int) -> list[list[list[int]]]:
    """Shards of about ``most`` cases of a design of ``groups`` x ``cells``, each cell with ``cases`` cases.

    A shard is a list of pieces ``[cell, first, count]``, cells numbered over all groups, ``first`` counted within the
    cell. A group is cut only where it has more cases than a shard holds.
    """
    shards: list[list[list[int]]] = []
    shard: list[list[int]] = []
    room = most
    for group in range(groups):
        if cells * cases > room < most:
            shards.append(shard)
            shard, room = [], most
        for cell in range(group * cells, (group + 1) * cells):
            for first, count in runs(cases, most):
                if count > room:
                    shards.append(shard)
                    shard, room = [], most
                shard.append([cell, first, count])
                room -= count
    shards.append(shard)
    return shards
