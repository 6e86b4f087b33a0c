"""Functions, methods, constructors and lambdas."""

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.captures import captured
from rtron.sources.code.frontends.cpp.declarators import (
    Declarator,
    declarator,
    has_word,
    is_constant,
    kinds_of,
)
from rtron.sources.code.frontends.cpp.expressions import arguments
from rtron.sources.code.frontends.cpp.lowering_context import Context, line_of
from rtron.sources.code.frontends.cpp.node_lowering import (
    block,
    declares,
    expression,
    lowers,
    statement,
    states,
)
from rtron.sources.code.frontends.cpp.types import named, type_of
from rtron.sources.code.ir import Expr, Function, Lambda, Param, Stmt, TypeRef

_PARAMETERS = {
    "parameter_declaration",
    "optional_parameter_declaration",
    "variadic_parameter_declaration",
}
_Initialiser = tuple[str, tuple[Expr, ...]]


@declares("function_definition")
def _definition(context: Context, node: Node, _out: list[Stmt]) -> None:
    add_function(context, node, declarator(node.child_by_field_name("declarator")))


@states("function_definition")
def _nested(context: Context, node: Node, out: list[Stmt]) -> None:
    """Lower what looks like a function in a function, a macro with a block, as its block."""
    body = node.child_by_field_name("body")
    if body is not None:
        statement(context, body, out)


def add_function(context: Context, node: Node, found: Declarator) -> None:
    """Add the function that a definition or declaration holds to the file's."""
    signature = found.function
    if found.name is not None and found.name.type == "operator_cast":
        signature = found.name.child_by_field_name("declarator")
    name = named(context, found.name)[0]
    if signature is None or not name or not _is_real(context, node, name):
        return
    full = context.qualified(name)
    template = context.take_template()
    with context.within(full):
        made = Function(
            name=full,
            file=context.file,
            line=line_of(node),
            params=params(context, signature.child_by_field_name("parameters")),
            body=_body(context, node),
            returns=_returned(context, node, signature),
            initialisers=_initialisers(context, node),
            template=template.names,
            defaults=template.defaults,
            static=has_word(context, node, "storage_class_specifier", b"static"),
            virtual="virtual" in kinds_of(node) or _overrides(signature),
        )
    context.functions.append(made)


def _is_real(context: Context, node: Node, name: str) -> bool:
    """Return whether it is a function: without a type it needs a body or a class's name."""
    last = name.rpartition("::")[2]
    if node.type == "function_definition" or node.child_by_field_name("type") is not None:
        return True
    return last.startswith(("~", "operator")) or last == context.scope.rpartition("::")[2]


def _overrides(signature: Node) -> bool:
    return any(child.type == "virtual_specifier" for child in signature.named_children)


def _returned(context: Context, node: Node, signature: Node) -> TypeRef | None:
    for child in signature.named_children:
        if child.type == "trailing_return_type" and child.named_children:
            return type_of(context, child.named_children[0])
    return type_of(context, node.child_by_field_name("type"))


def _body(context: Context, node: Node) -> tuple[Stmt, ...] | None:
    body = node.child_by_field_name("body")
    if body is None:
        defaulted = any(child.type == "default_method_clause" for child in node.named_children)
        return () if defaulted else None
    return block(context, body.named_children if body.type == "compound_statement" else [body])


def _initialisers(context: Context, node: Node) -> tuple[_Initialiser, ...]:
    lists = [child for child in node.named_children if child.type == "field_initializer_list"]
    return tuple(
        _initialiser(context, child)
        for found in lists
        for child in found.named_children
        if child.type == "field_initializer" and child.named_children
    )


def _initialiser(context: Context, node: Node) -> _Initialiser:
    member, *rest = node.named_children
    return named(context, member)[0], arguments(context, rest[0] if rest else None)


def params(context: Context, node: Node | None) -> tuple[Param, ...]:
    """Return a function's parameters; `(void)` has none."""
    children = node.named_children if node else []
    made = [_param(context, child) for child in children if child.type in _PARAMETERS]
    return (
        ()
        if [param.type for param in made] == [TypeRef("void")] and not made[0].name
        else (tuple(made))
    )


def _param(context: Context, node: Node) -> Param:
    found = declarator(node.child_by_field_name("declarator"))
    default = node.child_by_field_name("default_value")
    const = has_word(context, node, "type_qualifier", b"const")
    return Param(
        named(context, found.name)[0],
        found.typed(context, type_of(context, node.child_by_field_name("type"))),
        expression(context, default) if default else None,
        "star" if node.type == "variadic_parameter_declaration" else "plain",
        reference=(found.reference or found.pointer) and not const,
        constant=is_constant(context, node, found) and not found.sizes,
    )


@lowers("lambda_expression")
def _lambda(context: Context, node: Node) -> Lambda:
    signature = node.child_by_field_name("declarator")
    parameters = signature.child_by_field_name("parameters") if signature else None
    copies, captures = captured(context, node)
    return Lambda(
        Function(
            name="",
            file=context.file,
            line=line_of(node),
            params=params(context, parameters),
            body=_body(context, node),
            returns=_returned(context, node, signature) if signature else None,
        ),
        copies,
        captures,
    )
