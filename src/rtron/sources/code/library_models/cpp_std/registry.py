"""The standard library of C++, and boost and Qt instead of it, as far as names depend on it."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.cpp_std import containers, functional, strings
from rtron.sources.code.library_models.cpp_std.algorithms import ALGORITHMS
from rtron.sources.code.library_models.cpp_std.strings import FILE, make_buffer_iterator

_OPTION = 2


def _words_from_option(arguments: Arguments) -> list[str] | None:
    """Return the command line from the option on; None where one of the two is not known."""
    words, certain = av.items_of(arguments.get(0) or av.NONE)
    option = arguments.get(_OPTION)
    texts = [str(word.value) for word in words if isinstance(word, av.Scalar)]
    if not certain or len(texts) < len(words) or not isinstance(option, av.Scalar):
        return None
    name = str(option.value)
    return texts[texts.index(name) :] if name in texts else []


def _option_exists(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`rcutils_cli_option_exist(argv, argv + argc, option)`."""
    words = _words_from_option(arguments)
    return av.Unknown("rcutils_cli_option_exist()") if words is None else av.Scalar(bool(words))


def _option_value(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`rcutils_cli_get_option(argv, argv + argc, option)`: the word behind it, or a null."""
    words = _words_from_option(arguments)
    if words is None:
        return av.Unknown("rcutils_cli_get_option()")
    return av.Scalar(words[1]) if words[1:] else av.NONE


COMMAND_LINE: Mapping[str, Callable[..., av.Value]] = {
    "rcutils_cli_option_exist": _option_exists,
    "rcutils_cli_get_option": _option_value,
}

_NUMBER_DEFAULTS: Mapping[str, object] = {
    **dict.fromkeys(
        ("int", "long", "short", "size_t", "unsigned", "uint32_t", "int32_t", "uint8_t"), 0
    ),
    **dict.fromkeys(("double", "float"), 0.0),
    "bool": False,
}

PARAMETER_TYPE_PREFIX = "XmlRpc::XmlRpcValue::Type"


def parameter_type_of(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    """`XmlRpcValue::getType()`: the part behind `Type` of its name (XmlRpcValue.h)."""
    if isinstance(owner, av.ListValue):
        return av.Scalar("Array")
    if isinstance(owner, av.MapValue):
        return av.Scalar("Struct")
    if not isinstance(owner, av.Scalar):
        return av.Unknown("getType")
    kinds = {bool: "Boolean", int: "Int", float: "Double", str: "String"}
    return av.Scalar(kinds.get(type(owner.value), "Invalid"))


def _classes() -> dict[str, av.LibraryClass]:
    classes = {
        name: av.LibraryClass(name, partial(strings.make_number_value, name))
        for name in _NUMBER_DEFAULTS
    }
    for name, make in _CONSTRUCTORS.items():
        for space in ("", "std::", "boost::", "boost::unordered::"):
            takes_list = make in _LIST_MAKERS
            classes[space + name] = av.LibraryClass(space + name, make, takes_list=takes_list)
    for name in ("stringstream", "ostringstream", "istringstream"):
        classes["std::" + name] = classes[name] = strings.STREAM
    classes["std::ifstream"] = classes["ifstream"] = FILE
    for name in ("boost::format", "format"):
        classes[name] = strings.FORMAT
    classes["QString"] = classes["char"] = av.LibraryClass("QString", strings.make_string)
    return classes


_CONSTRUCTORS: Mapping[str, Callable[..., av.Value]] = {
    "string": strings.make_string,
    **dict.fromkeys(
        (
            *("vector", "list", "deque", "set", "unordered_set", "stack"),
            *("multiset", "forward_list", "initializer_list"),
        ),
        containers.make_vector,
    ),
    **dict.fromkeys(("map", "unordered_map"), containers.make_map),
    **dict.fromkeys(("multimap", "unordered_multimap"), containers.make_multimap),
    "array": containers.make_array,
    "queue": containers.make_queue,
    **dict.fromkeys(("optional", "variant", "any"), functional.make_holder),
    **dict.fromkeys(("reference_wrapper", "string_view"), functional.make_pointer),
    "tuple": containers.make_tuple,
    "pair": containers.make_pair,
    "istreambuf_iterator": make_buffer_iterator,
    **dict.fromkeys(
        ("shared_ptr", "unique_ptr", "scoped_ptr", "auto_ptr", "weak_ptr"), functional.make_pointer
    ),
    **dict.fromkeys(("thread", "async"), functional.make_thread),
    "function": functional.make_function,
}

_LIST_MAKERS = {
    containers.make_vector,
    containers.make_map,
    containers.make_multimap,
    containers.make_array,
    containers.make_queue,
}

_STD_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(("make_shared", "make_unique"), functional.make_shared),
    **dict.fromkeys(
        (
            *("move", "ref", "cref", "forward", "static_pointer_cast", "dynamic_pointer_cast"),
            *("back_inserter", "front_inserter", "inserter", "as_const", "addressof"),
        ),
        return_argument,
    ),
    "make_pair": containers.make_pair_function,
    "to_string": strings.to_string,
    "lexical_cast": strings.lexical_cast,
    **dict.fromkeys(("bind", "bind_front"), functional.bind),
    "mem_fn": return_argument,
    "getline": strings.getline,
    "stoi": partial(strings.parse_number, int),
    "stod": partial(strings.parse_number, float),
    **ALGORITHMS,
    **strings.BOOST_STRINGS,
    "exit": functional.end_program,
    "abort": functional.end_program,
    "quick_exit": functional.end_program,
    **dict.fromkeys(
        ("make_tuple", "tie", "forward_as_tuple"),
        lambda machine, _, arguments: containers.make_tuple(machine, arguments),
    ),
    **dict.fromkeys(("make_optional", "make_any"), functional.make_held),
    "max": partial(strings.choose_number, max),
    "min": partial(strings.choose_number, min),
    "exchange": functional.exchange,
    "swap": functional.swap,
    "get": containers.get_tuple_item,
    "is_any_of": return_argument,
    "str": strings.stream_text,
    "async": functional.run_async,
}

_HIDDEN_CODE_FUNCTIONS = (
    *("dlopen", "execl", "execlp", "execle", "execv", "execvp", "execve", "posix_spawn"),
    *("ros::master::execute", "ros::TopicManager::instance", "ros::ServiceManager::instance"),
    *(f"pybind11::{name}" for name in ("exec", "eval", "eval_file")),
    *("pybind11::module::import", "pybind11::module_::import"),
)
_GLOBAL_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "bind": functional.bind,
    "sprintf": partial(strings.sprintf, 1),
    "snprintf": partial(strings.sprintf, 2),
    "atoi": partial(strings.parse_number, int),
    "atof": partial(strings.parse_number, float),
    **dict.fromkeys(("exit", "_exit", "abort"), functional.end_program),
    **strings.CHARACTER_FUNCTIONS,
    **dict.fromkeys(("strcpy", "std::strcpy", "strncpy"), strings.copy_string),
    **dict.fromkeys(_HIDDEN_CODE_FUNCTIONS, functional.note_hidden_code),
    **COMMAND_LINE,
    **dict.fromkeys(("getenv", "std::getenv"), functional.getenv),
    **dict.fromkeys(("system", "std::system", "popen"), functional.run_system),
    **dict.fromkeys(("std::format", "fmt::format"), strings.format_fields),
    **dict.fromkeys(("FMT_STRING", "FMT_COMPILE"), return_argument),
    "QString::fromStdString": return_argument,
    "std::ref": return_argument,
}


def _functions() -> dict[str, av.LibraryFunction]:
    functions = {
        f"{space}{name}": av.LibraryFunction(name, call)
        for name, call in _STD_FUNCTIONS.items()
        for space in ("std::", "boost::", "boost::algorithm::", "boost::this_thread::")
    }
    return functions | {
        name: av.LibraryFunction(name, call) for name, call in _GLOBAL_FUNCTIONS.items()
    }


CONSTANTS: Mapping[str, av.Value] = {
    "std::string::npos": av.Scalar(-1),
    "string::npos": av.Scalar(-1),
    "std::nullopt": av.NONE,
}

PLACEHOLDERS = {
    f"{space}_{n}": av.BindPlaceholder(n)
    for space in ("", "boost::placeholders::", "std::placeholders::", "placeholders::")
    for n in range(1, 10)
}

CPP_STD_CLASSES = _classes()

CPP_STD_FUNCTIONS = _functions()
