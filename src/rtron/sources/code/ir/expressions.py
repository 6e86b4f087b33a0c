"""The expressions of the intermediate representation: what has a value."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeAlias

from rtron.sources.code.record import record

if TYPE_CHECKING:
    from rtron.sources.code.ir.declarations import Function
    from rtron.sources.code.ir.statements import Declare


@record(frozen=True, slots=True)
class TypeRef:
    """A type as it is written, without const, & and *: `boost::shared_ptr<std_msgs::String>`.

    A template argument that is a value stands as its text in `name`.
    """

    name: str
    args: tuple["TypeRef", ...] = ()

    def __str__(self) -> str:
        return f"{self.name}<{', '.join(map(str, self.args))}>" if self.args else self.name


def adapter_alias(custom: str) -> str:
    """Return the alias that stands for the message which a type of the program is sent as."""
    return f"rclcpp::ImplicitTypeAdapter<{custom.removeprefix('::')}>"


def alias_parameter(position: int) -> str:
    """Return the name that stands in an alias template for its parameter at a position."""
    return f"<{position}>"


def substituted(type: TypeRef, bindings: Mapping[str, TypeRef]) -> TypeRef:
    """Return a type with each name in it replaced that is bound, in its arguments as well."""
    args = tuple(substituted(arg, bindings) for arg in type.args)
    bound = bindings.get(type.name)
    return TypeRef(type.name, args) if bound is None else TypeRef(bound.name, bound.args or args)


@record(frozen=True, slots=True)
class Const:
    """A str, int, float, bool, bytes or None (`nullptr`, `NULL`)."""

    value: str | int | float | bool | bytes | None


@record(frozen=True, slots=True)
class Name:
    """A variable, function, class, module or namespace member; `this` and `self` are names too.

    `types` are the template arguments written behind it: `make_shared<Foo>`.
    """

    id: str
    types: tuple[TypeRef, ...] = ()


@record(frozen=True, slots=True)
class Attr:
    """A member: `owner.name`, `owner->name`; `*p` and `&x` are lowered to `p` and `x` themselves.

    A call of a base class's method, `Base::run()` in C++, is the Name `Base::run`.
    """

    owner: "Expr"
    name: str
    types: tuple[TypeRef, ...] = ()


@record(frozen=True, slots=True)
class Index:
    """An element: `owner[key]`; a slice is an Opaque key."""

    owner: "Expr"
    key: "Expr"


@record(frozen=True, slots=True)
class Call:
    """A call; `keywords` holds Python's named arguments, a name of "**" spreads a mapping.

    A spread positional argument is a Star. `Foo(x)` in C++ is a Call of a Name as well: whether
    Foo is a class is known to the interpreter only. `addresses` are the positions of `&x`.
    """

    function: "Expr"
    args: tuple["Expr", ...] = ()
    keywords: tuple[tuple[str, "Expr"], ...] = ()
    line: int = 0
    addresses: tuple[int, ...] = ()


@record(frozen=True, slots=True)
class New:
    """C++: a value of a type is made: `new T(args)`, `T{args}`, or by a Declare's initialiser.

    `braced` marks `T{args}`, where a list of the arguments is what a constructor gets first.
    """

    type: TypeRef
    args: tuple["Expr", ...] = ()
    line: int = 0
    braced: bool = False


@record(frozen=True, slots=True)
class Binary:
    """`left operator right`, the operator spelled as in Python; C++ `<<` stays `<<`.

    Operators: + - * / // % ** @ << >> & | ^ == != < <= > >= is, is not, in, not in.
    """

    operator: str
    left: "Expr"
    right: "Expr"
    line: int = 0


@record(frozen=True, slots=True)
class Unary:
    """`not x`, `-x`, `+x`, `~x`."""

    operator: str
    operand: "Expr"


@record(frozen=True, slots=True)
class Logic:
    """`and`/`or` (C++ `&&`, `||`) of two or more operands, evaluated until decided."""

    operator: str
    operands: tuple["Expr", ...]


@record(frozen=True, slots=True)
class Conditional:
    """`body if test else orelse`, `test ? body : orelse`."""

    test: "Expr"
    body: "Expr"
    orelse: "Expr"


@record(frozen=True, slots=True)
class Concat:
    """The parts of an f-string, each made a string and put together."""

    parts: tuple["Expr", ...]


BRACES = "braces"


@record(frozen=True, slots=True)
class SequenceExpr:
    """A list, tuple or set that is written out, or `{a, b}` of C++ without a type (`BRACES`)."""

    items: tuple["Expr", ...]
    kind: str = "list"


@record(frozen=True, slots=True)
class MappingExpr:
    """A dict that is written out; a key of None spreads the value into it.

    C++: `{.x = a, .y = b}`, the members by their names.
    """

    items: tuple[tuple["Expr | None", "Expr"], ...]


@record(frozen=True, slots=True)
class Comprehension:
    """`[element for target in iterable if test]`; a dict's element is a tuple of key and value."""

    kind: str
    element: "Expr"
    loops: tuple[tuple["Expr", "Expr", tuple["Expr", ...]], ...]


@record(frozen=True, slots=True)
class Lambda:
    """A function without a name: `lambda`, `[&](…) { … }`.

    C++: `copies` are the names it takes by copy, if they are local where it is made; `captures`
    the variables it makes itself (`[n = e]`, `[&n = e]`). All others it shares.
    """

    function: "Function"
    copies: tuple[str, ...] = ()
    captures: tuple["Declare", ...] = ()


@record(frozen=True, slots=True)
class Star:
    """`*values` in a call or a list."""

    value: "Expr"


@record(frozen=True, slots=True)
class AssignExpr:
    """Python's `target := value`: the target is a Name, and has the value from then on."""

    target: "Expr"
    value: "Expr"


@record(frozen=True, slots=True)
class Expansion:
    """C++: a pattern, evaluated for each item of the parameter packs in it: `f(args)...`."""

    pattern: "Expr"
    packs: tuple[str, ...]


@record(frozen=True, slots=True)
class Opaque:
    """An expression that is not understood: the expressions within it, and its text, cut short."""

    parts: tuple["Expr", ...] = ()
    text: str = ""


Expr: TypeAlias = (
    Const
    | Name
    | Attr
    | Index
    | Call
    | New
    | Binary
    | Unary
    | Logic
    | Conditional
    | Concat
    | SequenceExpr
    | MappingExpr
    | Comprehension
    | Lambda
    | Star
    | AssignExpr
    | Expansion
    | Opaque
)
