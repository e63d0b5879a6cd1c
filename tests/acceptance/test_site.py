"""The documentation builds strictly: no broken link, no page left out, every equation drawn, nothing fetched."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
_FETCHED = re.compile(r"<(?:script|img|link|iframe)\b[^>]*\b(?:src|href)=\"?(?:https?:)?//[^\"> ]+")
_ALLOWED = re.compile(r"rel=\"?canonical")


@pytest.mark.slow
def test_the_site_builds_strictly(tmp_path):
    command = [
        sys.executable,
        "-m",
        "mkdocs",
        "build",
        "--strict",
        "--quiet",
        "--site-dir",
        str(tmp_path / "site"),
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    pages = {
        page.relative_to(tmp_path / "site").as_posix(): page.read_text() for page in tmp_path.rglob("*.html")
    }
    assert {"index.html", "tutorial.html", "reference.html", "theory/exact.html"} <= pages.keys()
    for name, text in pages.items():
        assert not [tag for tag in _FETCHED.findall(text) if not _ALLOWED.search(tag)], name
        assert 'class="arithmatex"' not in text, name
    assert pages["theory/exact.html"].count("<math") > 20
    assert "body-frame position in metres" in pages["reference.html"]
