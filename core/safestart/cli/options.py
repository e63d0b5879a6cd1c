"""Options of a command from the flat parameters of a model: the model gives name, type, default and help."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from enum import Enum
from inspect import Parameter, Signature, signature
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

import typer
from pydantic import BaseModel
from pydantic_core import to_json

from safestart.processes import flat

Command = TypeVar("Command", bound=Callable[..., None])


def takes(
    parameters: Mapping[str, flat.Parameter], *, without: Container[str] = ()
) -> Callable[[Command], Command]:
    """Give a command an option for each parameter; it receives them as keyword arguments, beside its own.

    An option that is not given is None. Texts pass unchecked: the model validates them.
    """
    options = [_option(name, one) for name, one in parameters.items() if name not in without]
    options.sort(key=lambda option: option.default is not Parameter.empty)  # required ones first

    def decorate(command: Command) -> Command:
        own = signature(command, eval_str=True).parameters.values()
        parameters = [*options, *(one for one in own if one.kind is Parameter.KEYWORD_ONLY)]
        command.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
        command.__annotations__ = {one.name: one.annotation for one in parameters}
        return command

    return decorate


def _option(name: str, parameter: flat.Parameter) -> Parameter:
    field = parameter.field
    kinds = [kind for kind in get_args(field.annotation) or (field.annotation,) if kind is not type(None)]
    kind = kinds[0] if len(kinds) == 1 and kinds[0] in (bool, int, float) else str
    words = _words(field.annotation)
    default = None if field.is_required() else _shown(field.get_default(call_default_factory=True))
    told = typer.Option(
        help=parameter.text,
        metavar=f"[{'|'.join(words)}]" if words else None,
        show_default=default or False,
    )
    return Parameter(
        name,
        Parameter.KEYWORD_ONLY,
        default=Parameter.empty if parameter.required else None,
        annotation=Annotated[kind if parameter.required else kind | None, told],
    )


def _shown(default: Any) -> str | None:
    """A default as one writes it on the command line; None where there is nothing to write."""
    if isinstance(default, Enum):
        default = default.value
    if isinstance(default, (BaseModel, list, tuple, dict)):
        return to_json(default).decode() if default else None
    return None if default is None else str(default)


def _words(annotation: Any) -> list[str]:
    """The words that a parameter accepts, if it accepts words."""
    if get_origin(annotation) is Literal:
        return [str(word) for word in get_args(annotation)]
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return [str(member.value) for member in annotation]
    return []
