"""Mutants of a JSON document: one field added, dropped, retyped, swapped, moved, repeated or turned into another value.

Every field of the document has its turn with every operation, so that a long run leaves none out.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Iterator
from random import Random
from typing import Any

Path = tuple[str | int, ...]
OPERATIONS = ("add", "drop", "retype", "swap", "move", "repeat", "value", "value", "value")
_JUNK: tuple[Any, ...] = (
    None,
    True,
    False,
    0,
    1,
    -1,
    0.5,
    "",
    "GO",
    [],
    {},
    [0.0, 0.0],
    10**30,
    "\ud800",
    -0.0,
)
_FACTORS = (0.0, -1.0, 2.0, 0.5, 10.0, 1.1, 0.9, 1.0 + 1e-3, 1.0 - 1e-3, 1.0 + 1e-9, 1.0 - 1e-9, 1e6, 1e300)


def paths(value: Any, path: Path = ()) -> Iterator[Path]:
    """Every place inside a document."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inside in items:
        yield (*path, key)
        yield from paths(inside, (*path, key))


def at(document: Any, path: Path) -> Any:
    for key in path:
        document = document[key]
    return document


def known_fields(*documents: Any) -> dict[str, list[Any]]:
    """Fields by name with their values in these documents, the material for added fields."""
    out: dict[str, list[Any]] = {}
    for document in documents:
        for path in paths(document):
            if isinstance(path[-1], str):
                out.setdefault(path[-1], []).append(at(document, path))
    return out


def mutants(
    document: Any, fields: dict[str, list[Any]], rng: Random, number: int
) -> Iterator[tuple[str, Any]]:
    """``number`` mutants with what was done to them; most have one change, some two or three."""
    places = list(paths(document))
    turns = [(operation, path) for path in places for operation in OPERATIONS]
    rng.shuffle(turns)
    # Much quicker than a deep copy, which is what most of a long run was.
    packed = pickle.dumps(document)
    for k in range(number):
        made = pickle.loads(packed)
        operation, path = turns[k % len(turns)]
        done = [f"{operation} {'.'.join(map(str, path))}"]
        _apply(operation, made, path, fields, rng, places)
        while rng.random() < 0.2:
            left = list(paths(made))
            if not left:
                break
            operation, path = rng.choice(OPERATIONS), rng.choice(left)
            done.append(f"{operation} {'.'.join(map(str, path))}")
            _apply(operation, made, path, fields, rng, left)
        yield ", ".join(done), made


def _apply(
    operation: str, made: Any, path: Path, fields: dict[str, list[Any]], rng: Random, everywhere: list[Path]
) -> None:
    """``everywhere``: the places in ``made`` as it is; walking it takes longer than all else."""
    inside, key = at(made, path[:-1]), path[-1]
    if operation == "add":
        _add(at(made, path), fields, rng) if isinstance(at(made, path), dict) else _add(inside, fields, rng)
    elif operation == "drop":
        del inside[key]
    elif operation == "retype":
        inside[key] = _retyped(inside[key], rng)
    elif operation == "swap":
        other = rng.choice(everywhere)
        # What holds the other cannot change places with it.
        if other[: len(path)] != path and path[: len(other)] != other:
            there, last = at(made, other[:-1]), other[-1]
            inside[key], there[last] = there[last], inside[key]
    elif operation == "move":
        places = [
            p for p in [(), *everywhere] if isinstance(at(made, p), dict | list) and p[: len(path)] != path
        ]
        there = at(made, rng.choice(places))
        value = inside.pop(key)
        if isinstance(there, dict):
            there[str(key)] = value
        else:
            there.insert(rng.randint(0, len(there)), value)
    elif operation == "repeat" and isinstance(inside, list):
        inside.insert(rng.randint(0, len(inside)), copy.deepcopy(inside[int(key)]))
    elif operation in ("repeat", "value"):
        inside[key] = _other(inside[key], fields.get(str(key), []), rng)


def _add(inside: Any, fields: dict[str, list[Any]], rng: Random) -> None:
    name = rng.choice(sorted(fields))
    value = copy.deepcopy(rng.choice([*fields[name], rng.choice(_JUNK)]))
    if isinstance(inside, dict):
        inside[rng.choice((name, name, "note", ""))] = value
    else:
        inside.insert(rng.randint(0, len(inside)), value)


def _retyped(value: Any, rng: Random) -> Any:
    out: list[Any] = [str(value), [value], {"value": value}, None, bool(value)]
    if isinstance(value, int | float):
        out += [int(value), float(value), int(value) != value, repr(value)]
    if isinstance(value, list):
        out += [dict.fromkeys(map(str, range(len(value))), 0.0), *value[:1], tuple(value)]
    if isinstance(value, dict):
        out += [list(value.values()), list(value)]
    return rng.choice(out)


def _other(value: Any, donors: list[Any], rng: Random) -> Any:
    """Another value of the same kind."""
    out: list[Any] = [rng.choice(_JUNK), *(copy.deepcopy(rng.choice(donors)) for _ in range(2) if donors)]
    if isinstance(value, bool):
        out.append(not value)
    elif isinstance(value, int | float):
        changed = value * rng.choice(_FACTORS)
        nudged = (
            math.nextafter(value, math.inf),
            value + rng.uniform(-1.0, 1.0),
            value * rng.uniform(0.5, 1.5),
        )
        out += [changed, *nudged, *nudged, *nudged, *nudged, value + 1, value - 1]
        # A number that is whole may stay whole, and then mean something.
        out += [int(e) for e in (value + 1, value - 1, 2 * value)] if isinstance(value, int) else []
    elif isinstance(value, str):
        out += [value.lower(), value.upper(), value + " ", *[v for v in donors if isinstance(v, str)]]
    elif isinstance(value, list):
        # Copies: a place that two paths lead to could later be moved into itself.
        out += [value[::-1], value[1:], value[:-1], value + copy.deepcopy(value)]
    return rng.choice(out)
