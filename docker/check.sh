#!/usr/bin/env bash
# Checks that need no Docker engine: the install steps of both images in clean environments, and the compose file where a
# client is there. By hand: it installs the engines anew.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for part in service worker; do
    step=$(grep -m1 -oE 'uv sync .*' "docker/$part.Dockerfile")
    mkdir -p "$work/$part"
    cp -r pyproject.toml core service worker "$work/$part/"
    (cd "$work/$part" && UV_PROJECT_ENVIRONMENT="$work/$part/env" bash -c "${step/uv/python3 -m uv}")
done

service=$work/service/env/bin
"$service/safestart" serve --help >/dev/null
if "$service/python" -c "import jax" 2>/dev/null || "$service/python" -c "import numba" 2>/dev/null \
    || "$service/python" -c "import distributed" 2>/dev/null; then
    echo "the service image would hold an engine"
    exit 1
fi
"$service/python" -c "import psycopg, safestart_service.app"
worker=$work/worker/env/bin
"$worker/safestart" worker --help >/dev/null
"$worker/dask" scheduler --help >/dev/null
"$worker/python" -c "import jax, numba, psycopg, safestart_worker.loop"

if docker compose version >/dev/null 2>&1; then compose="docker compose"
elif command -v docker-compose >/dev/null; then compose=docker-compose
else echo "check: no compose client here, the compose file is only parsed by the tests"; fi
[ -z "${compose:-}" ] || SAFESTART_DB_PASSWORD=x $compose -f docker/compose.yaml config --quiet
echo "check: docker files are sound"
