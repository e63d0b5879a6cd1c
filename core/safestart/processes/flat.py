"""A model's fields as flat names, so that a query string or a command line can give inputs that hold objects."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, get_args, get_origin

from pydantic import BaseModel, Field, TypeAdapter, ValidationError, create_model
from pydantic.fields import FieldInfo

from safestart.errors import invalid
from safestart.model.places import placed
from safestart.model.plain_numbers import require_plain
from safestart.model.validation import refusal
from safestart.processes.base import WireModel
from safestart.runtime.plain_json import NameTwice, NoNumber, loads

M = TypeVar("M", bound=WireModel)
_NUMBERS = (int, float, int | None, float | None)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A flat name: its field, its text, and the opened field (``""``: none) that it belongs to.

    ``required``: neither the field nor the opened one has a default. ``json_text``: the field takes objects or lists,
    and the parameter their JSON.
    """

    field: FieldInfo
    text: str
    within: str
    required: bool
    json_text: bool


class Flat(Generic[M]):
    """The fields of ``model`` as flat parameters, in its order.

    A field named in ``opened`` is replaced by the fields of its object, or of the one object in its list. Every other
    field keeps its name; if it takes objects or lists, the parameter takes their JSON. So an optional object added to
    the model becomes a parameter without a change here.
    """

    def __init__(self, model: type[M], opened: Mapping[str, Any]) -> None:
        self._model = model
        self._validate = TypeAdapter(model).validator.validate_python
        self._opened = dict(opened)
        self._listed = {name for name in opened if get_origin(model.model_fields[name].annotation) is list}
        self.parameters: dict[str, Parameter] = {}
        for name, field in model.model_fields.items():
            for key, item in opened[name].__pydantic_fields__.items() if name in opened else [(name, field)]:
                if key in self.parameters:
                    raise ValueError(f"two fields would be called {key}")
                self.parameters[key] = Parameter(
                    item,
                    self._text(name, item),
                    name if name in opened else "",
                    item.is_required() and field.is_required(),
                    _holds_objects(item.annotation),
                )
        # Without values these are left out; the others become objects of their defaults.
        self._omitted = [
            name
            for name, inner in opened.items()
            if not model.model_fields[name].is_required()
            and any(item.is_required() for item in inner.__pydantic_fields__.values())
        ]
        self._numbers = {
            name
            for name, one in self.parameters.items()
            if not one.json_text and one.field.annotation in _NUMBERS
        }
        # Opened fields are not parameters themselves.
        self._special: dict[str, Parameter | None] = dict.fromkeys(opened)
        self._special |= {name: one for name, one in self.parameters.items() if one.within or one.json_text}

    def parse(self, values: Mapping[str, Any]) -> M:
        """Validate flat values, which may be texts; raises ``InvalidInput`` under the flat name."""
        top: dict[str, Any] = {name: {} for name in self._opened}
        for name, value in values.items():
            if isinstance(value, str) and name in self._numbers:
                require_plain(name, value)
            if name not in self._special:
                top[name] = value
                continue
            parameter = self._special[name]
            if parameter is None:
                raise invalid(name, "no field of this name", value)
            if parameter.json_text and isinstance(value, str):
                value = _from_json(name, value)
            (top[parameter.within] if parameter.within else top)[name] = value
        for name in self._omitted:
            if not top[name]:
                del top[name]
        for name in self._listed:
            if name in top:
                top[name] = [top[name]]
        try:
            parsed: M = self._validate(top)
            return parsed
        except ValidationError as error:
            reports = placed(self._model, error.errors(include_url=False))
            for report in reports:
                report["loc"] = self._flat(report["loc"])
            raise refusal(reports) from None

    def _text(self, name: str, item: FieldInfo) -> str:
        text = item.description or ""
        if name not in self._opened or name in self._listed:
            return text
        return f"{name.capitalize()}: {text[:1].lower()}{text[1:]}"

    def _flat(self, place: tuple[int | str, ...]) -> tuple[int | str, ...]:
        if not place or place[0] not in self._opened:
            return place
        return place[2:] if place[0] in self._listed else place[1:]


def described(parameters: Mapping[str, Parameter], name: str, doc: str) -> type[BaseModel]:
    """A model that describes parameters; :meth:`Flat.parse` validates."""
    fields: dict[str, Any] = {}
    for key, parameter in parameters.items():
        if parameter.json_text:
            fields[key] = (str, Field(... if parameter.required else None, description=parameter.text))
            continue
        field = copy(parameter.field)
        field.description = parameter.text
        if field.is_required() and not parameter.required:
            field.default = None
        fields[key] = (field.annotation, field)
    return create_model(name, __base__=WireModel, __doc__=doc, **fields)


def _holds_objects(annotation: Any) -> bool:
    """Whether a value of this type can be an object or a list."""
    kind = get_origin(annotation) or annotation
    if isinstance(kind, type) and issubclass(kind, list | dict | tuple | BaseModel):
        return True
    return any(_holds_objects(part) for part in get_args(annotation))


def _from_json(name: str, text: str) -> Any:
    try:
        return loads(text)
    except NameTwice as error:
        raise invalid(name, f"every name once in an object, and {error.name} comes twice", text) from None
    except NoNumber as error:
        raise invalid(name, error.required, f"{error.text} in {text}") from None
    except (ValueError, RecursionError):
        raise invalid(name, "JSON", text) from None
