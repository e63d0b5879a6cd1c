"""Epochs in the common time systems, as whole nanoseconds of TAI since 2000-01-01T00:00:00 TAI.

Leap seconds come from ERFA, the IAU's library. A leap second is an epoch of its own: 2016-12-31T23:59:60 UTC.
TT is TAI + 32.184 s, GPS time TAI - 19 s. TDB and UT1 are refused, because they need more than a table of leap seconds.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence

import numpy as np

from safestart.errors import InvalidInput, Unavailable, invalid

Nanoseconds = np.ndarray[tuple[int, ...], np.dtype[np.int64]]

SECOND = 1_000_000_000
_DAY = 86_400 * SECOND
_OFFSETS = {"TAI": 0, "TT": 32_184_000_000, "GPS": -19 * SECOND}
"""The system less TAI, ns."""
SYSTEMS = ("UTC", *_OFFSETS)
_DATE = re.compile(r"(\d{4})-(?:(\d{2})-(\d{2})|(\d{3}))T(\d{2}):(\d{2}):(\d{2})(?:\.(\d*))?Z?", re.ASCII)
_BEGIN = np.datetime64("2000-01-01", "D")


def system_of(name: str) -> str:
    """The time system of this name; raises ``InvalidInput`` for an unknown one."""
    if name not in SYSTEMS:
        raise invalid("TIME_SYSTEM", f"one of {', '.join(SYSTEMS)}", name)
    return name


def epochs_of(texts: Sequence[str], system: str) -> Nanoseconds:
    """TAI (K,) of epochs YYYY-MM-DDThh:mm:ss.f or YYYY-DDDThh:mm:ss.f, rounded to a nanosecond.

    Raises ``InvalidInput`` for an invalid epoch, a date or a time of day that does not exist, UTC before 1972 or so far
    ahead that its leap seconds are unknown, and another time system; ``Unavailable`` without ERFA.
    """
    system_of(system)
    days = np.empty(len(texts), dtype=np.int64)
    within = np.empty(len(texts), dtype=np.int64)
    known: dict[str, int] = {}
    for k, text in enumerate(texts):
        found = _matched(text)
        date = text[: text.index("T")]
        if date not in known:
            known[date] = _day(found, text)
        days[k] = known[date]
        within[k] = _within(found, text, system)
    if system != "UTC":
        return days * _DAY + within - _OFFSETS[system]
    unique = np.unique(days)
    ahead = leap_seconds(np.append(unique, unique + 1))
    place = np.searchsorted(unique, days)
    before, after = ahead[: len(unique)][place], ahead[len(unique) :][place]
    late = within >= _DAY + (after - before) * SECOND
    if late.any():
        raise invalid("epoch", "a leap second only where there is one", texts[int(np.argmax(late))])
    return days * _DAY + within + before * SECOND


def require_epoch(field: str, text: str) -> None:
    """Raise ``InvalidInput`` naming ``field`` unless ``text`` is an epoch of UTC, as :func:`epochs_of` reads it.

    A leap second is taken at the end of any day, since no table of them is needed here.
    """
    try:
        found = _matched(text)
        _day(found, text)
        _within(found, text, "UTC")
    except InvalidInput as error:
        raise invalid(field, str(error.required), text) from None


def _matched(text: str) -> re.Match[str]:
    found = _DATE.fullmatch(text)
    if found is None:
        raise invalid("epoch", "YYYY-MM-DDThh:mm:ss or YYYY-DDDThh:mm:ss", text)
    return found


def _within(found: re.Match[str], text: str, system: str) -> int:
    """Nanoseconds since the begin of the day."""
    hour, minute, second, part = int(found[5]), int(found[6]), int(found[7]), found[8] or ""
    if (
        hour > 23
        or minute > 59
        or second > 60
        or (second == 60 and (system, hour, minute) != ("UTC", 23, 59))
    ):
        raise invalid("epoch", "a time of day", text)
    nanoseconds = int(part[:9].ljust(9, "0")) + (len(part) > 9 and part[9] >= "5")
    return ((hour * 60 + minute) * 60 + second) * SECOND + nanoseconds


def _day(found: re.Match[str], text: str) -> int:
    """Days since 2000-01-01."""
    try:
        if found[4] is not None:
            first = np.datetime64(f"{found[1]}-01-01", "D")
            day = first + np.timedelta64(int(found[4]) - 1, "D")
            if int(found[4]) < 1 or not str(day).startswith(found[1]):
                raise ValueError
        else:
            day = np.datetime64(f"{found[1]}-{found[2]}-{found[3]}", "D")
    except ValueError:
        raise invalid("epoch", "a date of the calendar", text) from None
    if not "1972" <= found[1] <= "2199":
        raise invalid("epoch", "a year from 1972 to 2199", text)
    return int((day - _BEGIN).astype(np.int64))


def leap_seconds(days: Nanoseconds) -> Nanoseconds:
    """TAI - UTC (K,), s, at the begin of days since 2000-01-01."""
    try:
        import erfa
    except ModuleNotFoundError:
        raise Unavailable(
            "UTC requires the package pyerfa (extra files)", required="the package pyerfa"
        ) from None
    dates = (_BEGIN + days.astype("timedelta64[D]")).astype(object)
    parts = np.array([(date.year, date.month, date.day) for date in dates], dtype=np.int64).reshape(-1, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error", erfa.ErfaWarning)
        try:
            found = erfa.dat(parts[:, 0], parts[:, 1], parts[:, 2], 0.0)
        except (erfa.ErfaWarning, erfa.ErfaError):
            latest = str(max(dates))
            raise invalid("epoch", "UTC of days whose leap seconds are known", latest) from None
    out: Nanoseconds = np.rint(found).astype(np.int64)
    return out


def text_of(epochs: Nanoseconds, system: str) -> list[str]:
    """Texts YYYY-MM-DDThh:mm:ss.fffffffff of TAI epochs (K,) in a time system; inverse of :func:`epochs_of`."""
    system_of(system)
    epochs = np.asarray(epochs, dtype=np.int64)
    if system == "UTC":
        days = epochs // _DAY
        begin = days * _DAY + leap_seconds(days) * SECOND
        days = days - (epochs < begin)
        # A day with a leap second lasts one second longer.
        within = epochs - days * _DAY - leap_seconds(days) * SECOND
    else:
        shown = epochs + _OFFSETS[system]
        days = shown // _DAY
        within = shown - days * _DAY
    out = []
    for day, inside in zip(days.tolist(), within.tolist(), strict=True):
        seconds, nanoseconds = divmod(inside, SECOND)
        minutes = min(seconds // 60, 1439)
        hour, minute = divmod(minutes, 60)
        clock = f"{hour:02d}:{minute:02d}:{seconds - 60 * minutes:02d}.{nanoseconds:09d}"
        out.append(f"{_BEGIN + np.timedelta64(day, 'D')}T{clock}")
    return out


def shortened(text: str) -> str:
    """An epoch without the zeros at its end; whole seconds have no point."""
    return text.rstrip("0").rstrip(".") if "." in text else text


def seconds_since(epochs: Nanoseconds, begin: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Seconds (K,) from ``begin`` to epochs, both TAI."""
    out: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = (
        np.asarray(epochs, dtype=np.int64) - begin
    ) / SECOND
    return out
