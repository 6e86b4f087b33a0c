"""The statements of the intermediate representation: what a body does, in order."""

from typing import TYPE_CHECKING, TypeAlias

from rtron.sources.code.ir.expressions import Expr, TypeRef
from rtron.sources.code.record import record

if TYPE_CHECKING:
    from rtron.sources.code.ir.declarations import Class, Function


@record(frozen=True, slots=True)
class Evaluate:
    """An expression evaluated for what it does; `x++` is an Assign."""

    value: Expr
    line: int = 0


@record(frozen=True, slots=True)
class Assign:
    """`targets = value`, each target a Name, Attr, Index, or Sequence that is taken apart.

    `a += b` is lowered to `a = a + b`.
    """

    targets: tuple[Expr, ...]
    value: Expr
    line: int = 0


@record(frozen=True, slots=True)
class Declare:
    """A C++ variable or data member: local, of a class, or of a namespace.

    `type` is None for `auto`. `value` is None without an initialiser; `T x(a, b)`, `T x{a}` have
    a New, `T x = e` has e. `reference` marks `T& x = e`, whose writes reach e; `constant` marks
    one whose value nobody can change (`const`, `constexpr`).
    """

    name: str
    type: TypeRef | None
    value: Expr | None = None
    reference: bool = False
    pointer: bool = False
    static: bool = False
    line: int = 0
    constant: bool = False


@record(frozen=True, slots=True)
class If:
    """`if`; a `switch` is a chain of them, an `elif` stands alone in `orelse`."""

    test: Expr
    body: tuple["Stmt", ...]
    orelse: tuple["Stmt", ...] = ()
    line: int = 0


@record(frozen=True, slots=True)
class While:
    """`while`, and C++ `for (;;)` behind its initialiser; `step` runs after each round.

    `first` marks `do … while`, whose body runs before the test. `orelse` runs unless the loop is
    left by `break` (Python).
    """

    test: Expr
    body: tuple["Stmt", ...]
    step: tuple["Stmt", ...] = ()
    first: bool = False
    line: int = 0
    orelse: tuple["Stmt", ...] = ()


@record(frozen=True, slots=True)
class ForEach:
    """`for target in iterable`, `for (auto& target : iterable)`; a target of C++ is a Name.

    `orelse` runs unless the loop is left by `break` (Python). `reference` says that the body may
    write to the items themselves.
    """

    target: Expr
    iterable: Expr
    body: tuple["Stmt", ...]
    line: int = 0
    orelse: tuple["Stmt", ...] = ()
    reference: bool = False


@record(frozen=True, slots=True)
class With:
    """Python's `with manager as target`; a target of None takes nothing."""

    manager: Expr
    target: Expr | None
    body: tuple["Stmt", ...]
    line: int = 0


@record(frozen=True, slots=True)
class Return:
    """`return value`."""

    value: Expr | None = None
    line: int = 0


@record(frozen=True, slots=True)
class Yield:
    """`yield value`; `yield from` spreads (a Star)."""

    value: Expr | None = None


@record(frozen=True, slots=True)
class Break:
    """`break`."""


@record(frozen=True, slots=True)
class Continue:
    """`continue`."""


@record(frozen=True, slots=True)
class Breakable:
    """C++: the chain that a `switch` is, which a `break` leaves and a `continue` does not."""

    body: tuple["Stmt", ...]
    line: int = 0


@record(frozen=True, slots=True)
class Jump:
    """C++: `goto label`."""

    label: str
    line: int = 0


@record(frozen=True, slots=True)
class Raise:
    """`raise`, `throw`."""

    value: Expr | None = None


@record(frozen=True, slots=True)
class Try:
    """`try`; each handler is (names of the exceptions caught, variable or "", body)."""

    body: tuple["Stmt", ...]
    handlers: tuple[tuple[tuple[str, ...], str, tuple["Stmt", ...]], ...] = ()
    orelse: tuple["Stmt", ...] = ()
    final: tuple["Stmt", ...] = ()


@record(frozen=True, slots=True)
class Define:
    """Python: a function or class is defined here, by its name."""

    definition: "Function | Class"
    decorators: tuple[Expr, ...] = ()


@record(frozen=True, slots=True)
class Import:
    """`import module as alias` (`name` is None), `from module import name as alias`.

    `level` counts the dots; a name of "*" brings all.
    """

    module: str
    name: str | None
    alias: str
    level: int = 0
    line: int = 0


@record(frozen=True, slots=True)
class Global:
    """`global` names; unless they are the `module`'s, `nonlocal` ones."""

    names: tuple[str, ...]
    module: bool = True


@record(frozen=True, slots=True)
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
    | With
    | Return
    | Yield
    | Break
    | Breakable
    | Continue
    | Jump
    | Raise
    | Try
    | Define
    | Import
    | Global
    | Delete
)
