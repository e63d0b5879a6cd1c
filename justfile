# One command each. `just` is optional: every recipe is one line that can be typed.

# install everything into .venv, exact versions
setup:
    python3 -m uv sync --all-packages

# the tests, as in the README
test *ARGS:
    python3 -m uv run --all-packages pytest {{ARGS}}

# unit and reference tests without the slow ones, on every core
test-quick *ARGS:
    python3 -m uv run --all-packages pytest tests/unit tests/reference -m "not slow" -n auto --durations=0 --durations-min=5 {{ARGS}}

# every test, with the lines and branches that none of them reaches
coverage:
    python3 -m uv run --all-packages pytest --cov --cov-report=term:skip-covered

# style, types, import contracts, drift
lint:
    python3 -m uv run --all-packages ruff check .
    python3 -m uv run --all-packages ruff format --check .
    python3 -m uv run --all-packages mypy
    python3 -m uv run --all-packages lint-imports
    python3 -m uv run --all-packages python tools/pins.py check
    python3 -m uv run --all-packages python tools/openapi.py check
    python3 -m uv run --all-packages python tools/settings_page.py check

# the pages' scripts: lint and unit tests (needs node)
pages:
    npm install --silent
    npm run --silent lint
    npm test --silent

# every engine beside its peer
bench:
    python3 -m uv run --all-packages safestart bench

# database, service and worker on this machine
serve:
    python3 -m uv run --all-packages safestart up

# resolve anew and pin the versions
lock:
    python3 -m uv run --all-packages python tools/pins.py write

# rewrite what is generated: OpenAPI document, settings page, README picture
generate:
    python3 -m uv run --all-packages python tools/openapi.py write
    python3 -m uv run --all-packages python tools/settings_page.py write
    python3 -m uv run --all-packages python tools/picture.py

# every page in Chromium, their screenshots into docs/screenshots
screenshots:
    SAFESTART_SCREENSHOTS=docs/screenshots python3 -m uv run --all-packages pytest tests/browser/test_baselines.py -k looks
    rm docs/screenshots/coarse-*.png

# pictures that the pages are compared with, after they were changed on purpose; look at them before you commit them
baselines:
    BASELINES=write python3 -m uv run --all-packages pytest tests/browser/test_baselines.py -k looks

# the documentation as a site in build/site, strictly; `python -m http.server -d build/site` shows it
docs:
    python3 -m uv run --all-packages mkdocs build --strict
