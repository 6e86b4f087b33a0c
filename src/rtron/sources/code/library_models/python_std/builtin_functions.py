"""Python's built-in functions, as far as names of topics depend on them."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import assign_member, forget_texts
from rtron.sources.code.interpreter.execution.calls import dispatch, truth_of
from rtron.sources.code.interpreter.execution.language_runtime import python_runtime
from rtron.sources.code.interpreter.python.descriptors import DESCRIPTOR_FUNCTIONS
from rtron.sources.code.interpreter.python.method_resolution_order import super_object
from rtron.sources.code.ir import Class
from rtron.sources.code.library_models.common.maps import dict_of, keyword_fields
from rtron.sources.code.library_models.python_std.dynamic_code import (
    DYNAMIC_CODE_BUILTINS,
    get_member,
)
from rtron.sources.code.library_models.python_std.list_methods import ITERATION_FUNCTIONS

MAX_RANGE = 256
FILE = av.LibraryClass("file")


def _str(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    return av.concat((machine.runtime.shown(arguments.get(0) or av.Scalar("")),))


def _number(
    make: Callable[..., object], _: AbstractMachine, __: object, arguments: Arguments
) -> av.Value:
    """`int(text, base)`, `round(number, digits)` and the like."""
    rest = [value.value for value in arguments.values[1:] if isinstance(value, av.Scalar)]
    is_known = len(rest) == len(arguments.values[1:])

    def made(value: av.Value) -> av.Value:
        if not isinstance(value, av.Scalar):
            return value
        if not is_known:
            return av.Unknown("number")
        try:
            return av.Scalar(make(value.value, *rest), value.tainted)
        except (TypeError, ValueError, OverflowError):
            return av.Unknown("number")

    return av.map_options(arguments.get(0) or av.Scalar(0), made)


def _bool(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    value = arguments.get(0) or av.FALSE
    decided = truth_of(machine, value)
    return av.Unknown("bool") if decided is None else av.Scalar(decided, av.is_tainted(value))


def _len(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    method = machine.runtime.special_method(arguments.value(0), "__len__")
    if method is not None:
        return dispatch(machine, method, arguments.with_values())
    items, certain = av.items_of(arguments.value(0))
    return av.Scalar(len(items)) if certain else av.Unknown("len")


def _range(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    numbers = [
        v.value for v in arguments.values if isinstance(v, av.Scalar) and isinstance(v.value, int)
    ]
    if len(numbers) != len(arguments.values) or not 1 <= len(numbers) <= 3:  # noqa: PLR2004
        return av.Unknown("range")
    try:
        found = range(*numbers)
    except ValueError:
        return av.Unknown("range")
    return av.list_of(map(av.Scalar, found[:MAX_RANGE]), certain=len(found) <= MAX_RANGE)


def _slice(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    values = arguments.values if len(arguments.values) > 1 else (av.NONE, *arguments.values)
    return av.Instance(
        av.SLICE, dict(zip(("start", "stop", "step"), (*values, av.NONE, av.NONE), strict=False))
    )


def _dict(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    given = arguments.get(0)
    made = dict_of(given) if given is not None else av.MapValue()
    made.fields.update(keyword_fields(arguments))
    return made


def _isinstance(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    value, expected_class = arguments.get(0), arguments.get(1)
    if isinstance(expected_class, av.ListValue) and not expected_class.open:
        given = value or av.NONE
        calls = [arguments.with_values(given, one) for one in expected_class.items]
        found = [_isinstance(machine, None, call) for call in calls]
        answers = [av.truth(one) for one in found]
        unsure = None in answers
        return av.TRUE if True in answers else av.Unknown("isinstance") if unsure else av.FALSE
    if isinstance(value, av.Instance) and isinstance(expected_class, av.ClassValue):
        return av.Scalar(any(cls is expected_class for cls in machine.runtime.lineage(value.type)))
    kinds = {"list": "list", "tuple": "tuple", "set": "set"}
    if isinstance(value, av.ListValue) and isinstance(expected_class, av.LibraryFunction):
        return av.Scalar(kinds.get(expected_class.name) == value.kind)
    if isinstance(value, av.MapValue) and isinstance(expected_class, av.LibraryFunction):
        return av.Scalar(expected_class.name == "dict")
    if isinstance(value, av.Scalar) and isinstance(expected_class, av.LibraryFunction):
        names = {"unicode": "str", "basestring": "str", "long": "int", "Path": "PathString"}
        own = {type(value.value).__name__, *({"int"} if value.value in {True, False} else ())}
        return av.Scalar(names.get(expected_class.name, expected_class.name) in own)
    return av.Unknown("isinstance")


def _getattr(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    owner, name = arguments.value(0), arguments.get(1)
    if not isinstance(name, av.Scalar):
        return get_member(machine, owner, name or av.NONE, arguments)
    found = machine.runtime.attribute(owner, str(name.value), ())
    return found or arguments.get(2) or av.Unknown(str(name.value))


def _setattr(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`setattr(owner, name, value)`; under a name that is not known, any text may be replaced."""
    value = arguments.get(2) or av.NONE
    for name in av.options(arguments.get(1)):
        for owner in av.options(arguments.get(0)):
            if isinstance(name, av.Scalar):
                assign_member(machine, owner, str(name.value), value, arguments)
            elif isinstance(owner, (av.Instance, av.ClassValue, av.ModuleValue)):
                forget_texts(machine, owner.fields)
    return av.NONE


def _hasattr(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    owner, name = arguments.get(0), arguments.get(1)
    if isinstance(owner, (av.Instance, av.ClassValue)) and isinstance(name, av.Scalar):
        return av.Scalar(machine.runtime.attribute(owner, str(name.value), ()) is not None)
    if isinstance(owner, av.Scalar) and isinstance(name, av.Scalar):
        return av.Scalar(hasattr(owner.value, str(name.value)))
    return av.Unknown("hasattr")


def _super(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`super()`, `super(Class, self)`: the object, as the classes behind see it."""
    cls, owner = arguments.get(0), arguments.get(1)
    frame = arguments.frame
    if owner is None and frame.function is not None and frame.function.params:
        owner, cls = frame.variables.get(frame.function.params[0].name), frame.cls
    if not isinstance(owner, (av.Instance, av.ClassValue)) or not isinstance(cls, av.ClassValue):
        return av.Unknown("super")
    order = tuple(machine.runtime.lineage(owner.type if isinstance(owner, av.Instance) else owner))
    return super_object(owner, cls, order if cls in order else tuple(machine.runtime.lineage(cls)))


def _type(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`type(value)`, or `type("Name", bases, members)`, which makes a class."""
    value, members = arguments.get(0), arguments.get(2)
    if isinstance(members, av.MapValue):
        name = av.text_with_holes(value or av.UNKNOWN)
        definition = Class(name=name, file=arguments.frame.file, line=arguments.line)
        runtime = python_runtime(machine)
        bases = runtime.base_classes(av.items_of(arguments.get(1) or av.NONE)[0])
        return runtime.finish_class(
            av.ClassValue(definition, bases, members.entries), arguments.frame
        )
    if isinstance(value, av.Instance):
        return value.type
    kind = "dict" if isinstance(value, av.MapValue) else getattr(value, "kind", "")
    plain = type(value.value).__name__ if isinstance(value, av.Scalar) else kind
    return BUILTINS.get(plain, av.Unknown("type"))


def _callable(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    value = arguments.value(0)
    if isinstance(value, (av.Scalar, av.ListValue, av.MapValue)):
        return av.FALSE
    is_function = isinstance(
        value, (av.FunctionValue, av.LibraryFunction, av.ClassValue, av.LibraryClass)
    )
    return av.TRUE if is_function else av.Unknown("callable")


def _exit(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    raise ThrownError("SystemExit")


def _unknown(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    machine.escape_arguments(arguments)
    return av.Unknown(name)


_BUILTIN_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    **ITERATION_FUNCTIONS,
    **DYNAMIC_CODE_BUILTINS,
    **dict.fromkeys(("str", "unicode"), _str),
    "repr": lambda _, __, arguments: av.concat((av.repr_of(arguments.get(0) or av.NONE),)),
    "long": partial(_number, int),
    **{make.__name__: partial(_number, make) for make in (int, float, abs, round, chr, ord)},
    "pow": lambda _, __, arguments: av.binary("**", arguments.value(0), arguments.value(1)),
    "bool": _bool,
    "len": _len,
    **dict.fromkeys(("range", "xrange"), _range),
    "open": lambda _, __, arguments: av.Instance(
        FILE, {"path": arguments.get(0, "file") or av.Unknown("path")}
    ),
    "slice": _slice,
    "dict": _dict,
    "isinstance": _isinstance,
    "getattr": _getattr,
    "setattr": _setattr,
    "hasattr": _hasattr,
    "super": _super,
    "type": _type,
    "callable": _callable,
    **dict.fromkeys(("exit", "quit"), _exit),
    **{name: partial(_unknown, name) for name in ("input", "raw_input", "id", "print")},
}
BUILTINS: Mapping[str, av.Value] = {
    "True": av.TRUE,
    "False": av.FALSE,
    "None": av.NONE,
    "basestring": av.LibraryFunction("str", _str),
    "object": av.ExternalSymbol("object"),
    **{n: DESCRIPTOR_FUNCTIONS[n] for n in ("property", "staticmethod", "classmethod")},
    **{name: av.LibraryFunction(name, call) for name, call in _BUILTIN_FUNCTIONS.items()},
}
