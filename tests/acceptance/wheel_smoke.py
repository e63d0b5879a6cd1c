"""What an install from wheels must be able to do, run outside the checkout by the interpreter of the install."""

from __future__ import annotations

import sys
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

import safestart as ss

place = Path(ss.__file__).resolve()
assert Path(sys.prefix).resolve() in place.parents, place
names = ("safestart", "safestart-service", "safestart-worker")
assert {version(name) for name in names} == {ss.__version__}

scenario = ss.Scenario.of(3.0, 0.1)
assert ss.certify(scenario, [[5, 40], [0, 149], [90, 20]]).verdict.tolist() == ["GO", "UNDECIDED", "NO_GO"]
go, lost = ss.decide(scenario, (5, 40)), ss.decide(scenario, (0, 149))
assert (go.verify().verdict, lost.verify().verdict) == ("GO", "NO_GO")
assert ss.region(scenario).inner_area_m2 > 1e4
assert ss.fly(scenario, (5, 40)).safe
png = go._repr_png_()
assert png is not None
assert png.startswith(b"\x89PNG")
assert files("safestart.flight_table").joinpath("c", "safestart_flight.c").is_file()

from safestart.runtime.settings import Settings  # noqa: E402
from safestart_service.app import create_app  # noqa: E402
from safestart_worker import commands  # noqa: E402

assert callable(commands.register)
assert (
    create_app(Settings(database_url=f"sqlite:///{Path.cwd()}/smoke.sqlite3")).openapi()["info"]["version"]
    == ss.__version__
)
print("smoke passed on", sys.version.split()[0])
