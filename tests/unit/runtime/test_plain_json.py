"""JSON with every name once, where the command line and the records read it."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.runtime.plain_json import NameTwice, loads, require_unique_names

TREES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(TREES)
def test_what_has_every_name_once_is_read_as_ever(tree):
    text = json.dumps(tree)
    assert loads(text) == tree
    require_unique_names(text.encode())


@pytest.mark.parametrize("text", ["NaN", "[-Infinity]", '{"a": 1e999}'])
def test_what_is_not_finite_is_refused(text):
    with pytest.raises(ValueError, match="a double can hold" if "1e" in text else "finite"):
        loads(text)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-32"])
def test_bytes_are_utf_8_without_a_mark(encoding):
    assert loads('{"a": "é"}'.encode()) == {"a": "é"}
    with pytest.raises(ValueError, match=r"utf-8|UTF-8|Expecting"):
        loads('{"a": "é"}'.encode(encoding))
    with pytest.raises(UnicodeDecodeError):
        loads(b'"\xed\xa0\x80"')  # half of a surrogate pair


@pytest.mark.parametrize(
    "text", ['{"a":1,"a":1}', '[[{"b":{"a":1,"c":2,"a":3}}]]', '{"":1,"":2}', '{"a":1,"\\u0061":2}']
)
def test_a_name_twice_is_refused_at_every_depth(text):
    for read in (loads, require_unique_names):
        with pytest.raises(NameTwice, match="twice"):
            read(text)


def test_the_command_line_refuses_it(tmp_path):
    inputs, proof = tmp_path / "inputs.json", tmp_path / "proof.json"
    inputs.write_text('{"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "a_max_m_s2": 1.0}')
    proof.write_text('{"verdict": "NO_GO", "verdict": "GO"}')
    refused = CliRunner().invoke(build(), ["run", "certificate", "--input", str(inputs)])
    assert isinstance(refused.exception, InvalidInput)
    assert "a_max_m_s2" in refused.exception.detail
    assert CliRunner().invoke(build(), ["verify", str(proof)]).exit_code == 2
