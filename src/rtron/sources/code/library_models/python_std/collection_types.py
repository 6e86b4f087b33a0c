"""Python's collections, itertools and functools."""

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import PARTIAL, AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.context_managers import SUPPRESS
from rtron.sources.code.interpreter.python.descriptors import DESCRIPTOR_FUNCTIONS
from rtron.sources.code.library_models.common.maps import keyword_fields
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.data_classes import ENUM
from rtron.sources.code.library_models.python_std.iteration import fold

MAX_ROWS = 256
_MAX_DEPTH = 8


def _default_dict(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`defaultdict(factory, …)`; a key that is not known makes an entry too."""
    factory = arguments.get(0) or av.NONE
    made = dispatch(machine, BUILTINS["dict"], arguments.without_first(1))
    if isinstance(made, av.MapValue) and factory != av.NONE:
        made.default_factory = lambda: dispatch(machine, factory, arguments.with_values())
    return made


def _named_tuple(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`namedtuple("Name", ["a", "b"])` or `namedtuple("Name", "a b")`."""
    given = arguments.value(1, "field_names")
    items = given.items if isinstance(given, av.ListValue) else (given,)
    names = " ".join(map(av.text_with_holes, items)).replace(",", " ").split()

    def fields(passed: Arguments) -> dict[str, av.Value]:
        return {name: passed.get(at, name) or av.Unknown(name) for at, name in enumerate(names)}

    def init(machine: AbstractMachine, owner: av.Instance, passed: Arguments) -> av.Value:
        for name, value in fields(passed).items():
            machine.undo_log.set(owner.fields, name, value)
        return av.NONE

    def make(_: AbstractMachine, passed: Arguments) -> av.Value:
        return av.Instance(made, dict(fields(passed)))

    made = av.LibraryClass(av.text_with_holes(arguments.value(0)), make, {"__init__": init})
    return made


def _chain(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    found = [machine.runtime.iterate(value) for value in arguments.values]
    items = tuple(item for items, _ in found for item in items)
    return av.list_of(items, certain=all(certain for _, certain in found))


def _chain_from_iterable(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    values, certain = av.items_of(arguments.value(0))
    passed = (*values, *(() if certain else (av.UNKNOWN,)))
    return _chain(machine, None, arguments.with_values(*passed))


def _product(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    times = arguments.keywords.get("repeat", av.Scalar(1))
    found = [av.items_of(value) for value in arguments.values]
    count = times.value if isinstance(times, av.Scalar) and times.value in range(1, 5) else 1
    rows = itertools.product(*(items for items, _ in found * count))
    return _tuples(rows, certain=all(certain for _, certain in found))


def _tuples(rows: Iterable[tuple[av.Value, ...]], *, certain: bool) -> av.Value:
    found = [av.list_of(row, "tuple") for row in itertools.islice(rows, MAX_ROWS + 1)]
    unsure = not certain or len(found) > MAX_ROWS
    return av.list_of(found[:MAX_ROWS], certain=not unsure)


def _partial(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    function, given = arguments.value(0), arguments.without_first(1)
    if isinstance(function, av.FunctionValue):
        named = {**function.bound_keywords, **given.keywords}
        return replace(
            function,
            bound_arguments=(*function.bound_arguments, *given.values),
            bound_keywords=named,
        )

    def call(machine: AbstractMachine, _: object, later: Arguments) -> av.Value:
        values, keywords = (*given.values, *later.values), {**given.keywords, **later.keywords}
        at = later if later.line else given
        passed = Arguments(values=values, keywords=keywords, line=at.line, frame=at.frame)
        return dispatch(machine, function, passed)

    return av.LibraryFunction(PARTIAL, call)


def copied(value: av.Value, depth: int) -> av.Value:
    """Return a list, dict or object as a new one, and what it holds, down to a depth."""
    if depth <= 0:
        return value
    if isinstance(value, av.ListValue):
        items = tuple(copied(item, depth - 1) for item in value.items)
        return av.list_of(items, value.kind, certain=not value.open)
    if isinstance(value, (av.MapValue, av.Instance)):
        fields = {key: copied(entry, depth - 1) for key, entry in value.fields.items()}
        return replace(value, fields=fields)
    return value


def _dict_from_keys(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`dict.fromkeys(keys, value)`."""
    items, certain = machine.runtime.iterate(arguments.value(0))
    value = arguments.get(1) or av.NONE
    made: dict[Any, av.Value] = {av.map_key(item): value for item in items}
    return av.MapValue(made if certain else {**made, av.OPEN: value})


_QUEUES = (
    *("queue.Queue", "queue.SimpleQueue", "Queue.Queue"),
    *("multiprocessing.Queue", "asyncio.Queue"),
)
_NAMESPACE = av.LibraryClass("types.SimpleNamespace")


def _wraps(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    """`@wraps(function)` leaves what it decorates as it is."""
    return av.LibraryFunction(
        "wraps", lambda machine, owner, arguments: arguments.get(0) or av.NONE
    )


def _array(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`numpy.array(values)`."""
    given = arguments.get(0, "object") or av.NONE
    if not isinstance(given, av.ListValue):
        return av.Unknown("array")
    return av.list_of(given.items, av.ARRAY, certain=not given.open)


_CALLS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(("numpy.array", "numpy.asarray"), _array),
    "collections.defaultdict": _default_dict,
    "collections.namedtuple": _named_tuple,
    **dict.fromkeys(("functools.partial", "functools.partialmethod"), _partial),
    "dict.fromkeys": _dict_from_keys,
    "types.MappingProxyType": return_argument,
    "functools.wraps": _wraps,
    "functools.reduce": lambda machine, _, arguments: fold(machine, arguments),
    **dict.fromkeys(_QUEUES, lambda *_: av.list_of((), "queue")),
    "copy.copy": lambda _, __, arguments: copied(arguments.get(0) or av.NONE, 1),
    "copy.deepcopy": lambda _, __, arguments: copied(arguments.get(0) or av.NONE, _MAX_DEPTH),
    "types.SimpleNamespace": lambda _, __, arguments: av.Instance(
        _NAMESPACE, keyword_fields(arguments)
    ),
    "contextlib.suppress": lambda _, __, arguments: av.Instance(
        SUPPRESS, {"names": av.list_of(arguments.values)}
    ),
    **dict.fromkeys(("contextlib.closing", "contextlib.nullcontext"), return_argument),
    "itertools.chain": _chain,
    "itertools.chain.from_iterable": _chain_from_iterable,
    "itertools.product": _product,
}
PYTHON_COLLECTIONS: Mapping[str, av.Value] = {
    **{name: av.LibraryFunction(name, call) for name, call in _CALLS.items()},
    "collections.OrderedDict": BUILTINS["dict"],
    "collections.deque": BUILTINS["list"],
    **{
        name: DESCRIPTOR_FUNCTIONS[name]
        for name in ("functools.cached_property", "abc.abstractproperty")
    },
    "itertools.izip": BUILTINS["zip"],
    "itertools.imap": BUILTINS["map"],
    "enum.Enum": ENUM,
    "enum.IntEnum": ENUM,
}
