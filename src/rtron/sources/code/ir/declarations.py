"""The functions and classes of the intermediate representation."""

from rtron.sources.code.ir.expressions import Expr
from rtron.sources.code.ir.statements import Declare, Stmt
from rtron.sources.code.ir.types import TypeRef
from rtron.sources.code.record import record


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


@record(frozen=True, slots=True, kw_only=True)
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
