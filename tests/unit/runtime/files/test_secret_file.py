"""The password of the database can come from a file."""

from __future__ import annotations

import pytest
from sqlalchemy.engine import make_url

from safestart.errors import InvalidInput
from safestart.runtime.settings import Settings

URL = "postgresql://safestart@database/safestart"


@pytest.fixture
def secret(tmp_path):
    path = tmp_path / "password"
    path.write_text("p@ss/w:rd%\n")
    return str(path)


def url(database_url, file):
    return Settings(database_url=database_url, database_password_file=file).url()  # type: ignore[call-arg, unused-ignore]


def test_the_file_fills_in_the_password_whatever_is_in_it(secret):
    parsed = make_url(url(URL, secret))
    assert parsed.password == "p@ss/w:rd%"
    assert (parsed.drivername, parsed.username, parsed.host, parsed.database) == (
        "postgresql",
        "safestart",
        "database",
        "safestart",
    )


@pytest.mark.parametrize(
    "given",
    [
        "postgresql://a:own@database/b",
        "postgresql://database/a@b",
        "sqlite:////tmp/a@b.sqlite3",
        "no url at all",
    ],
)
def test_what_has_a_password_or_can_have_none_stays(given, secret):
    assert url(given, secret) == given


@pytest.mark.parametrize(
    ("content", "said"), [(None, "No such file"), (b"\n", "empty"), (b"\xff\xfe", "no UTF-8")]
)
def test_a_file_that_holds_no_password_is_refused(content, said, tmp_path):
    path = tmp_path / "password"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InvalidInput, match=said) as refused:
        url(URL, str(path))
    assert refused.value.field == "database_password_file"
