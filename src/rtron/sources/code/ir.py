"""The intermediate representation of a source file: what C++ and Python have in common.

A front end (`python/`, `cpp/`) lowers one file to a `Unit`; the interpreter runs units together.
Names of C++ stand as they are written (`ns::Class`, template arguments taken out into a TypeRef);
what a front end does not understand becomes an `Opaque` with the expressions inside it, so that
calls in it are still seen.
"""

from dataclasses import dataclass, field
from enum import Enum
from typing import TypeAlias


class Language(str, Enum):
    """The language of a unit."""

    PYTHON = "python"
    CPP = "cpp"


@dataclass(frozen=True, slots=True)
class TypeRef:
    """A type as it is written, without const, & and *: `boost::shared_ptr<std_msgs::String>`.

    A template argument that is a value stands as its text in `name`.
    """

    name: str
    args: tuple["TypeRef", ...] = ()

    def __str__(self) -> str:
        return f"{self.name}<{', '.join(map(str, self.args))}>" if self.args else self.name


# Expressions


@dataclass(frozen=True, slots=True)
class Const:
    """A str, int, float, bool, bytes or None (`nullptr`, `NULL`)."""

    value: str | int | float | bool | bytes | None


@dataclass(frozen=True, slots=True)
class Name:
    """A variable, function, class, module or namespace member; `this` and `self` are names too.

    `types` are the template arguments written behind it: `make_shared<Foo>`.
    """

    id: str
    types: tuple[TypeRef, ...] = ()


@dataclass(frozen=True, slots=True)
class Attr:
    """A member: `owner.name`, `owner->name`; `*p` and `&x` are lowered to `p` and `x` themselves.

    A call of a base class's method, `Base::run()` in C++, is the Name `Base::run`.
    """

    owner: "Expr"
    name: str
    types: tuple[TypeRef, ...] = ()


@dataclass(frozen=True, slots=True)
class Index:
    """An element: `owner[key]`; a slice is an Opaque key."""

    owner: "Expr"
    key: "Expr"


@dataclass(frozen=True, slots=True)
class Call:
    """A call; `keywords` holds Python's named arguments, a name of "**" spreads a mapping.

    A spread positional argument is a Star. `Foo(x)` in C++ is a Call of a Name as well: whether
    Foo is a class is known to the interpreter only.
    """

    function: "Expr"
    args: tuple["Expr", ...] = ()
    keywords: tuple[tuple[str, "Expr"], ...] = ()
    line: int = 0


@dataclass(frozen=True, slots=True)
class New:
    """C++: a value of a type is made: `new T(args)`, `T{args}`, or by a Declare's initialiser."""

    type: TypeRef
    args: tuple["Expr", ...] = ()
    line: int = 0


@dataclass(frozen=True, slots=True)
class Binary:
    """`left operator right`, the operator spelled as in Python; C++ `<<` stays `<<`.

    Operators: + - * / // % ** @ << >> & | ^ == != < <= > >= is, is not, in, not in.
    """

    operator: str
    left: "Expr"
    right: "Expr"
    line: int = 0


@dataclass(frozen=True, slots=True)
class Unary:
    """`not x`, `-x`, `+x`, `~x`."""

    operator: str
    operand: "Expr"


@dataclass(frozen=True, slots=True)
class Logic:
    """`and`/`or` (C++ `&&`, `||`) of two or more operands, evaluated until decided."""

    operator: str
    operands: tuple["Expr", ...]


@dataclass(frozen=True, slots=True)
class Conditional:
    """`body if test else orelse`, `test ? body : orelse`."""

    test: "Expr"
    body: "Expr"
    orelse: "Expr"


@dataclass(frozen=True, slots=True)
class Concat:
    """The parts of an f-string, each made a string and put together."""

    parts: tuple["Expr", ...]


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list, tuple or set that is written out; C++ `{a, b}` without a type is a list."""

    items: tuple["Expr", ...]
    kind: str = "list"


@dataclass(frozen=True, slots=True)
class Mapping:
    """A dict that is written out; a key of None spreads the value into it."""

    items: tuple[tuple["Expr | None", "Expr"], ...]


@dataclass(frozen=True, slots=True)
class Comprehension:
    """`[element for target in iterable if test]`; a dict's element is a tuple of key and value."""

    kind: str
    element: "Expr"
    loops: tuple[tuple["Expr", "Expr", tuple["Expr", ...]], ...]


@dataclass(frozen=True, slots=True)
class Lambda:
    """A function without a name: `lambda`, `[&](…) { … }`.

    C++: `copies` are the names it takes by copy, if they are local where it is made; `captures`
    the variables it makes itself (`[n = e]`, `[&n = e]`). All others it shares.
    """

    function: "Function"
    copies: tuple[str, ...] = ()
    captures: tuple["Declare", ...] = ()


@dataclass(frozen=True, slots=True)
class Star:
    """`*values` in a call or a list."""

    value: "Expr"


@dataclass(frozen=True, slots=True)
class Opaque:
    """An expression nobody here understands, the expressions within it, and its text, cut short."""

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
    | Sequence
    | Mapping
    | Comprehension
    | Lambda
    | Star
    | Opaque
)


# Statements


@dataclass(frozen=True, slots=True)
class Evaluate:
    """An expression evaluated for what it does; `x++` is an Assign."""

    value: Expr
    line: int = 0


@dataclass(frozen=True, slots=True)
class Assign:
    """`targets = value`, each target a Name, Attr, Index, or Sequence that is taken apart.

    `a += b` is lowered to `a = a + b`.
    """

    targets: tuple[Expr, ...]
    value: Expr
    line: int = 0


@dataclass(frozen=True, slots=True)
class Declare:
    """A C++ variable or data member: local, of a class, or of a namespace.

    `type` is None for `auto`. `value` is None without an initialiser; `T x(a, b)`, `T x{a}` have
    a New, `T x = e` has e. `reference` marks `T& x = e`, whose writes reach e.
    """

    name: str
    type: TypeRef | None
    value: Expr | None = None
    reference: bool = False
    pointer: bool = False
    static: bool = False
    line: int = 0


@dataclass(frozen=True, slots=True)
class If:
    """`if`; a `switch` is a chain of them, an `elif` stands alone in `orelse`."""

    test: Expr
    body: tuple["Stmt", ...]
    orelse: tuple["Stmt", ...] = ()
    line: int = 0


@dataclass(frozen=True, slots=True)
class While:
    """`while`, and C++ `for (;;)` behind its initialiser; `step` runs after each round.

    `first` marks `do … while`, whose body runs before the test.
    """

    test: Expr
    body: tuple["Stmt", ...]
    step: tuple["Stmt", ...] = ()
    first: bool = False
    line: int = 0


@dataclass(frozen=True, slots=True)
class ForEach:
    """`for target in iterable`, `for (auto& target : iterable)`; a target of C++ is a Name."""

    target: Expr
    iterable: Expr
    body: tuple["Stmt", ...]
    line: int = 0


@dataclass(frozen=True, slots=True)
class Return:
    """`return value`."""

    value: Expr | None = None
    line: int = 0


@dataclass(frozen=True, slots=True)
class Yield:
    """`yield value`; `yield from` spreads (a Star)."""

    value: Expr | None = None


@dataclass(frozen=True, slots=True)
class Break:
    """`break`."""


@dataclass(frozen=True, slots=True)
class Continue:
    """`continue`."""


@dataclass(frozen=True, slots=True)
class Raise:
    """`raise`, `throw`."""

    value: Expr | None = None


@dataclass(frozen=True, slots=True)
class Try:
    """`try`; each handler is (names of the exceptions caught, variable or "", body)."""

    body: tuple["Stmt", ...]
    handlers: tuple[tuple[tuple[str, ...], str, tuple["Stmt", ...]], ...] = ()
    orelse: tuple["Stmt", ...] = ()
    final: tuple["Stmt", ...] = ()


@dataclass(frozen=True, slots=True)
class Define:
    """Python: a function or class is defined here, by its name."""

    what: "Function | Class"
    decorators: tuple[Expr, ...] = ()


@dataclass(frozen=True, slots=True)
class Import:
    """`import module as alias` (`name` is None), `from module import name as alias`.

    `level` counts the dots; a name of "*" brings all.
    """

    module: str
    name: str | None
    alias: str
    level: int = 0
    line: int = 0


@dataclass(frozen=True, slots=True)
class Global:
    """`global` and `nonlocal` names."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Delete:
    """`del targets`, `delete pointer`."""

    targets: tuple[Expr, ...]


Stmt: TypeAlias = (
    Evaluate
    | Assign
    | Declare
    | If
    | While
    | ForEach
    | Return
    | Yield
    | Break
    | Continue
    | Raise
    | Try
    | Define
    | Import
    | Global
    | Delete
)


# Functions, classes, files


@dataclass(frozen=True, slots=True)
class Param:
    """A parameter; `kind` is "plain", "star" (`*args`), "stars" (`**kwargs`) or "keyword" (only).

    `reference` marks a C++ `T&` or `T*` that is not const: what the function writes reaches the
    caller.
    """

    name: str
    type: TypeRef | None = None
    default: Expr | None = None
    kind: str = "plain"
    reference: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """A function, method or lambda. Python: `name` is the plain one and methods name their self.

    C++: `name` is qualified as far as the file says (`ns::Class::method`); a constructor's last
    two parts are alike, a destructor's last part begins with `~`; `this` is no parameter;
    `initialisers` are the member initialisers (member or base, arguments); `template` are the
    names of its template parameters, `defaults` what they are where nothing is written. `body` is
    None where it is only declared.
    """

    name: str
    file: str
    line: int = 0
    params: tuple[Param, ...] = ()
    body: tuple[Stmt, ...] | None = ()
    returns: TypeRef | None = None
    initialisers: tuple[tuple[str, tuple[Expr, ...]], ...] = ()
    template: tuple[str, ...] = ()
    defaults: tuple[tuple[str, TypeRef], ...] = ()
    static: bool = False
    virtual: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Class:
    """A class or struct.

    Python: `bases` are expressions, `body` holds the statements. C++: `name` is qualified,
    `bases` are types, `fields` the data members in order; its methods are among the unit's
    functions.
    """

    name: str
    file: str
    line: int = 0
    bases: tuple[Expr | TypeRef, ...] = ()
    fields: tuple[Declare, ...] = ()
    body: tuple[Stmt, ...] = ()
    template: tuple[str, ...] = ()
    defaults: tuple[tuple[str, TypeRef], ...] = ()


@dataclass(frozen=True, slots=True)
class Problem:
    """A part of a file that could not be read, and why."""

    line: int
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """One source file.

    Python: `body` is the module's. C++: `functions` and `classes` are all of the file's, nested
    ones too, qualified; `body` holds the Declares of namespace scope (names qualified);
    `aliases` are typedefs, `using X = …` and `namespace a = b` (qualified name, type), in a class
    too; `usings` the namespaces and names opened by `using` (`using a::b;` as "a::b");
    `includes` as written with their quotes or brackets; `exports` the classes given to
    PLUGINLIB_EXPORT_CLASS and its kin (class, base); `enums` the enumerators with their values,
    qualified both with and without the enum's name.
    """

    file: str
    language: Language
    body: tuple[Stmt, ...] = ()
    functions: tuple[Function, ...] = ()
    classes: tuple[Class, ...] = ()
    aliases: tuple[tuple[str, TypeRef], ...] = ()
    usings: tuple[str, ...] = ()
    includes: tuple[str, ...] = ()
    exports: tuple[tuple[str, str], ...] = ()
    enums: tuple[tuple[str, int | None], ...] = ()
    problems: tuple[Problem, ...] = field(default=())
