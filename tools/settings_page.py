"""The settings page of docs/: ``settings_page.py write`` or ``check`` (fails on drift)."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from safestart.runtime.settings import Settings

PAGE = Path(__file__).resolve().parent.parent / "docs" / "settings.md"


def page() -> str:
    """One row per setting."""
    lines = [
        "# Settings",
        "",
        "Each setting is read from the environment, else from the TOML file that `SAFESTART_CONFIG` names (default: "
        "`safestart.toml` in the user's configuration directory). The file uses the names below in lower case, "
        "without `SAFESTART_` and without sections; variables are in capital letters. Numbers in variables are "
        "written as on the command line: in the digits 0 to 9, without `_`, plus sign and spaces. An unknown variable "
        "`SAFESTART_...` ends every command with code 2. An unknown name in the file, a named file that is missing "
        "and an invalid value end every command that reads settings with code 2. The message says what was required. "
        "`go-no-go`, `verify` and other commands that need neither database nor service read no settings.",
        "",
        "| variable | default | meaning |",
        "|---|---|---|",
    ]
    for name, field in Settings.model_fields.items():
        default = "number of cores" if field.default_factory else f"`{field.default!r}`"
        lines.append(f"| `SAFESTART_{name.upper()}` | {default} | {field.description} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the page, or compare it."""
    if sys.argv[1] == "write":
        PAGE.write_text(page())
        return 0
    if PAGE.read_text() != page():
        print(f"{os.path.relpath(PAGE)} is stale: run tools/settings_page.py write")
        return 1
    print("settings page agrees with the code")
    return 0


if __name__ == "__main__":
    sys.exit(main())
