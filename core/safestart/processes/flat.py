"""A model's fields as flat names, so that a query string or a command line can give inputs that hold objects."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, create_model
from pydantic.fields import FieldInfo

from safestart.errors import invalid
from safestart.model.places import placed
from safestart.model.plain_numbers import is_number, require_plain
from safestart.model.strict_json import validated_values
from safestart.model.validation import refusal
from safestart.processes.base import WireModel
from safestart.runtime.plain_json import NameTwice, NoNumber, loads

M = TypeVar("M", bound=WireModel)
_FINITE = ConfigDict(allow_inf_nan=False)


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

    def value(self, name: str, given: Any) -> Any:
        """The value of what was typed or sent for it: JSON is parsed, anything else comes back as it is."""
        return _from_json(name, given) if self.json_text and isinstance(given, str) else given


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
            if not one.json_text and is_number(one.field.annotation)
        }
        self._json_texts = {name for name, one in self.parameters.items() if one.json_text}
        # Opened fields are not parameters themselves.
        self._special: dict[str, Parameter | None] = dict.fromkeys(opened)
        self._special |= {name: one for name, one in self.parameters.items() if one.within or one.json_text}

    def parse(self, values: Mapping[str, Any]) -> M:
        """Validate values of JSON under flat names, strictly; raises ``InvalidInput`` under the flat name."""
        return validated_values(self._model, self._whole(values), self._flat)

    def read(self, texts: Mapping[str, str]) -> M:
        """As :meth:`parse` for texts: plain scalars, and JSON where a parameter takes objects or lists."""
        for name in self._numbers.intersection(texts):
            require_plain(name, texts[name])
        if not self._json_texts.isdisjoint(texts):
            return self.parse({name: self._value(name, text) for name, text in texts.items()})
        # Every value is a scalar's text: pydantic reads it, which takes microseconds.
        try:
            parsed: M = self._validate(self._whole(texts))
            return parsed
        except ValidationError as error:
            reports = placed(self._model, error.errors(include_url=False))
            for report in reports:
                report["loc"] = self._flat(report["loc"])
            raise refusal(reports) from None

    def _whole(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The document of the model with these flat values."""
        top: dict[str, Any] = {name: {} for name in self._opened}
        for name, value in values.items():
            if name not in self._special:
                top[name] = value
                continue
            parameter = self._special[name]
            if parameter is None:
                raise invalid(name, "no field of this name", value)
            (top[parameter.within] if parameter.within else top)[name] = value
        for name in self._omitted:
            if not top[name]:
                del top[name]
        for name in self._listed:
            if name in top:
                top[name] = [top[name]]
        return top

    def _value(self, name: str, text: str) -> Any:
        """The value of one text, by its parameter's type."""
        parameter = self.parameters.get(name)
        if parameter is None or parameter.json_text:
            return text if parameter is None else parameter.value(name, text)
        try:
            kind: Any = parameter.field.annotation
            return TypeAdapter(kind, config=_FINITE).validate_python(text)
        except ValidationError as error:
            raise refusal([{**one, "loc": (name,)} for one in error.errors(include_url=False)]) from None

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
