"""Options that are given twice are refused: the last one would win silently, and turn a NO_GO into a GO."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand

from safestart.errors import invalid


class Once(TyperCommand):
    """A command each of whose options is given at most once, unless it takes several values."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse; raises ``InvalidInput`` for a repeated option."""
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        seen: set[str] = set()
        for option in order:
            if option.param_type_name != "option":
                continue
            name = option.opts[-1]
            if name in seen and not _may_repeat(option):
                raise invalid(name, "one value", "another one")
            seen.add(name)
        return super().parse_args(ctx, args)


def _may_repeat(option: Any) -> bool:
    """Whether it takes several values, or is a flag that says the same twice."""
    plain_flag = option.is_flag and not option.secondary_opts
    return bool(option.multiple or option.count or plain_flag)


def each_once(app: typer.Typer) -> None:
    """Let every command of the application, and of its groups, refuse repeated options."""
    for command in app.registered_commands:
        command.cls = Once
    for group in app.registered_groups:
        if group.typer_instance is not None:
            each_once(group.typer_instance)
