#!/usr/bin/env bash
# Checks of the images and the compose file, by hand: they install the engines anew.
#
#   docker/check.sh            the install steps of both images in clean environments; needs no Docker engine
#   docker/check.sh --engine   builds both images, starts everything, runs one job through it and stops it
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if docker compose version >/dev/null 2>&1; then client="docker compose"
elif command -v docker-compose >/dev/null; then client=docker-compose
else client=; fi
echo "not the password of anything else" >"$work/password"
export SAFESTART_DB_PASSWORD_FILE="$work/password" SAFESTART_PORT="${SAFESTART_PORT:-18000}"

without_engine() {
    local part step
    for part in service worker; do
        step=$(grep -m1 -oE 'uv sync .*' "docker/$part.Dockerfile")
        mkdir -p "$work/$part"
        cp -r pyproject.toml core service worker "$work/$part/"
        (cd "$work/$part" && UV_PROJECT_ENVIRONMENT="$work/$part/env" bash -c "${step/uv/python3 -m uv}")
    done
    local bin=$work/service/env/bin
    "$bin/safestart" serve --help >/dev/null
    "$bin/python" -c "import psycopg, safestart_service.app"
    "$bin/python" -c "$no_engines"
    bin=$work/worker/env/bin
    "$bin/safestart" worker --help >/dev/null
    "$bin/dask" scheduler --help >/dev/null
    "$bin/python" -c "import numba, psycopg, safestart_worker.loop"
    "$bin/python" -c "$no_jax"
    if [ -n "$client" ]; then $client -f docker/compose.yaml config --quiet
    else echo "check: no compose client here, the compose file is only parsed by the tests"; fi
}

with_engine() {
    [ -n "$client" ] || { echo "check: no compose client here"; exit 1; }
    local compose="$client -p safestart-check -f docker/compose.yaml" base="http://127.0.0.1:$SAFESTART_PORT"
    trap '$client -p safestart-check -f docker/compose.yaml down --volumes; rm -rf "$work"' EXIT
    $compose build
    $compose run --rm --no-deps --entrypoint python service -c "$no_engines"
    local key job status=
    key=$($compose run --rm service keys create --name check --role submit | grep -oE 'sst_[^[:space:]]+')
    $compose up --detach --wait --wait-timeout 600
    ask() { curl --fail --silent --show-error --max-time 20 --header "X-API-Key: $key" "$@"; }
    field() { grep -oE "\"$1\":\"[^\"]+\"" | head -n 1 | cut -d '"' -f 4; }
    job=$(ask --json '{"inputs": {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 11, "ny": 11}}}' \
        "$base/processes/benchmark/execution" | field jobID)
    for _ in $(seq 300); do
        status=$(ask "$base/jobs/$job" | field status)
        case "$status" in successful | failed | dismissed) break ;; esac
        sleep 2
    done
    echo "check: a benchmark with every engine: $status"
    [ "$status" = successful ] || { $compose logs --tail 50; exit 1; }
    $compose stop
    # 143: ended by the SIGTERM that asked for it. 137 would mean that it had to be killed.
    local container code
    for container in $($compose ps --all --quiet); do
        code=$(docker inspect --format '{{.State.ExitCode}}' "$container")
        case "$code" in 0 | 143) ;; *) echo "check: $container stopped with $code"; exit 1 ;; esac
    done
}

no_engines='
import importlib.util as found
held = [name for name in ("jax", "numba", "dask", "distributed", "safestart_worker") if found.find_spec(name)]
raise SystemExit(f"the service image would hold {held}" if held else 0)'

no_jax='
import importlib.util as found
raise SystemExit("the worker would hold JAX" if found.find_spec("jax") else 0)'

if [ "${1:-}" = --engine ]; then with_engine; else without_engine; fi
echo "check: docker files are sound"
