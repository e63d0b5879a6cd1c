"""Write or check ``openapi/openapi.json``: ``python tools/openapi.py write|check``."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

FILE = Path(__file__).resolve().parents[1] / "openapi" / "openapi.json"


def render() -> str:
    """The description as stable text: sorted keys, one line per value."""
    from safestart.runtime.settings import Settings
    from safestart_service.app import create_app

    with tempfile.TemporaryDirectory() as folder:
        app = create_app(Settings(database_url=f"sqlite:///{Path(folder) / 'unused.sqlite3'}"))
        return json.dumps(app.openapi(), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def main(arguments: list[str]) -> int:
    """Write the file, or return 1 when it differs from the code."""
    if arguments == ["write"]:
        FILE.parent.mkdir(exist_ok=True)
        FILE.write_text(render(), encoding="utf-8")
        return 0
    if arguments == ["check"]:
        if FILE.exists() and FILE.read_text(encoding="utf-8") == render():
            return 0
        print(
            f"{FILE.name} is not what the code says; `python tools/openapi.py write` writes it",
            file=sys.stderr,
        )
        return 1
    print("required: write or check", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
