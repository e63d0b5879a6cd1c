"""The line in front of the helper processes."""

from __future__ import annotations

import asyncio

from safestart_service.computing.budget import Budget, Share
from safestart_service.computing.line import Line


async def _served(slots: int, asked: list[tuple[str | None, float]]) -> list[int]:
    """In which order callers (name, cost) get their turn, who leave as soon as all others have come."""
    line, order, everybody = Line(slots), [], asyncio.Event()

    async def call(number: int, name: str | None, cost: float) -> None:
        async with line.slot(name, cost):
            order.append(number)
            await everybody.wait()

    tasks = []
    for number, (name, cost) in enumerate(asked):
        tasks.append(asyncio.create_task(call(number, name, cost)))
        await asyncio.sleep(0)
    everybody.set()
    await asyncio.gather(*tasks)
    assert (line._held.total(), line._long, line._waiting) == (0, 0, [])
    return order


def test_names_take_turns() -> None:
    asked = [("a", 9.0), ("a", 9.0), ("a", 9.0), ("b", 9.0), (None, 9.0)]
    order = asyncio.run(_served(3, asked))
    assert order.index(3) < order.index(2), "b has no slot, a has two"


def test_one_slot_is_for_quick_answers() -> None:
    assert asyncio.run(_served(2, [("a", 9.0), ("b", 9.0), ("c", 0.1)]))[:2] == [0, 2]
    assert asyncio.run(_served(1, [("a", 9.0), ("b", 0.1)])) == [0, 1]


def test_who_leaves_the_line_gives_the_place_back() -> None:
    async def run() -> None:
        line = Line(1)
        async with line.slot("a", 9.0):
            waiting = asyncio.create_task(line.slot("b", 9.0).__aenter__())
            await asyncio.sleep(0)
            waiting.cancel()
            await asyncio.gather(waiting, return_exceptions=True)
        async with line.slot("c", 9.0):
            pass
        assert line._held.total() == 0

    asyncio.run(run())


def test_a_budget_is_shared() -> None:
    budget = Budget(10)
    one, two = Share(budget), Share(budget)
    assert [one.grow(6), two.grow(5), two.grow(4)] == [True, False, True]
    one.end()
    assert two.grow(6)
    two.end()
    two.end()
    assert budget.taken == 0


def test_who_leaves_in_the_turn_in_which_a_slot_is_free_harms_nobody() -> None:
    """Whoever gave the slot back got an error instead of the answer, and the slot was lost."""

    async def run() -> None:
        line, answered = Line(1), asyncio.Event()

        async def holds() -> str:
            async with line.slot("a", 9.0):
                await answered.wait()
            return "answer"

        async def waits(name: str) -> str:
            async with line.slot(name, 9.0):
                return name

        tasks = [asyncio.create_task(call) for call in (holds(), waits("b"), waits("c"), waits("d"))]
        await asyncio.sleep(0)
        answered.set()
        tasks[1].cancel()
        tasks[2].cancel()
        found = await asyncio.gather(*tasks, return_exceptions=True)
        assert (found[0], found[3]) == ("answer", "d")
        assert all(isinstance(one, asyncio.CancelledError) for one in found[1:3])
        assert (line._held.total(), line._long, line._waiting) == (0, 0, [])

    asyncio.run(run())
