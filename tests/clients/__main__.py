"""Generate or install clients of others, and submit and read a benchmark with each.

``python -m tests.clients [NAME ...]``, by hand: it needs node, npm, a JDK with Debian's
``libgeronimo-annotation-1.3-spec-java``, and the package registries. Each client gets a virtual environment or an npm
folder of its own, which are deleted. It prints a table for docs/clients.md.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import venv
from collections.abc import Callable
from pathlib import Path

import httpx

from safestart_service.documents.openapi30 import older
from tests.acceptance.running import Running

PROGRAMS = Path(__file__).parent / "programs"
INPUTS = {
    "omega_t_deg_s": 3,
    "a_max_m_s2": 0.1,
    "grid": {"nx": 11, "ny": 11},
    "engines": ["analytical", "exact"],
}
LIMIT_S = 600


class Workshop:
    """A folder with both descriptions, for one client of a service at ``url``."""

    def __init__(self, folder: Path, url: str) -> None:
        self.folder, self.url = folder, url
        description = httpx.get(f"{url}/openapi.json").json()
        (folder / "openapi-3.1.json").write_text(json.dumps(description))
        (folder / "openapi-3.0.json").write_text(json.dumps(older(description)))

    def run(self, *command: str) -> str:
        """Standard output of a command in the folder; raises ``RuntimeError`` with what it said."""
        ended = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=LIMIT_S)
        if ended.returncode:
            raise RuntimeError(f"{command[0]}: {(ended.stdout + ended.stderr)[-600:]}")
        return ended.stdout

    def pip(self, *packages: str) -> None:
        venv.create(self.folder / "venv", with_pip=True)
        self.run("venv/bin/pip", "install", "--quiet", *packages)

    def python(self, program: str) -> str:
        shutil.copy(PROGRAMS / program, self.folder / f"run_{program}")
        return self.run("venv/bin/python", f"run_{program}", self.url, json.dumps(INPUTS))

    def npm(self, *packages: str) -> None:
        (self.folder / "package.json").write_text('{"type": "module"}')
        self.run("npm", "install", "--silent", *packages)

    def node(self, program: str) -> str:
        return self.run("node", program, self.url, json.dumps(INPUTS))


def owslib(shop: Workshop) -> str:
    shop.pip("owslib")
    return shop.python("owslib_client.py")


def cuiman(shop: Workshop) -> str:
    shop.pip(
        "cuiman==0.1.1", "gavicore==0.1.1"
    )  # later ones need a later Python, and cuiman does not bound gavicore
    return shop.python("cuiman_client.py")


def terradue(shop: Workshop) -> str:
    shop.pip("ogc-api-processes-client")
    return shop.python("terradue_client.py")


def openapi_python_client(shop: Workshop) -> str:
    shop.pip("openapi-python-client")
    made = ["--path", "openapi-3.1.json", "--meta", "none", "--output-path", "safestart_client"]
    said = shop.run("venv/bin/openapi-python-client", "generate", *made)
    assert "WARNING" not in said, said
    return shop.python("python_client.py")


def openapi_generator(shop: Workshop) -> str:
    shop.pip("openapi-generator-cli")
    made = ["-i", "openapi-3.0.json", "-g", "python", "-o", "made"]
    shop.run("venv/bin/openapi-generator-cli", "generate", *made)
    shop.run("venv/bin/pip", "install", "--quiet", "./made")
    return shop.python("generator_client.py")


def openapi_generator_java(shop: Workshop) -> str:
    """It needs the JDK's HTTP client, Jackson, which the generator's own jar holds, and Debian's annotations."""
    shop.pip("openapi-generator-cli")
    options = ["--library", "native", "--additional-properties", "openApiNullable=false"]
    made = ["-i", "openapi-3.0.json", "-g", "java", "-o", "java", *options]
    shop.run("venv/bin/openapi-generator-cli", "generate", *made)
    jars = [str(found) for found in (shop.folder / "venv").rglob("openapi-generator*.jar")]
    files = shop.run("dpkg", "-L", "libgeronimo-annotation-1.3-spec-java").split()
    jars += [name for name in files if name.startswith("/usr/share/java/") and name.endswith(".jar")]
    sources = [str(found) for found in (shop.folder / "java" / "src" / "main").rglob("*.java")]
    path = ":".join(["classes", *jars])
    quoted = (f'"{name}"' for name in [*sources, PROGRAMS / "Submit.java"])
    (shop.folder / "sources").write_text("\n".join(quoted))
    shop.run("javac", "-nowarn", "-cp", path, "-d", "classes", "@sources")
    said = shop.run("java", "-cp", path, "Submit", shop.url, json.dumps(INPUTS))
    return f"{len(sources)} files compiled; {said.strip()}"


def openapi_typescript(shop: Workshop) -> str:
    shop.npm("openapi-typescript", "openapi-fetch", "typescript@5", "@types/node")
    shop.run("npx", "openapi-typescript", "openapi-3.1.json", "-o", "safestart.ts")
    shutil.copy(PROGRAMS / "typed.ts", shop.folder)
    strict = ["--strict", "--module", "nodenext", "--target", "es2022", "--outDir", "out"]
    shop.run("npx", "tsc", *strict, "typed.ts")
    return shop.node("out/typed.js")


def swagger_client(shop: Workshop) -> str:
    shop.npm("swagger-client")
    shutil.copy(PROGRAMS / "swagger_client.mjs", shop.folder)
    return shop.node("swagger_client.mjs")


def linted(shop: Workshop) -> str:
    """Spectral and Redocly; raises unless both find no error in either description."""
    shop.npm("@stoplight/spectral-cli", "@redocly/cli")
    (shop.folder / "rules.yaml").write_text('extends: ["spectral:oas"]\n')
    found = []
    for version in ("3.1", "3.0"):
        file = f"openapi-{version}.json"
        spectral = (
            shop.run("npx", "spectral", "lint", file, "--ruleset", "rules.yaml").strip().splitlines()[-1]
        )
        redocly = json.loads(shop.run("npx", "redocly", "lint", file, "--format=json"))["totals"]
        counts = f"{redocly['errors']} errors, {redocly['warnings']} warnings"
        found.append(f"{version}: spectral {spectral.strip('✖ ')}, redocly {counts}")
    return "; ".join(found)


CLIENTS: dict[str, Callable[[Workshop], str]] = {
    "OWSLib": owslib,
    "cuiman": cuiman,
    "ogc-api-processes-client": terradue,
    "openapi-python-client": openapi_python_client,
    "openapi-generator (Python)": openapi_generator,
    "openapi-generator (Java)": openapi_generator_java,
    "openapi-typescript": openapi_typescript,
    "swagger-client": swagger_client,
    "linters": linted,
}


def main(names: list[str]) -> int:
    """Each named client, or all; 1 if one failed."""
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        running = Running(Path(folder))
        try:
            for name in names or CLIENTS:
                place = Path(folder) / name
                place.mkdir()
                try:
                    said = CLIENTS[name](Workshop(place, running.url)).strip()
                except (RuntimeError, AssertionError, subprocess.TimeoutExpired) as error:
                    failed, said = True, f"FAILED: {error}"
                print(f"| {name} | {said} |", flush=True)
        finally:
            running.stop()
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
