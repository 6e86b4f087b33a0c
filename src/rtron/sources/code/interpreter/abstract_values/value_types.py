"""What a variable may hold while source is interpreted: known, partly known, or one of several.

A string may be known in part: `PartialText(("/", Unknown("~prefix"), "/scan"))`. `tainted` marks
what came out of the parameter server, so that an endpoint can say how its name became known.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from rtron.sources.code import ir
from rtron.sources.code.record import record

MAX_CHOICES = 24
MAX_FUNCTIONS = 128
"""How many a value may be of if all are functions: a message picks one of a table."""
MAX_PARTS = 24
MAX_LENGTH = 4096


@record(frozen=True, slots=True)
class Scalar:
    """A str, int, float, bool, bytes or None."""

    value: Any
    tainted: bool = False


@record(frozen=True, slots=True)
class Unknown:
    """A value that cannot be known, and what it is called in the source: `~prefix`, `argv[1]`."""

    label: str = "?"
    tainted: bool = False
    type: ir.TypeRef | None = None


@record(frozen=True, slots=True)
class PartialText:
    """A string of which parts are unknown."""

    parts: tuple[str | Unknown, ...]
    tainted: bool = False


@record(frozen=True, slots=True)
class Choice:
    """One of several values; which, is decided where nothing can be known."""

    options: tuple["Value", ...]


@dataclass(eq=False, slots=True)
class Instance:
    """An object: of a scanned class, or of a library's, whose `fields` its library model defines.

    `types` are its template arguments, `bindings` those of its bases by their class's name.
    """

    type: "ClassValue | LibraryClass"
    fields: dict[Any, "Value"] = field(default_factory=dict)
    types: tuple[ir.TypeRef, ...] = ()
    bindings: dict[str, tuple[ir.TypeRef, ...]] = field(default_factory=dict)


@dataclass(eq=False, slots=True)
class ListValue:
    """A list, tuple, set or C++ container; `open` says that it may hold more than `items`.

    `type` is what a C++ container was declared as.
    """

    fields: dict[Any, Any] = field(default_factory=dict)
    kind: str = "list"
    type: ir.TypeRef | None = None

    @property
    def items(self) -> tuple["Value", ...]:
        """The items, in order."""
        return self.fields.get("items", ())  # type: ignore[no-any-return]

    @property
    def open(self) -> bool:
        """Whether there may be items that are not known."""
        return bool(self.fields.get("open"))


@dataclass(eq=False, slots=True)
class MapValue:
    """A dict or std::map; keys are what `map_key` says, `OPEN` marks unknown further entries.

    `iterates_pairs` marks a map of C++, whose items are pairs; `default_factory` makes the value
    of a new key. `is_namespace` says that the entries are variables or members: `vars(owner)`.
    `type` is what a map of C++ was declared as.
    """

    fields: dict[Any, "Value"] = field(default_factory=dict)
    iterates_pairs: bool = False
    default_factory: Callable[[], "Value"] | None = None
    is_namespace: bool = False
    type: ir.TypeRef | None = None

    @property
    def entries(self) -> dict[Any, "Value"]:
        """The known entries."""
        return {key: value for key, value in self.fields.items() if key is not OPEN}

    @property
    def open(self) -> bool:
        """Whether there may be entries that are not known."""
        return OPEN in self.fields

    def key_of(self, key: "Value") -> Any:  # noqa: ANN401 - any key
        """Return the key that a value is here, or OPEN; C++ compares objects by what they hold.

        There an enumerator of a header that is not here is known by its name.
        """
        if self.iterates_pairs:
            named = key if isinstance(key, ExternalSymbol) else OPEN
            return key.value if isinstance(key, Scalar) else named
        return map_key(key)

    def missing_note(self, key: object) -> tuple[str, str] | None:  # noqa: ARG002 - for others
        """Return what to note, and why, if a key is read that is not there; None for nothing."""
        return None


class _OpenKey:
    """The key of a MapValue's unknown entries."""


OPEN = _OpenKey()


@dataclass(eq=False, slots=True)
class FunctionValue:
    """A scanned function, with the frame it was defined in and the object it is bound to.

    `bound_arguments` and `bound_keywords` are arguments that it already has (functools.partial,
    boost::bind).
    """

    function: ir.Function
    closure: Any = None
    owner: "Value | None" = None
    bound_arguments: tuple["Value", ...] = ()
    cls: "ClassValue | None" = None
    types: tuple[ir.TypeRef, ...] = ()
    overloads: tuple[ir.Function, ...] = ()
    bound_keywords: Mapping[str, "Value"] = field(default_factory=dict)

    def with_overload(self, function: ir.Function) -> "FunctionValue":
        """Return the same call of one of its overloads."""
        return FunctionValue(
            function,
            closure=self.closure,
            owner=self.owner,
            bound_arguments=self.bound_arguments,
            cls=self.cls,
            types=self.types,
            bound_keywords=self.bound_keywords,
        )


@record(frozen=True, slots=True)
class BindPlaceholder:
    """`_1`, `_2` in boost::bind."""

    position: int


@dataclass(eq=False, slots=True)
class ClassValue:
    """A scanned class: its bases, and what stands in its body."""

    definition: ir.Class
    bases: tuple["Value", ...] = ()
    fields: dict[Any, "Value"] = field(default_factory=dict)
    closure: Any = None

    @property
    def name(self) -> str:
        """The class's name as it is defined."""
        return self.definition.name

    @property
    def constructor(self) -> str:
        """The name of the constructors that the class has in C++."""
        return f"{self.name}::{self.name.rpartition('::')[2].partition('<')[0]}"


@dataclass(eq=False, slots=True)
class ModuleValue:
    """A Python module: what its body has defined."""

    name: str
    fields: dict[Any, "Value"] = field(default_factory=dict)
    file: str = ""


@record(frozen=True, slots=True)
class MessageType:
    """A message, service or action type: `std_msgs/String`."""

    name: str


@record(frozen=True, slots=True)
class LibraryFunction:
    """A function of a library that RTron knows; `owner` is what it is bound to."""

    name: str
    call: Callable[..., "Value"]
    owner: Any = None
    types: tuple[ir.TypeRef, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class LibraryClass:
    """A class of a library that RTron knows: how it is made and what its methods do.

    The library calls `virtual_callbacks` by itself, in order. `over_source`: before its own source.
    `takes_list` marks a container of C++: its constructor gets what stands in braces as one list.
    """

    name: str
    construct: Callable[..., "Value"] | None = None
    methods: dict[str, Callable[..., "Value"]] = field(default_factory=dict)
    virtual_callbacks: tuple[str, ...] = ()
    over_source: bool = True
    takes_list: bool = False


@record(frozen=True, slots=True)
class ExternalSymbol:
    """Something of a library without a model, by its dotted name."""

    name: str


Value: TypeAlias = (
    Scalar
    | Unknown
    | PartialText
    | Choice
    | Instance
    | ListValue
    | MapValue
    | FunctionValue
    | ClassValue
    | ModuleValue
    | MessageType
    | LibraryFunction
    | LibraryClass
    | ExternalSymbol
    | BindPlaceholder
)


def map_key(value: Value) -> Any:  # noqa: ANN401 - any key
    """Return the key that a value is in a dict; OPEN for one that is not known.

    It is a Scalar's value, a tuple of keys for a tuple, and an object, class or function itself.
    """
    if isinstance(value, Scalar):
        return value.value
    if isinstance(value, ListValue) and value.kind == "tuple" and not value.open:
        keys = tuple(map_key(item) for item in value.items)
        return OPEN if OPEN in keys else keys
    return value if isinstance(value, IDENTIFIED) else OPEN


IDENTIFIED = (Instance, ClassValue, MessageType, FunctionValue, LibraryFunction, LibraryClass)
"""What is a key of a dict by its identity."""
NONE = Scalar(None)
UNKNOWN = Unknown()
TRUE = Scalar(value=True)
FALSE = Scalar(value=False)


def options(value: "Value | None") -> tuple[Value, ...]:
    """Return what a value may be, one after the other."""
    if value is None:
        return ()
    return value.options if isinstance(value, Choice) else (value,)


def join(values: Iterable[Value]) -> Value:
    """Return the value that may be any of `values`; too many of them are an Unknown."""
    found: list[Value] = []
    for value in values:
        for option in options(value):
            if not _contains(option, found):
                found.append(option)
    if not found:
        return NONE
    if len(found) > MAX_CHOICES and not _are_functions(found):
        return Unknown("many")
    return found[0] if len(found) == 1 else Choice(tuple(found))


def _are_functions(found: list[Value]) -> bool:
    return len(found) <= MAX_FUNCTIONS and all(isinstance(one, FunctionValue) for one in found)


def _contains(value: Value, found: list[Value]) -> bool:
    for other in found:  # noqa: SIM110 - of each value there is: a generator takes twice as long
        if value is other or (type(value) is type(other) and value == other):
            return True
    return False


def map_options(value: Value, function: Callable[[Value], Value]) -> Value:
    """Return what `function` makes of each option."""
    if not isinstance(value, Choice):
        return function(value)
    return join([function(option) for option in value.options])


def is_text(value: Value) -> bool:
    """Tell whether a value is a string, known whole or in part."""
    return isinstance(value, PartialText) or (
        isinstance(value, Scalar) and isinstance(value.value, str)
    )


def is_tainted(value: Value) -> bool:
    """Tell whether a value came out of the parameter server, or has a part that did."""
    if isinstance(value, Choice):
        return any(map(is_tainted, value.options))
    return isinstance(value, (Scalar, Unknown, PartialText)) and value.tainted


def parts_of(value: Value) -> tuple[str | Unknown, ...]:
    """Return a value as the parts of a string."""
    if isinstance(value, Scalar):
        return (plain(value.value),)
    if isinstance(value, PartialText):
        return value.parts
    if isinstance(value, Unknown):
        return (value,)
    return (Unknown(value.name) if isinstance(value, ExternalSymbol) else UNKNOWN,)


def plain(value: object) -> str:
    """Return a value as str() shows it."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def concat(values: Iterable[Value]) -> Value:
    """Return the string that `values` make together, over every combination of options."""
    results: list[tuple[tuple[str | Unknown, ...], bool]] = [((), False)]
    for value in values:
        found = (
            (parts + parts_of(option), tainted or is_tainted(option))
            for parts, tainted in results
            for option in options(value)
        )
        results = list(dict.fromkeys(found))
        if len(results) > MAX_CHOICES:
            return Unknown("many")
    return join([_merge_parts(parts, tainted=tainted) for parts, tainted in results])


def _merge_parts(parts: tuple[str | Unknown, ...], *, tainted: bool) -> Value:
    if sum(len(part) for part in parts if isinstance(part, str)) > MAX_LENGTH:
        return Unknown("long", tainted)
    merged: list[str | Unknown] = []
    for part in parts:
        if isinstance(part, str) and merged and isinstance(merged[-1], str):
            merged[-1] += part
        elif part != "":
            merged.append(part)
    if len(merged) > MAX_PARTS:
        return Unknown("long", tainted)
    if all(isinstance(part, str) for part in merged):
        return Scalar("".join(map(str, merged)), tainted)
    return PartialText(tuple(merged), tainted)


def text_with_holes(value: Value) -> str:
    """Return a string value with its unknown parts in braces."""
    return "".join(
        part if isinstance(part, str) else f"{{{part.label}}}" for part in parts_of(value)
    )
