"""Command lines are read strictly, as queries are: each option once, and numbers plain.

The last of two values would win silently, and ``1_0`` would be 10: either can turn a NO_GO into a GO.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from inspect import signature
from typing import Any, ClassVar

import typer
from typer.core import TyperCommand

from safestart.errors import invalid
from safestart.model.plain_numbers import is_number, require_plain


class Strict(TyperCommand):
    """A command each of whose options is given at most once, unless it takes several values; its numbers are plain."""

    numbers: ClassVar[frozenset[str]] = frozenset()
    """The names of its parameters that take numbers."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse; raises ``InvalidInput`` for a repeated option, or a number that a query refuses, too."""
        given, _, order = self.make_parser(ctx).parse_args(args=list(args))
        seen: set[str] = set()
        for option in order:
            if option.param_type_name == "option":
                name = option.opts[-1]
                if name in seen and not _may_repeat(option):
                    raise invalid(name, "one value", "another one")
                seen.add(name)
            if option.name in self.numbers:
                for text in _texts(given.get(option.name)):
                    require_plain(option.opts[-1], text)
        return super().parse_args(ctx, args)


def strictly(app: typer.Typer) -> None:
    """Let every command of the application, and of its groups, read its line strictly."""
    for command in app.registered_commands:
        command.cls = type("Strict", (Strict,), {"numbers": _numbers(command.callback)})
    for group in app.registered_groups:
        if group.typer_instance is not None:
            strictly(group.typer_instance)


def _numbers(function: Callable[..., Any] | None) -> frozenset[str]:
    """The parameters of a command's function that are numbers, or lists of them: by its signature, as Typer's own
    objects name a type differently from version to version."""
    if function is None:
        return frozenset()
    parameters = signature(function, eval_str=True).parameters
    return frozenset(name for name, one in parameters.items() if is_number(one.annotation))


def _may_repeat(option: Any) -> bool:
    """Whether it takes several values, or is a flag that says the same twice."""
    plain_flag = option.is_flag and not option.secondary_opts
    return bool(option.multiple or option.count or plain_flag)


def _texts(value: Any) -> Iterator[str]:
    """What was typed for a parameter: nothing, one text, or several."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, list | tuple):
        for part in value:
            yield from _texts(part)
