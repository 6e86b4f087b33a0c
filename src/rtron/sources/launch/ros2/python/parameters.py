"""Parameters that a Python launch file gives to nodes, as elements (launch_ros: parameters)."""

from collections.abc import Iterator

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Choice,
    Foreign,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    Value,
    options,
    truth,
)
from rtron.sources.code.library_models.launch.constructor_calls import call_name, given
from rtron.sources.launch.ros2.python.substitutions import Texts
from rtron.sources.launch.ros2.substitutions.template import Pieces, Written, hole
from rtron.sources.launch.ros2.xml_yaml.element import Element

MAX_DEPTH = 24


def parameters(texts: Texts, value: Value | None) -> Iterator[Element]:
    """Yield an element for each parameter, or file of them, in a list of both."""
    items, certain = items_of(value) if value is not None else ((), True)
    for item in items:
        for option in options(item):
            yield from _source(texts, option)
    if not certain:
        more: dict[str, Written] = {"from": (hole("more parameters"),)}
        yield Element("param", more)


def _source(texts: Texts, value: Value) -> Iterator[Element]:
    name = call_name(value)
    if isinstance(value, MapValue):
        yield from entries(texts, value)
    elif isinstance(value, Instance) and name == "Parameter":
        fields = given(value)
        yield parameter(texts, texts.pieces(fields.get("name")), fields.get("value", NONE))
    elif value != NONE:
        attributes: dict[str, Written] = {"from": texts.pieces(value)}
        if isinstance(value, Instance) and name == "ParameterFile":
            allowed = given(value).get("allow_substs", NONE)
            known = truth(allowed) if not call_name(allowed) else None
            text = (str(bool(known)),) if known is not None else texts.pieces(allowed)
            attributes["allow_substs"] = text
        yield Element("param", attributes)


def entries(texts: Texts, value: MapValue, tag: str = "param", depth: int = 0) -> Iterator[Element]:
    """Yield an element for each entry of a dict."""
    texts.count()
    for key, inner in value.entries.items():
        name: Pieces = (str(key),)
        if isinstance(inner, MapValue) and depth < MAX_DEPTH:
            below = tuple(entries(texts, inner, tag, depth + 1))
            yield Element(tag, {"name": name}, below)
        elif inner != NONE:
            yield parameter(texts, name, inner, tag)


def parameter(texts: Texts, name: Pieces, value: Value, tag: str = "param") -> Element:
    """Return an element for one parameter; what is a text in Python stays one, unless evaluated."""
    attributes, children = _value(texts, value)
    return Element(tag, {"name": name, **attributes}, children)


def _value(texts: Texts, value: Value) -> tuple[dict[str, Written], tuple[Element, ...]]:
    if isinstance(value, Choice):
        return {"value": texts.pieces(value)}, ()
    if isinstance(value, Instance) and call_name(value) == "ParameterValue":
        fields = given(value)
        inner, children = _value(texts, fields.get("value", NONE))
        kind = fields.get("value_type", NONE)
        if isinstance(kind, (Native, Foreign)) and kind.name == "str":
            return {"value": texts.pieces(fields.get("value")), "type": "str"}, ()
        return inner, children
    if isinstance(value, Known):
        plain: dict[str, Written] = {"type": "str"} if isinstance(value.value, str) else {}
        return {"value": (str(value.value),), **plain}, ()
    if isinstance(value, ListValue) and not _is_one_text(value):
        return {"value": ("[]",)}, tuple(_item(texts, item) for item in value.items)
    return {"value": texts.pieces(value)}, ()


def _item(texts: Texts, value: Value) -> Element:
    """Return an item of a list; a list in it is one text (launch_ros: normalize_parameters)."""
    if isinstance(value, ListValue):
        return Element("item", {"value": texts.pieces(value)})
    return Element("item", *_value(texts, value))


def _is_one_text(value: ListValue) -> bool:
    """Tell whether a list of strings and substitutions makes one string."""
    called = [call_name(item) for item in value.items]
    plain = all(
        name or (isinstance(item, Known) and isinstance(item.value, str))
        for name, item in zip(called, value.items, strict=True)
    )
    return value.open or (any(called) and plain)
