"""Texts of the API description on its page: code between backticks, everything else escaped."""

from __future__ import annotations

from safestart_service.pages.render import coded


def test_backticks_are_code_and_nothing_else_is_markup() -> None:
    assert coded("use `a<b` or ``c``, not <b>") == "use <code>a&lt;b</code> or <code>c</code>, not &lt;b&gt;"
