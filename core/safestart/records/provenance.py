"""The origin of a result: package versions, Python, source, machine. Light to import."""

from __future__ import annotations

import os
import platform
import sys
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

PACKAGES = (
    "safestart",
    "safestart-service",
    "safestart-worker",
    "numpy",
    "scipy",
    "numba",
    "llvmlite",
    "jax",
    "jaxlib",
    "hj-reachability",
    "highspy",
    "clarabel",
    "python-flint",
    "matplotlib",
    "pillow",
    "pyarrow",
    "distributed",
    "pydantic",
    "sqlalchemy",
)


def versions() -> dict[str, Any]:
    """Versions of the packages that are installed, of Python and the source, and the machine."""
    return {**_static(), "packages": dict(_packages())}


@cache
def _static() -> dict[str, Any]:
    return {
        "python": platform.python_version(),
        "git_revision": _git_revision(Path(__file__).resolve()),
        "source_sha256": source(),
        "machine": {
            "cpu": _cpu_model(),
            "cores": os.cpu_count(),
            "os": f"{platform.system()} {platform.release()}",
            "architecture": platform.machine(),
        },
    }


@cache
def _packages() -> tuple[tuple[str, str], ...]:
    found = []
    for name in PACKAGES:
        try:
            found.append((name, version(name)))
        except PackageNotFoundError:
            continue
    return tuple(found)


@cache
def source() -> str:
    """SHA-256 of the source of this package, taken at the first call."""
    return source_digest(Path(__file__).resolve().parents[1])


def source_digest(package: Path) -> str:
    """SHA-256 over the names and bytes of a package's modules.

    A git revision does not show later changes, and an installed package has no revision.
    """
    digest = sha256()
    for file in sorted(package.rglob("*.py"), key=lambda file: file.relative_to(package).as_posix()):
        content = sha256(file.read_bytes()).hexdigest()
        digest.update(f"{file.relative_to(package).as_posix()} {content}\n".encode())
    return digest.hexdigest()


def _cpu_model() -> str:
    if sys.platform == "linux":
        try:
            for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
        except OSError:
            pass  # a sandbox without /proc: use the generic answer below
    return platform.processor() or platform.machine()


def _git_revision(source: Path) -> str | None:
    """Revision of the checkout around ``source``, read from its files (no git needed); None outside one."""
    for folder in source.parents:
        marker = folder / ".git"
        try:
            if marker.is_file():  # a linked work tree: the file names its git directory
                marker = (folder / marker.read_text().partition("gitdir:")[2].strip()).resolve()
            if marker.is_dir():
                return _head(marker)
        except OSError:
            return None
    return None


def _head(git: Path) -> str | None:
    head = (git / "HEAD").read_text().strip()
    if not head.startswith("ref:"):
        return head or None
    ref = head.partition(":")[2].strip()
    common = git / "commondir"
    shared = (git / common.read_text().strip()).resolve() if common.is_file() else git
    for base in (git, shared):
        if (base / ref).is_file():
            return (base / ref).read_text().strip()
    packed = shared / "packed-refs"
    lines = packed.read_text().splitlines() if packed.is_file() else []
    for line in lines:
        revision, _, name = line.partition(" ")
        if name == ref:
            return revision
    return None
