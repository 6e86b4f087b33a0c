"""What the lowering of one file carries: its bytes, what was found, and how deep it is."""

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

from tree_sitter import Node

from rtron.sources.code import ir

MAX_DEPTH = 90
_MAX_PROBLEMS = 100
_ARGUMENTS = re.compile(r"<.*>")
_UNNAMED = {"lambda_expression", "call_expression", "parenthesized_expression"}


class Template(NamedTuple):
    """The names of template parameters, and what they are where nothing is written."""

    names: tuple[str, ...]
    defaults: tuple[tuple[str, ir.TypeRef], ...]


@dataclass(slots=True)
class LoweringContext:
    """The file being lowered; `scope` is the namespace, class or function that names are in.

    `statements` takes the statements of the block being lowered, so that an assignment within an
    expression can stand before the statement it is in; it is None where it must not. `packs` are
    the names of parameter packs, `called` where the names stand that are called or declared.
    `labels` are the named ones of each `switch`.
    """

    file: str
    source: bytes
    scope: str = ""
    depth: int = 0
    statements: list[ir.Stmt] | None = None
    template: tuple[tuple[str, ir.TypeRef | None], ...] = ()
    in_class: bool = False
    functions: list[ir.Function] = field(default_factory=list)
    classes: list[ir.Class] = field(default_factory=list)
    aliases: list[tuple[str, ir.TypeRef]] = field(default_factory=list)
    using_declarations: list[str] = field(default_factory=list)
    exports: list[tuple[str, str]] = field(default_factory=list)
    enums: dict[str, int | None] = field(default_factory=dict)
    problems: list[ir.SourceProblem] = field(default_factory=list)
    names: dict[bytes, ir.Name] = field(default_factory=dict)
    packs: set[str] = field(default_factory=set)
    called: list[tuple[int, int]] = field(default_factory=list)
    types: dict[bytes, ir.TypeRef | None] = field(default_factory=dict)
    labels: list[frozenset[str]] = field(default_factory=list)

    def text(self, node: Node) -> str:
        """Return a node's source text."""
        return self.source[node.start_byte : node.end_byte].decode("utf-8", "replace")

    def add_problem(self, line: int, why: str, *, may_join: bool = True) -> None:
        """Note a part that could not be read; the number of notes is bounded."""
        if len(self.problems) < _MAX_PROBLEMS:
            self.problems.append(ir.SourceProblem(line, why, may_join=may_join))

    def note_call(self, name: Node) -> None:
        """Note that what is called, or declared, by a name is lowered."""
        plain = name.child_by_field_name("field") or name
        if plain.type not in _UNNAMED:
            self.called.append((plain.start_byte, plain.end_byte))

    def is_too_deep(self, node: Node) -> bool:
        """Return whether a node lies deeper than is read; then it becomes a problem."""
        if self.depth < MAX_DEPTH:
            return False
        self.add_problem(line_of(node), "nested too deep to be read")
        return True

    def qualified(self, name: str) -> str:
        """Return a name with the scope before it; `::name` is qualified already.

        A namespace is found from within itself: in `a::b`, `b::C::f` is `a::b::C::f`. What has two
        parts only may be a constructor of a class that is called like its namespace.
        """
        if name.startswith("::"):
            return name[2:]
        around, first = self.scope.split("::"), name.partition("::")[0]
        if first in around and _ARGUMENTS.sub("", name).count("::") > 1:
            outer = around[: len(around) - 1 - around[::-1].index(first)]
            return "::".join((*outer, name))
        return f"{self.scope}::{name}" if self.scope else name

    def take_template(self) -> Template:
        """Return the template parameters of what is declared next, and forget them."""
        template, self.template = self.template, ()
        defaults = tuple((name, default) for name, default in template if default is not None)
        return Template(tuple(name for name, _ in template), defaults)

    @contextmanager
    def enter_scope(self, scope: str, *, in_class: bool = False) -> Iterator[None]:
        """Enter the scope of a namespace, class or function by its qualified name."""
        outer, self.scope, self.in_class = (self.scope, self.in_class), scope, in_class
        yield
        self.scope, self.in_class = outer


def line_of(node: Node) -> int:
    """Return the line a node begins at."""
    return node.start_point[0] + 1


ExpressionLowerer = Callable[[LoweringContext, Node], ir.Expr]
StatementLowerer = Callable[[LoweringContext, Node, list[ir.Stmt]], None]
_Lowerer = TypeVar("_Lowerer")

_EXPRESSIONS: dict[str, ExpressionLowerer] = {}
_STATEMENTS: dict[str, StatementLowerer] = {}
_DECLARATIONS: dict[str, StatementLowerer] = {}
_MAX_PARTS = 4096


def _registering(
    table: dict[str, _Lowerer], kinds: tuple[str, ...]
) -> Callable[[_Lowerer], _Lowerer]:
    def register(function: _Lowerer) -> _Lowerer:
        table.update(dict.fromkeys(kinds, function))
        return function

    return register


def lowers_expression(*kinds: str) -> Callable[[ExpressionLowerer], ExpressionLowerer]:
    """Let a function lower expressions of these kinds."""
    return _registering(_EXPRESSIONS, kinds)


def lowers_statement(*kinds: str) -> Callable[[StatementLowerer], StatementLowerer]:
    """Let a function lower statements of these kinds, in a function's body."""
    return _registering(_STATEMENTS, kinds)


def lowers_declaration(*kinds: str) -> Callable[[StatementLowerer], StatementLowerer]:
    """Let a function lower these kinds of a namespace's or class's members."""
    return _registering(_DECLARATIONS, kinds)


def lower_expression(context: LoweringContext, node: Node) -> ir.Expr:
    """Return the lowered expression, an Opaque of what lies within where none lowers it."""
    if context.is_too_deep(node):
        return ir.Opaque((), context.text(node)[:60])
    context.depth += 1
    value = _EXPRESSIONS.get(node.type, lower_opaque)(context, node)
    context.depth -= 1
    return value


def lower_expressions(context: LoweringContext, nodes: Iterable[Node]) -> tuple[ir.Expr, ...]:
    """Return the lowered expressions."""
    return tuple([lower_expression(context, node) for node in nodes])


def lower_opaque(context: LoweringContext, node: Node) -> ir.Opaque:
    """Return an Opaque with the expressions within a node."""
    return ir.Opaque(
        lower_expressions(context, node.named_children[:_MAX_PARTS]), context.text(node)[:60]
    )


def lower_statement(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower a statement of a function into `out`; an ERROR node gives what can be read in it."""
    if context.is_too_deep(node):
        return
    kind = node.type
    outer, context.statements = context.statements, out
    context.depth += 1
    write = _STATEMENTS.get(kind) or _DECLARATIONS.get(kind)
    if write:
        write(context, node, out)
    elif kind in _EXPRESSIONS:
        out.append(ir.Evaluate(lower_expression(context, node), line_of(node)))
    context.depth -= 1
    context.statements = outer


def lower_block(context: LoweringContext, nodes: Iterable[Node]) -> tuple[ir.Stmt, ...]:
    """Return the lowered statements."""
    out: list[ir.Stmt] = []
    for node in nodes:
        lower_statement(context, node, out)
    return tuple(out)


def lower_declaration(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower a member of a namespace or class; its variables go to `out`."""
    write = _DECLARATIONS.get(node.type)
    if write and not context.is_too_deep(node):
        outer, context.statements = context.statements, None
        context.depth += 1
        write(context, node, out)
        context.depth -= 1
        context.statements = outer
