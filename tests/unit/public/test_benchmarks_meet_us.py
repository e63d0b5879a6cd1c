"""Benchmarks and tools are run by hand: every name that they take from us exists, in functions, too."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
OURS = ("safestart", "safestart_service", "safestart_worker", "benchmarks")
FILES = sorted(
    str(path.relative_to(ROOT))
    for folder in ("benchmarks", "tools")
    for path in (ROOT / folder).rglob("*.py")
)


def missing(source: str) -> list[str]:
    """Names that a source takes from one of our modules and that are not there."""
    out = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] in OURS:
            try:
                module = importlib.import_module(node.module)
                for name in node.names:
                    if not hasattr(module, name.name):
                        importlib.import_module(f"{node.module}.{name.name}")
            except ImportError as error:
                out.append(f"line {node.lineno}: {error}")
    return out


def test_what_is_not_there_is_seen():
    assert missing("def late():\n    from safestart.runtime import no_such_module") == [
        "line 2: No module named 'safestart.runtime.no_such_module'"
    ]


@pytest.mark.parametrize("file", FILES)
def test_every_name_exists(file: str):
    assert missing((ROOT / file).read_text()) == []
