"""The standard library of C++, and boost and Qt in its place, as far as names depend on it."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Placeholder,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.cpp_std.algorithms import ALGORITHMS
from rtron.sources.code.library_models.cpp_std.command_line import COMMAND_LINE
from rtron.sources.code.library_models.cpp_std.containers import (
    call_make_pair,
    get_item,
    make_array,
    make_map,
    make_pair,
    make_vector,
)
from rtron.sources.code.library_models.cpp_std.functional import (
    bind,
    end_program,
    getenv,
    hidden,
    make_function,
    make_pointer,
    make_shared,
    make_thread,
    same,
    system,
)
from rtron.sources.code.library_models.cpp_std.strings import (
    FORMAT,
    STREAM,
    compare_texts,
    copy_text,
    getline,
    joined,
    lexical_cast,
    make_number,
    make_text,
    parsed,
    split,
    sprintf,
    text_of,
    to_string,
)

_NUMBERS: Mapping[str, object] = {
    **dict.fromkeys(
        ("int", "long", "short", "size_t", "unsigned", "uint32_t", "int32_t", "uint8_t"), 0
    ),
    **dict.fromkeys(("double", "float"), 0.0),
    "bool": False,
}


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


def _classes() -> dict[str, NativeClass]:
    classes = {name: NativeClass(name, partial(make_number, name)) for name in _NUMBERS}
    for name, make in _MAKERS.items():
        for space in ("", "std::", "boost::", "boost::unordered::"):
            classes[space + name] = NativeClass(space + name, make)
    for name in ("stringstream", "ostringstream", "istringstream"):
        classes["std::" + name] = classes[name] = STREAM
    for name in ("boost::format", "format"):
        classes[name] = FORMAT
    classes["QString"] = classes["char"] = NativeClass("QString", make_text)
    return classes


_MAKERS: Mapping[str, Callable[..., Value]] = {
    "string": make_text,
    **dict.fromkeys(
        ("vector", "list", "deque", "set", "unordered_set", "queue", "stack"), make_vector
    ),
    **dict.fromkeys(("map", "unordered_map", "multimap"), make_map),
    "array": make_array,
    "pair": make_pair,
    **dict.fromkeys(
        ("shared_ptr", "unique_ptr", "scoped_ptr", "auto_ptr", "weak_ptr"), make_pointer
    ),
    **dict.fromkeys(("thread", "async"), make_thread),
    "function": make_function,
}


_CALLS: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(("make_shared", "make_unique"), make_shared),
    **dict.fromkeys(
        ("move", "ref", "cref", "forward", "static_pointer_cast", "dynamic_pointer_cast"), same
    ),
    "make_pair": call_make_pair,
    "to_string": to_string,
    "lexical_cast": lexical_cast,
    "bind": bind,
    "mem_fn": same,
    "getline": getline,
    "stoi": partial(parsed, int),
    "stod": partial(parsed, float),
    **ALGORITHMS,
    "join": joined,
    "exit": end_program,
    "abort": end_program,
    "quick_exit": end_program,
    "make_tuple": lambda machine, _, arguments: listed(arguments.values, "tuple"),
    "get": get_item,
    "split": split,
    "is_any_of": same,
    "str": text_of,
    "async": lambda machine, _, arguments: make_thread(machine, arguments),
}


_HIDDEN = (
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
)
_PLAIN: Mapping[str, Callable[..., Value]] = {
    "bind": bind,
    "sprintf": partial(sprintf, 1),
    "snprintf": partial(sprintf, 2),
    "atoi": partial(parsed, int),
    "atof": partial(parsed, float),
    **dict.fromkeys(("exit", "_exit", "abort"), end_program),
    **dict.fromkeys(("strcpy", "std::strcpy", "strncpy"), copy_text),
    **dict.fromkeys(_HIDDEN, hidden),
    **COMMAND_LINE,
    **dict.fromkeys(("getenv", "std::getenv"), getenv),
    **dict.fromkeys(("system", "std::system", "popen"), system),
    "strcmp": compare_texts,
    "QString::fromStdString": same,
    "std::ref": same,
}


def _functions() -> dict[str, Native]:
    functions = {
        f"{space}{name}": Native(name, call)
        for name, call in _CALLS.items()
        for space in ("std::", "boost::", "boost::algorithm::", "boost::this_thread::")
    }
    return functions | {name: Native(name, call) for name, call in _PLAIN.items()}


CONSTANTS: Mapping[str, Value] = {"std::string::npos": Known(-1), "string::npos": Known(-1)}


PLACEHOLDERS = {
    f"{space}_{n}": Placeholder(n)
    for space in ("", "boost::placeholders::", "std::placeholders::", "placeholders::")
    for n in range(1, 10)
}


CPP_STD_CLASSES = _classes()


CPP_STD_FUNCTIONS = _functions()
