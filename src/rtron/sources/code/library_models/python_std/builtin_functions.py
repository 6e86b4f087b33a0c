"""Python's built-in functions, as far as names of topics depend on them."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.elements import SLICE
from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.operators import binary
from rtron.sources.code.interpreter.abstract_values.shown_text import repr_of
from rtron.sources.code.interpreter.abstract_values.truth import truth
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    UNKNOWN,
    ClassValue,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    MapValue,
    ModuleValue,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    map_options,
    options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import assign_member, forget_texts
from rtron.sources.code.interpreter.execution.calls import dispatch, truth_of
from rtron.sources.code.interpreter.execution.language_runtime import python_runtime
from rtron.sources.code.interpreter.python.descriptors import DESCRIPTOR_FUNCTIONS
from rtron.sources.code.interpreter.python.method_resolution_order import super_object
from rtron.sources.code.ir import Class
from rtron.sources.code.library_models.common.maps import dict_of, keyword_fields
from rtron.sources.code.library_models.common.strings import apply_format_spec
from rtron.sources.code.library_models.python_std.dynamic_code import (
    DYNAMIC_CODE_BUILTINS,
    get_member,
)
from rtron.sources.code.library_models.python_std.iteration import ITERATION_FUNCTIONS

MAX_RANGE = 256


def _str(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    return concat((machine.runtime.shown(arguments.get(0) or Scalar("")),))


def _repr(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    return concat((repr_of(arguments.get(0) or NONE),))


def _number(
    make: Callable[..., object], _: AbstractMachine, __: object, arguments: Arguments
) -> Value:
    """`int(text, base)`, `round(number, digits)` and the like."""
    rest = [value.value for value in arguments.values[1:] if isinstance(value, Scalar)]
    is_known = len(rest) == len(arguments.values[1:])

    def made(value: Value) -> Value:
        if not isinstance(value, Scalar):
            return value
        try:
            return (
                Scalar(make(value.value, *rest), value.tainted) if is_known else Unknown("number")
            )
        except (TypeError, ValueError, OverflowError):
            return Unknown("number")

    return map_options(arguments.get(0) or Scalar(0), made)


def _power(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    return binary("**", arguments.value(0), arguments.value(1))


def _divide(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`divmod(number, other)`."""
    return list_of(
        [binary(n, arguments.value(0), arguments.value(1)) for n in ("//", "%")], "tuple"
    )


def _bool(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    value = arguments.get(0) or FALSE
    decided = truth_of(machine, value)
    return Unknown("bool") if decided is None else Scalar(decided, is_tainted(value))


def _len(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    method = machine.runtime.special_method(arguments.value(0), "__len__")
    if method is not None:
        return dispatch(machine, method, arguments.with_values())
    items, certain = items_of(arguments.value(0))
    return Scalar(len(items)) if certain else Unknown("len")


def _range(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    numbers = [
        v.value for v in arguments.values if isinstance(v, Scalar) and isinstance(v.value, int)
    ]
    if len(numbers) != len(arguments.values) or not 1 <= len(numbers) <= 3:  # noqa: PLR2004
        return Unknown("range")
    try:
        found = range(*numbers)
    except ValueError:
        return Unknown("range")
    return list_of(map(Scalar, found[:MAX_RANGE]), certain=len(found) <= MAX_RANGE)


def _open(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    return Instance(FILE, {"path": arguments.get(0, "file") or Unknown("path")})


def _slice(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    values = arguments.values if len(arguments.values) > 1 else (NONE, *arguments.values)
    return Instance(
        SLICE, dict(zip(("start", "stop", "step"), (*values, NONE, NONE), strict=False))
    )


def _dict(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    given = arguments.get(0)
    made = dict_of(given) if given is not None else MapValue()
    made.fields.update(keyword_fields(arguments))
    return made


def _isinstance(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    value, expected_class = arguments.get(0), arguments.get(1)
    if isinstance(expected_class, ListValue) and not expected_class.open:
        given = value or NONE
        calls = [arguments.with_values(given, one) for one in expected_class.items]
        found = [_isinstance(machine, None, call) for call in calls]
        answers = [truth(one) for one in found]
        return TRUE if True in answers else Unknown("isinstance") if None in answers else FALSE
    if isinstance(value, Instance) and isinstance(expected_class, ClassValue):
        return Scalar(any(cls is expected_class for cls in machine.runtime.lineage(value.type)))
    kinds = {"list": "list", "tuple": "tuple", "set": "set"}
    if isinstance(value, ListValue) and isinstance(expected_class, LibraryFunction):
        return Scalar(kinds.get(expected_class.name) == value.kind)
    if isinstance(value, MapValue) and isinstance(expected_class, LibraryFunction):
        return Scalar(expected_class.name == "dict")
    if isinstance(value, Scalar) and isinstance(expected_class, LibraryFunction):
        names = {"unicode": "str", "basestring": "str", "long": "int", "Path": "PathString"}
        own = {type(value.value).__name__, *({"int"} if value.value in {True, False} else ())}
        return Scalar(names.get(expected_class.name, expected_class.name) in own)
    return Unknown("isinstance")


def _getattr(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.value(0), arguments.get(1)
    if not isinstance(name, Scalar):
        return get_member(machine, owner, name or NONE, arguments)
    found = machine.runtime.attribute(owner, str(name.value), ())
    return found or arguments.get(2) or Unknown(str(name.value))


def _setattr(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`setattr(owner, name, value)`; under a name that is not known, any text may be replaced."""
    value = arguments.get(2) or NONE
    for name in options(arguments.get(1)):
        for owner in options(arguments.get(0)):
            if isinstance(name, Scalar):
                assign_member(machine, owner, str(name.value), value, arguments)
            elif isinstance(owner, (Instance, ClassValue, ModuleValue)):
                forget_texts(machine, owner.fields)
    return NONE


def _hasattr(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    owner, name = arguments.get(0), arguments.get(1)
    if isinstance(owner, (Instance, ClassValue)) and isinstance(name, Scalar):
        return Scalar(machine.runtime.attribute(owner, str(name.value), ()) is not None)
    if isinstance(owner, Scalar) and isinstance(name, Scalar):
        return Scalar(hasattr(owner.value, str(name.value)))
    return Unknown("hasattr")


def _super(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`super()`, `super(Class, self)`: the object, as the classes behind see it."""
    cls, owner = arguments.get(0), arguments.get(1)
    frame = arguments.frame
    if owner is None and frame.function is not None and frame.function.params:
        owner, cls = frame.variables.get(frame.function.params[0].name), frame.cls
    if not isinstance(owner, (Instance, ClassValue)) or not isinstance(cls, ClassValue):
        return Unknown("super")
    order = tuple(machine.runtime.lineage(owner.type if isinstance(owner, Instance) else owner))
    return super_object(owner, cls, order if cls in order else tuple(machine.runtime.lineage(cls)))


def _type(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`type(value)`, or `type("Name", bases, members)`, which makes a class."""
    value, members = arguments.get(0), arguments.get(2)
    if isinstance(members, MapValue):
        name = text_with_holes(value or UNKNOWN)
        definition = Class(name=name, file=arguments.frame.file, line=arguments.line)
        runtime = python_runtime(machine)
        bases = runtime.base_classes(items_of(arguments.get(1) or NONE)[0])
        return runtime.finish_class(ClassValue(definition, bases, members.entries), arguments.frame)
    if isinstance(value, Instance):
        return value.type
    kind = "dict" if isinstance(value, MapValue) else getattr(value, "kind", "")
    plain = type(value.value).__name__ if isinstance(value, Scalar) else kind
    return BUILTINS.get(plain, Unknown("type"))


def _format(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`format(value, "02d")`."""
    given = arguments.get(1) or Scalar("")
    spec = given.value if isinstance(given, Scalar) else None
    value = machine.runtime.shown(arguments.value(0))
    if not isinstance(spec, str):
        return Unknown("format")
    return map_options(value, lambda one: apply_format_spec(one, spec))


def _callable(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    value = arguments.value(0)
    if isinstance(value, (Scalar, ListValue, MapValue)):
        return FALSE
    is_function = isinstance(value, (FunctionValue, LibraryFunction, ClassValue, LibraryClass))
    return TRUE if is_function else Unknown("callable")


def _exit(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    raise ThrownError("SystemExit")


def _return_unknown(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    machine.escape_arguments(arguments)
    return Unknown(name)


_BUILTIN_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    **ITERATION_FUNCTIONS,
    "str": _str,
    "unicode": _str,
    "repr": _repr,
    "int": partial(_number, int),
    "long": partial(_number, int),
    "float": partial(_number, float),
    "abs": partial(_number, abs),
    "pow": _power,
    "divmod": _divide,
    "round": partial(_number, round),
    "bool": _bool,
    "len": _len,
    "range": _range,
    "xrange": _range,
    "open": _open,
    "slice": _slice,
    "dict": _dict,
    "isinstance": _isinstance,
    "getattr": _getattr,
    "setattr": _setattr,
    "hasattr": _hasattr,
    "super": _super,
    "type": _type,
    "format": _format,
    "callable": _callable,
    "chr": partial(_number, chr),
    "ord": partial(_number, ord),
    **dict.fromkeys(("exit", "quit"), _exit),
    **{name: partial(_return_unknown, name) for name in ("input", "raw_input", "id", "print")},
}
FILE = LibraryClass("file")
BUILTINS: Mapping[str, Value] = {
    "True": TRUE,
    "False": FALSE,
    "None": NONE,
    "basestring": LibraryFunction("str", _str),
    "object": ExternalSymbol("object"),
    **{n: DESCRIPTOR_FUNCTIONS[n] for n in ("property", "staticmethod", "classmethod")},
    **{name: LibraryFunction(name, call) for name, call in _BUILTIN_FUNCTIONS.items()},
    **DYNAMIC_CODE_BUILTINS,
}
