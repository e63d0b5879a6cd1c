"""Formats of the field that are not read, known by their first bytes, so that a refusal can name them."""

from __future__ import annotations

import re

from safestart.errors import InvalidInput

_LOOK_AT = 4096
_CONVERT = "convert it to an OEM"
# What the first bytes look like, the format's name, what helps.
_KNOWN = (
    (
        re.compile(rb"#[a-d][PV ]\d{4} "),
        "an SP3 orbit file (Earth-fixed positions of GNSS satellites)",
        _CONVERT,
    ),
    (re.compile(rb"stk\.v\."), "an ephemeris or attitude of STK", "export it as an OEM or AEM"),
    (re.compile(rb"(DAF/|NAIF/DAF|DAF/SPK|DAF/CK)"), "a binary kernel of SPICE", f"{_CONVERT} or AEM"),
    (re.compile(rb"KPL/"), "a text kernel of SPICE", f"{_CONVERT} or AEM"),
    (
        re.compile(rb"(?:[^\r\n]{1,69}\r?\n)?1 [ 0-9A-Z]{5}[UCS ]"),
        "mean elements (TLE)",
        f"propagate it by SGP4 and {_CONVERT}",
    ),
    (
        re.compile(rb"CCSDS_OMM_VERS|(?:<[?!][^>]*>\s*)*<(?:ndm\b[^>]*>\s*<)?omm\b"),
        "mean elements (OMM)",
        f"propagate it by SGP4 and {_CONVERT}",
    ),
    (
        re.compile(rb"CCSDS_[TR]DM_VERS|(?:<[?!][^>]*>\s*)*<[tr]dm\b"),
        "a message of tracking data or re-entry",
        "determine an orbit first",
    ),
    (
        re.compile(rb"\x89HDF|MATLAB 7"),
        "HDF5 (MATLAB 7.3 or NetCDF 4)",
        "save it as MATLAB 5 (-v7), Parquet or CSV",
    ),
    (re.compile(rb"CDF[\x01\x02\x05]"), "NetCDF", "save it as Parquet, CSV or MATLAB 5"),
    (re.compile(rb"PK\x03\x04"), "a ZIP archive", "unpack it first"),
    (re.compile(rb"\x1f\x8b"), "a gzip archive", "unpack it first"),
)


def refuse_foreign(data: bytes) -> None:
    """Raise ``InvalidInput`` that names the format, when the bytes begin as one that safestart does not read."""
    begin = data[:_LOOK_AT].lstrip(b"\xef\xbb\xbf \t\r\n")
    for pattern, name, help_ in _KNOWN:
        if pattern.match(begin):
            raise InvalidInput(
                f"file: required a CCSDS message (KVN or XML), CSV, Parquet or MATLAB 5, received {name}: {help_}"
            )
