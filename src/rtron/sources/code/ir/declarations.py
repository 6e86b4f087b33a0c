"""The functions and classes of the intermediate representation."""

from dataclasses import field
from enum import Enum

from rtron.sources.code.ir.expressions import Expr, TypeRef
from rtron.sources.code.ir.statements import Declare, Stmt
from rtron.sources.code.record import record
from rtron.vocabulary import UnresolvedCause


@record(frozen=True, slots=True)
class Param:
    """A parameter; `kind` is "plain", "star" (`*args`), "stars" (`**kwargs`) or "keyword" (only).

    `reference` marks a C++ `T&` or `T*` that is not const: what the function writes reaches the
    caller. `constant` marks one whose value nobody can change.
    """

    name: str
    type: TypeRef | None = None
    default: Expr | None = None
    kind: str = "plain"
    reference: bool = False
    constant: bool = False


@record(frozen=True, slots=True, kw_only=True)
class Function:
    """A function, method or lambda. Python: `name` is the plain one and methods name their self.

    C++: `name` is qualified as far as the file says (`ns::Class::method`); a constructor's last
    two parts are alike, a destructor's last part begins with `~`; `this` is no parameter;
    `initialisers` are the member initialisers (member or base, arguments); `template` are the
    names of its template parameters, `defaults` what they are where nothing is written;
    `specialised` is what they are in `template <> void f<int>()`. `body` is None where it is only
    declared.
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
    specialised: tuple[TypeRef, ...] = ()
    column: int = field(default=0, compare=False)

    @property
    def key(self) -> tuple[str, int, str]:
        """What tells it from all others: its file, line and name, of a lambda its column."""
        return self.file, self.line, self.name or f"@{self.column}"


@record(frozen=True, slots=True, kw_only=True)
class Class:
    """A class or struct.

    Python: `bases` are expressions, `keywords` the named ones behind them (`metaclass`), `body`
    holds the statements. C++: `name` is qualified,
    `bases` are types, `fields` the data members in order; its methods are among the unit's
    functions. `template <> struct T<int>` is called "T<int>", and `specialised` for int.
    """

    name: str
    file: str
    line: int = 0
    bases: tuple[Expr | TypeRef, ...] = ()
    fields: tuple[Declare, ...] = ()
    body: tuple[Stmt, ...] = ()
    template: tuple[str, ...] = ()
    defaults: tuple[tuple[str, TypeRef], ...] = ()
    keywords: tuple[tuple[str, Expr], ...] = ()
    specialised: tuple[TypeRef, ...] = ()


class SourceLanguage(str, Enum):
    """The language of a unit."""

    PYTHON = "python"
    CPP = "cpp"


@record(frozen=True, slots=True)
class SourceProblem:
    """A part of a file that could not be read, and why; `may_join` where it may join nodes."""

    line: int
    why: str
    cause: UnresolvedCause = UnresolvedCause.PARTLY_READ
    may_join: bool = True


@record(frozen=True, slots=True, kw_only=True)
class Unit:
    """One source file.

    Python: `body` is the module's. C++: `functions` and `classes` are all of the file's, nested
    ones too, qualified; `body` holds the Declares of namespace scope (names qualified);
    `aliases` are typedefs, `using X = …` and `namespace a = b` (qualified name, type), in a class
    too; `usings` the namespaces and names opened by `using` (`using a::b;` as "a::b");
    `includes` as written with their quotes or brackets; `exports` the classes given to
    PLUGINLIB_EXPORT_CLASS and the like (class, base); `enums` the enumerators with their values,
    qualified both with and without the enum's name; `endpoint_macros` the macros with parameters
    that hold a call which makes an endpoint, `unexpanded` what reads like a macro of another file,
    with their lines; `labels` the names of each `switch`, no two of which have the same value.
    """

    file: str
    language: SourceLanguage
    body: tuple[Stmt, ...] = ()
    functions: tuple[Function, ...] = ()
    classes: tuple[Class, ...] = ()
    aliases: tuple[tuple[str, TypeRef], ...] = ()
    usings: tuple[str, ...] = ()
    includes: tuple[str, ...] = ()
    exports: tuple[tuple[str, str], ...] = ()
    enums: tuple[tuple[str, int | None], ...] = ()
    endpoint_macros: tuple[str, ...] = ()
    unexpanded: tuple[tuple[str, int], ...] = ()
    labels: tuple[frozenset[str], ...] = ()
    problems: tuple[SourceProblem, ...] = field(default=())
