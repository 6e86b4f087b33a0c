"""The standard library of C++, and boost and Qt in its place, as far as names depend on it."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.calling import dispatch
from rtron.sources.code.interpreter.items import items_of, listed, pair
from rtron.sources.code.interpreter.iterators import ITERATOR
from rtron.sources.code.interpreter.machine import Machine, ThrownError
from rtron.sources.code.interpreter.operations import percent
from rtron.sources.code.interpreter.values import (
    NONE,
    OPEN,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Placeholder,
    Text,
    Value,
    concat,
    each,
    is_tainted,
    options,
    spelled,
)
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.natives.cpp import cpp
from rtron.sources.code.natives.started import shell_words, started_by_words

_HIDDEN = "runs or registers what the source does not show"
_SIZE_AND_FILL = 2
_KEY_AND_VALUE = 2
_NUMBERS: Mapping[str, object] = {
    **dict.fromkeys(
        ("int", "long", "short", "size_t", "unsigned", "uint32_t", "int32_t", "uint8_t"), 0
    ),
    **dict.fromkeys(("double", "float"), 0.0),
    "bool": False,
}


def _text(_: Machine, arguments: Arguments) -> Value:
    given, letter = arguments.get(0), arguments.get(1)
    if isinstance(given, Known) and isinstance(given.value, int) and isinstance(letter, Known):
        return Known(str(letter.value) * max(0, min(given.value, 256)))
    return Known("") if given is None else given


def _number(name: str, _: Machine, arguments: Arguments) -> Value:
    """Make a number; one that is not initialised may be anything."""
    given = arguments.get(0)
    return Hole(name) if given is None else given


def _as_item(machine: Machine, item: Value, arguments: Arguments, at: int = 0) -> Value:
    """Return what braces make of an element: `{"a", 1}` in a vector of pairs or structs."""
    if not isinstance(item, ListValue) or len(arguments.types) <= at:
        return item
    inner = Arguments(values=item.items, line=arguments.line, frame=arguments.frame)
    made = cpp(machine).make(arguments.types[at], inner)
    return item if isinstance(made, Hole) else made


def _vector(machine: Machine, arguments: Arguments) -> Value:
    given = arguments.get(0)
    if isinstance(given, ListValue):
        items = tuple(_as_item(machine, item, arguments) for item in given.items)
        return ListValue({**given.fields, "items": items})
    if (
        isinstance(given, Known)
        and isinstance(given.value, int)
        and len(arguments.values) <= _SIZE_AND_FILL
    ):
        fill = arguments.get(1) or Hole("item")
        return listed([fill] * max(0, min(given.value, 256)))
    if given is not None and all(_is_item(value) for value in arguments.values):
        return listed(arguments.values)
    return ListValue({"items": (), "open": given is not None})


def _is_item(value: Value) -> bool:
    """`std::vector<std::string> v{"a", "b"}`: iterators and sizes are no items."""
    if isinstance(value, Known):
        return isinstance(value.value, str)
    return isinstance(value, Text) or (isinstance(value, Instance) and value.type is not ITERATOR)


def _map(machine: Machine, arguments: Arguments) -> Value:
    made = MapValue(pairs=True, missing=_missing(machine, arguments))
    given = arguments.get(0)
    if isinstance(given, MapValue):
        return MapValue(dict(given.fields), pairs=True, missing=made.missing)
    pairs = items_of(given)[0] if given is not None and len(arguments.values) == 1 else ()
    for item in pairs or arguments.values:
        key, value = (*items_of(item)[0], Hole("?"), Hole("?"))[:2]
        entry = _as_item(machine, value, arguments, 1)
        made.fields[key.value if isinstance(key, Known) else OPEN] = entry
    return made


def _missing(machine: Machine, arguments: Arguments) -> Callable[[], Value] | None:
    """`m[key]` makes a default of the mapped type where there is no entry (std::map)."""
    if len(arguments.types) < _KEY_AND_VALUE:
        return None
    return partial(cpp(machine).default, arguments.types[1], arguments.frame)


def _array(machine: Machine, arguments: Arguments) -> Value:
    """`T name[n]`: as many as it says of what T is by default."""
    given = arguments.get(0)
    if isinstance(given, ListValue):
        items = tuple(_as_item(machine, item, arguments) for item in given.items)
        return ListValue({**given.fields, "items": items})
    types = arguments.types
    size = int(types[1].name) if len(types) > 1 and types[1].name.isdigit() else 0
    element: Value = Hole("item")
    if types:
        element = cpp(machine).default(types[0], arguments.frame)
    return ListValue({"items": (element,) * min(size, 64), "open": size == 0})


def _pair(_: Machine, arguments: Arguments) -> Value:
    first, second = (*arguments.values, Hole("first"), Hole("second"))[:2]
    return pair(first, second)


def _make_pair(machine: Machine, _: object, arguments: Arguments) -> Value:
    return _pair(machine, arguments)


def _pointer(_: Machine, arguments: Arguments) -> Value:
    """Make a smart pointer, which is what it points at."""
    return arguments.get(0) or NONE


def _make_shared(machine: Machine, _: object, arguments: Arguments) -> Value:
    type = arguments.types[0] if arguments.types else TypeRef("?")
    return cpp(machine).make(type, arguments)


def _same(_: Machine, __: object, arguments: Arguments) -> Value:
    return arguments.get(0) or NONE


def _to_string(_: Machine, __: object, arguments: Arguments) -> Value:
    def shown(value: Value) -> Value:
        if isinstance(value, Known) and isinstance(value.value, float):
            return Known(f"{value.value:f}", value.tainted)
        if isinstance(value, Known) and isinstance(value.value, bool):
            return Known(str(int(value.value)), value.tainted)
        return concat((value,))

    return each(arguments.get(0) or Known(""), shown)


def _lexical_cast(machine: Machine, _: object, arguments: Arguments) -> Value:
    target = str(arguments.types[0]) if arguments.types else "std::string"
    if "string" in target:
        return concat((arguments.get(0) or Known(""),))
    return _parsed(float if target in {"double", "float"} else int, machine, None, arguments)


def _parsed(make: Callable[[Any], object], _: Machine, __: object, arguments: Arguments) -> Value:
    value = arguments.get(0)
    if not isinstance(value, Known):
        return Hole("number", value is not None and is_tainted(value))
    try:
        return Known(make(value.value), value.tainted)
    except (TypeError, ValueError):
        return Hole("number")


def _stream(_: Machine, arguments: Arguments) -> Value:
    return Instance(_STREAM, {"text": arguments.get(0) or Known("")})


def _write(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    added = concat((owner.fields["text"], arguments.get(0) or Known("")))
    machine.trail.set(owner.fields, "text", added)
    return owner


def _read(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    if arguments.values:
        machine.trail.set(owner.fields, "text", arguments.values[0])
    return owner.fields["text"]


def _text_of(_: Machine, __: object, arguments: Arguments) -> Value:
    """`boost::str(format)`."""
    given = arguments.get(0) or Known("")
    return given.fields.get("text", given) if isinstance(given, Instance) else given


def _getline(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`getline(stream, line, separator)`: the text up to a separator, while there is any."""
    stream, place = arguments.get(0), arguments.place(1)
    separator = arguments.get(2) or Known("\n")
    if not isinstance(stream, Instance) or stream.type is not _STREAM or place is None:
        return _forget(machine, arguments)
    text = stream.fields["text"]
    if not (isinstance(text, Known) and isinstance(separator, Known)):
        return _forget(machine, arguments)
    line, _, rest = str(text.value).partition(str(separator.value))
    if not text.value:
        return Known(value=False)
    machine.trail.set(*place, Known(line, text.tainted))
    machine.trail.set(stream.fields, "text", Known(rest, text.tainted))
    return Known(value=True)


def _forget(machine: Machine, arguments: Arguments) -> Value:
    place = arguments.place(1)
    if place is not None:
        machine.trail.set(*place, Hole("line"))
    return Hole("getline")


def _extract(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`stream >> word` of a known text."""
    text, place = owner.fields["text"], arguments.place(0)
    if not isinstance(text, Known) or place is None:
        return Hole("stream")
    word, _, rest = str(text.value).lstrip().partition(" ")
    if word:
        machine.trail.set(*place, Known(word, text.tainted))
    machine.trail.set(owner.fields, "text", Known(rest, text.tainted))
    machine.trail.set(owner.fields, "truth", Known(bool(word)))
    return owner


def _boost_format(_: Machine, arguments: Arguments) -> Value:
    return Instance(_FORMAT, {"text": arguments.get(0) or Known("")})


def _fill(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`boost::format("%s_%d") % a % b`: each % fills the next place."""
    template = owner.fields["text"]
    if not isinstance(template, Known):
        return owner
    before, mark, after = str(template.value).partition("%")
    number = after[:1].isdigit() and after[1:2] == "%"
    spec, rest = ("s", after[2:]) if number else (after[:1], after[1:])
    filled = percent(Known(f"{before}{mark}{spec}"), listed((arguments.get(0) or NONE,), "tuple"))
    return Instance(_FORMAT, {"text": concat((filled, Known(rest)))})


def _bind(_: Machine, __: object, arguments: Arguments) -> Value:
    """`boost::bind(&C::method, object, _1)`: the method, bound to the object (boost: bind)."""
    called, given = arguments.get(0), arguments.values[1:]
    if not isinstance(called, FunctionValue):
        return Hole("bind")
    is_method = called.owner is None and "::" in called.function.name and not called.function.static
    if is_method and given and isinstance(given[0], Instance):
        return _method(called, given[0], given[1:])
    if called.owner is not None and given and given[0] is called.owner:
        given = given[1:]
    return FunctionValue(
        called.function,
        called.closure,
        called.owner,
        given,
        called.cls,
        called.types,
        called.overloads,
    )


def _method(called: FunctionValue, owner: Instance, given: tuple[Value, ...]) -> FunctionValue:
    cls = called.cls or (owner.type if not isinstance(owner.type, NativeClass) else None)
    return FunctionValue(
        called.function, called.closure, owner, given, cls, called.types, called.overloads
    )


def _thread(machine: Machine, arguments: Arguments) -> Value:
    """Make a thread, which runs what it is given."""
    bound = _bind(machine, None, arguments) if len(arguments.values) > 1 else arguments.get(0)
    machine.escape(bound)
    return Instance(_THREAD)


def _function(_: Machine, arguments: Arguments) -> Value:
    return arguments.get(0) or Hole("function")


def _sprintf(offset: int, machine: Machine, _: object, arguments: Arguments) -> Value:
    """`sprintf(buffer, format, …)`, `snprintf(buffer, size, format, …)`."""
    place, format = arguments.place(0), arguments.get(offset)
    if place is None or format is None:
        return Hole("sprintf")
    text = percent(format, listed(arguments.values[offset + 1 :], "tuple"))
    machine.trail.set(*place, text)
    return Hole("sprintf")


def _getenv(machine: Machine, _: object, arguments: Arguments) -> Value:
    name = arguments.get(0)
    environ = dict(machine.recorder.site.environ)
    if isinstance(name, Known):
        return Known(environ[str(name.value)]) if name.value in environ else NONE
    return Hole("getenv")


def _copy_text(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`strcpy(target, source)`."""
    place = arguments.place(0)
    if place is not None:
        machine.trail.set(*place, arguments.get(1) or Hole("strcpy"))
    return arguments.get(1) or Hole("strcpy")


def _hidden(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Note a call that runs what the source does not show."""
    what = " ".join(spelled(value) for value in arguments.values[:1])
    machine.recorder.unresolved(f"call of {what}", _HIDDEN, arguments.evidence)
    return Hole("hidden")


def _system(machine: Machine, _: object, arguments: Arguments) -> Value:
    for option in options(arguments.get(0)):
        started_by_words(machine, shell_words(spelled(option)), arguments)
    return Hole("system")


def _for_each(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::for_each(xs.begin(), xs.end(), function)`."""
    start, function = arguments.get(0), arguments.get(2) or NONE
    if isinstance(start, Instance) and start.type is ITERATOR and "items" in start.fields:
        items = start.fields["items"]
        for item in items.fields.values() if isinstance(items, Instance) else ():
            given = Arguments(values=(item,), line=arguments.line, frame=arguments.frame)
            dispatch(machine, function, given)
    else:
        machine.escape(function)
    return NONE


def _exit(_: Machine, __: object, ___: Arguments) -> Value:
    """End the program."""
    raise ThrownError("SystemExit")


def _joined(_: Machine, __: object, arguments: Arguments) -> Value:
    """`boost::algorithm::join(words, separator)`."""
    items, certain = items_of(arguments.get(0) or NONE)
    separator = arguments.get(1) or Known("")
    spread = [part for item in items for part in (separator, item)]
    return concat(spread[1:]) if certain else Hole("join")


def _split(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`boost::split(words, text, boost::is_any_of(" "))` (boost: string algorithms)."""
    words, text, separators = arguments.get(0), arguments.get(1), arguments.get(2)
    if not isinstance(words, ListValue):
        return NONE
    if not (isinstance(text, Known) and isinstance(separators, Known)):
        machine.trail.open(words.fields)
        return words
    pieces = str(text.value)
    for letter in str(separators.value)[1:]:
        pieces = pieces.replace(letter, str(separators.value)[0])
    found = pieces.split(str(separators.value)[:1] or None)
    machine.trail.set(words.fields, "items", tuple(Known(piece, text.tainted) for piece in found))
    return words


def _compare_texts(_: Machine, __: object, arguments: Arguments) -> Value:
    left, right = arguments.get(0), arguments.get(1)
    if isinstance(left, Known) and isinstance(right, Known):
        a, b = str(left.value), str(right.value)
        return Known((a > b) - (a < b), left.tainted)
    return Hole("strcmp")


PARAMETER_KIND = "XmlRpc::XmlRpcValue::Type"


def kind_of(_: Machine, owner: Value, __: Arguments) -> Value:
    """`XmlRpcValue::getType()`: the part behind `Type` of its name (XmlRpcValue.h)."""
    if isinstance(owner, ListValue):
        return Known("Array")
    if isinstance(owner, MapValue):
        return Known("Struct")
    if not isinstance(owner, Known):
        return Hole("getType")
    kinds = {bool: "Boolean", int: "Int", float: "Double", str: "String"}
    return Known(kinds.get(type(owner.value), "Invalid"))


_THREAD = NativeClass("boost::thread")
_STREAM = NativeClass(
    "std::stringstream",
    _stream,
    {"operator<<": _write, "operator>>": _extract, "str": _read, "toStdString": _read},
)
_FORMAT = NativeClass(
    "boost::format", _boost_format, {"operator%": _fill, "str": _read, "toStdString": _read}
)


def _classes() -> dict[str, NativeClass]:
    classes = {name: NativeClass(name, partial(_number, name)) for name in _NUMBERS}
    for name, make in _MAKERS.items():
        for space in ("", "std::", "boost::", "boost::unordered::"):
            classes[space + name] = NativeClass(space + name, make)
    for name in ("stringstream", "ostringstream", "istringstream"):
        classes["std::" + name] = classes[name] = _STREAM
    for name in ("boost::format", "format"):
        classes[name] = _FORMAT
    classes["QString"] = classes["char"] = NativeClass("QString", _text)
    return classes


_MAKERS: Mapping[str, Callable[..., Value]] = {
    "string": _text,
    **dict.fromkeys(("vector", "list", "deque", "set", "unordered_set", "queue", "stack"), _vector),
    **dict.fromkeys(("map", "unordered_map", "multimap"), _map),
    "array": _array,
    "pair": _pair,
    **dict.fromkeys(("shared_ptr", "unique_ptr", "scoped_ptr", "auto_ptr", "weak_ptr"), _pointer),
    **dict.fromkeys(("thread", "async"), _thread),
    "function": _function,
}


def _get_item(_: Machine, __: object, arguments: Arguments) -> Value:
    """`std::get<0>(tuple)`."""
    at = arguments.types[0].name if arguments.types else ""
    items, _certain = items_of(arguments.get(0) or NONE)
    return items[int(at)] if at.isdigit() and int(at) < len(items) else Hole("get")


_CALLS: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(("make_shared", "make_unique"), _make_shared),
    **dict.fromkeys(
        ("move", "ref", "cref", "forward", "static_pointer_cast", "dynamic_pointer_cast"), _same
    ),
    "make_pair": _make_pair,
    "to_string": _to_string,
    "lexical_cast": _lexical_cast,
    "bind": _bind,
    "mem_fn": _same,
    "getline": _getline,
    "stoi": partial(_parsed, int),
    "stod": partial(_parsed, float),
    "for_each": _for_each,
    "join": _joined,
    "exit": _exit,
    "abort": _exit,
    "quick_exit": _exit,
    "make_tuple": lambda machine, _, arguments: listed(arguments.values, "tuple"),
    "get": _get_item,
    "split": _split,
    "is_any_of": _same,
    "str": _text_of,
    "async": lambda machine, _, arguments: _thread(machine, arguments),
}


def _functions() -> dict[str, Native]:
    functions = {
        f"{space}{name}": Native(name, call)
        for name, call in _CALLS.items()
        for space in ("std::", "boost::", "boost::algorithm::", "boost::this_thread::")
    }
    plain: Mapping[str, Callable[..., Value]] = {
        "bind": _bind,
        "sprintf": partial(_sprintf, 1),
        "snprintf": partial(_sprintf, 2),
        "atoi": partial(_parsed, int),
        "atof": partial(_parsed, float),
        **dict.fromkeys(("exit", "_exit", "abort"), _exit),
        **dict.fromkeys(("strcpy", "std::strcpy", "strncpy"), _copy_text),
        **dict.fromkeys(
            [
                "dlopen",
                "execl",
                "execlp",
                "execle",
                "execv",
                "execvp",
                "execve",
                "posix_spawn",
                "ros::master::execute",
                "ros::TopicManager::instance",
                "ros::ServiceManager::instance",
            ],
            _hidden,
        ),
        "getenv": _getenv,
        "std::getenv": _getenv,
        "system": _system,
        "std::system": _system,
        "popen": _system,
        "strcmp": _compare_texts,
        "QString::fromStdString": _same,
        "std::ref": _same,
    }
    functions.update({name: Native(name, call) for name, call in plain.items()})
    return functions


CONSTANTS: Mapping[str, Value] = {"std::string::npos": Known(-1), "string::npos": Known(-1)}
PLACEHOLDERS = {
    f"{space}_{n}": Placeholder(n)
    for space in ("", "boost::placeholders::", "std::placeholders::", "placeholders::")
    for n in range(1, 10)
}
CPP_STD_CLASSES = _classes()
CPP_STD_FUNCTIONS = _functions()
