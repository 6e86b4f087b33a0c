"""What `str()` and `repr()` make of a value (docs.python.org: built-in functions)."""

from rtron.sources.code.interpreter.abstract_values.items import key_value
from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Value,
    concat,
    map_options,
)

_MAX_DEPTH = 6
_MAX_ITEMS = 256
_BRACKETS = {"list": ("[", "]"), "tuple": ("(", ")"), "dict": ("{", "}")}
_QUOTE, _COMMA, _COLON = Scalar("'"), Scalar(", "), Scalar(": ")


def str_of(value: Value, depth: int = 0) -> Value:
    """Return the text of a list, tuple or dict whose items are all there; any other as it is."""
    kind = "dict" if isinstance(value, MapValue) else getattr(value, "kind", "")
    if not isinstance(value, (ListValue, MapValue)) or value.open or kind not in _BRACKETS:
        return value
    size = len(value.fields if isinstance(value, MapValue) else value.items)
    if depth > _MAX_DEPTH or size > _MAX_ITEMS:
        return UNKNOWN
    items = _item_texts(value, depth + 1)
    first, last = _BRACKETS[kind]
    parts = [part for item in items for part in (_COMMA, item)][1:]
    is_single = kind == "tuple" and len(items) == 1
    return concat((Scalar(first), *parts, Scalar(f",{last}" if is_single else last)))


def _item_texts(value: ListValue | MapValue, depth: int) -> list[Value]:
    if isinstance(value, ListValue):
        return [repr_of(item, depth) for item in value.items]
    pairs = ((repr_of(key_value(key)), repr_of(each, depth)) for key, each in value.entries.items())
    return [concat((key, _COLON, each)) for key, each in pairs]


def repr_of(value: Value, depth: int = 0) -> Value:
    """Return what `repr()` makes of a value: a text is in quotes."""

    def shown(option: Value) -> Value:
        if isinstance(option, Scalar) and isinstance(option.value, (str, bytes)):
            return Scalar(repr(option.value), option.tainted)
        if isinstance(option, PartialText):
            return concat((_QUOTE, option, _QUOTE))
        return str_of(option, depth)

    return map_options(value, shown)
