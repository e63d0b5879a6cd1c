"""Proofs, bundles, settings, inputs, query strings changed at random: ``python -m tests.fuzzing.timed --seconds 180``.

Each is taken or refused in words. Ends with 1 if one raised anything else, or took longer than a second (a proof: four,
as a missed burn about the Earth takes 1.3 s when it is whole). Whether a proof that is taken is true is another run's
question (``python -m tests.fuzzing``).
"""

from __future__ import annotations

import argparse
import atexit
import json
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any
from unittest.mock import patch

import safestart
from safestart.errors import InvalidInput, SafestartError
from safestart.proofs.strict import ProofRejected
from safestart.records.bundle import unpack
from safestart.runtime.settings import Settings, settings
from tests.contract.records.test_hostile_bundles import EVENT, JOB, RESULT, sealed
from tests.fuzzing.mutants import known_fields, mutants
from tests.fuzzing.urls import url

SLOW_S = 1.0
SLOW_PROOF_S = 4.0
WORDS: tuple[Any, ...] = (
    *(None, True, -1, 2**63, 1e308, 0.5, "", "\0", "\ud800", "a" * 1000, "../x", "٣", "1_0", "nan", "1e999"),
    *([], {}, [{}], "2026-01-01T00:00:00+00:00", "postgresql://a:b@c/d", "sqlite:///x", "[::1]:99999", "%00"),
)


def changed(value: Any, draw: random.Random) -> Any:
    """The value with some of its parts replaced, gone or doubled."""
    if draw.random() < 0.12:
        return draw.choice(WORDS)
    if isinstance(value, dict):
        kept = {name: changed(item, draw) for name, item in value.items() if draw.random() > 0.05}
        return kept | ({draw.choice(("x", "", "id")): draw.choice(WORDS)} if draw.random() < 0.05 else {})
    if isinstance(value, list):
        return [changed(item, draw) for item in value] * draw.choice((1, 1, 1, 2, 0))
    return value


def damaged(data: bytes, draw: random.Random) -> bytes:
    """Bytes with some of them replaced, gone or inserted."""
    found = bytearray(data)
    for _ in range(draw.randint(1, 6)):
        place = draw.randrange(len(found))
        found[place : place + draw.choice((0, 1, 1, 20))] = draw.randbytes(draw.choice((0, 1, 1, 20)))
    return bytes(found)


def bundle(draw: random.Random) -> Callable[[], object]:
    """A bundle, damaged or sealed around changed parts."""
    try:
        data = sealed(job=changed(JOB, draw), result=changed(RESULT, draw), events=changed([EVENT], draw))
    except (TypeError, KeyError, ValueError, UnicodeError):  # no bundle can be made of these
        data = sealed()
    data = damaged(data, draw) if draw.random() < 0.5 else data
    return lambda: unpack(data)


@cache
def _proofs() -> tuple[list[str], Path]:
    """A document of every kind, and a file for what is made of one."""
    from tests.fuzzing.documents import KINDS, original

    folder = tempfile.TemporaryDirectory()
    atexit.register(folder.cleanup)
    return [original(kind) for kind in KINDS], Path(folder.name) / "proof.json"


def proof(draw: random.Random) -> Callable[[], object]:
    """A file with a proof, damaged, with changed parts, or with one field that says something else."""
    documents, file = _proofs()
    text = draw.choice(documents)
    way = draw.randrange(3)
    if way == 0:
        data = damaged(text.encode(), draw)
    elif way == 1:
        data = json.dumps(changed(json.loads(text), draw)).encode()
    else:
        whole = json.loads(text)
        ((_, mutant),) = mutants(whole, known_fields(whole), draw, 1)
        data = json.dumps(mutant).encode()
    file.write_bytes(data)
    return lambda: safestart.verify(file)


def setting(draw: random.Random) -> Callable[[], object]:
    """Variables of the environment with any names and texts."""
    names = [name.upper() for name in (*Settings.model_fields, "config", "colour")]
    texts = [str(word).replace("\0", "?").encode(errors="replace").decode() for word in WORDS]
    variables = {f"SAFESTART_{draw.choice(names)}": draw.choice(texts) for _ in range(draw.randint(1, 4))}

    def ask() -> object:
        settings.cache_clear()
        with patch.dict("os.environ", variables):
            return settings()

    return ask


def query(draw: random.Random) -> Callable[[], object]:
    """Inputs of go-no-go, as parameters and bodies give them."""
    from safestart.processes.go_no_go.spec import SPEC

    start = {"omega_t_deg_s": 3.0, "a_max_m_s2": 0.1, "states": [{"x_m": 5, "y_m": 40}]}
    asked = changed({**start, "corridor": {}, "method": "certified", "attitude": {"axis": [0, 0, 1]}}, draw)
    return lambda: SPEC.parse(asked)


KINDS = {"proofs": proof, "bundles": bundle, "settings": setting, "queries": query, "urls": url}


def main() -> int:
    """Run each kind for its time; prints what happened."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "kinds", nargs="*", default=tuple(KINDS), help=f"of {', '.join(KINDS)}; all by default"
    )
    parser.add_argument("--seconds", type=float, default=180.0, help="for each kind")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    wrong = 0
    for kind in asked.kinds:
        KINDS[kind](random.Random(0))  # what it needs is loaded before its time begins
        draw, end, worst = random.Random(asked.seed), time.monotonic() + asked.seconds, 0.0
        outcomes: Counter[str] = Counter()
        while time.monotonic() < end:
            ask = KINDS[kind](draw)
            begun = time.process_time()
            try:
                ask()
                outcomes["taken"] += 1
            except ProofRejected:
                outcomes["rejected"] += 1
            except SafestartError as error:
                outcomes["refused" if isinstance(error, InvalidInput) else f"refused as {error.slug}"] += 1
            except Exception as error:
                outcomes[f"WRONG {type(error).__name__}: {str(error)[:150]}"] += 1
                wrong += 1
            took = time.process_time() - begun
            worst = max(worst, took)
            wrong += took > (SLOW_PROOF_S if kind == "proofs" else SLOW_S)
        sys.stdout.write(f"{kind}: longest {worst:.3f} s, {dict(outcomes)}\n")
        sys.stdout.flush()
    settings.cache_clear()
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
