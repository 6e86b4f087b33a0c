"""Functions, methods, constructors and lambdas."""

from dataclasses import replace

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.expressions import identifiers, lower_arguments
from rtron.sources.code.frontends.cpp.lowering_context import (
    LoweringContext,
    line_of,
    lower_block,
    lower_expression,
    lower_statement,
    lowers_declaration,
    lowers_expression,
    lowers_statement,
)
from rtron.sources.code.frontends.cpp.types import (
    Declarator,
    has_specifier,
    is_constant,
    qualified_name,
    read_declarator,
    type_of,
)


def lambda_captures(
    context: LoweringContext, node: Node
) -> tuple[tuple[str, ...], tuple[ir.Declare, ...]]:
    """Return the names that a lambda copies, and the variables that its captures make."""
    taken = node.child_by_field_name("captures")
    entries = taken.named_children if taken else []
    plain = [entry for entry in entries if entry.type == "identifier"]
    by_reference = {context.text(entry) for entry in plain if _is_by_reference(entry)}
    copies = {context.text(entry): None for entry in plain if not _is_by_reference(entry)}
    if any(entry.type == "lambda_default_capture" and entry.text == b"=" for entry in entries):
        body = node.child_by_field_name("body")
        copies |= {n: None for n in identifiers(context, body) if n not in by_reference}
    made = [entry for entry in entries if entry.type == "lambda_capture_initializer"]
    return tuple(copies), tuple(_capture_initialiser(context, entry) for entry in made)


def _is_by_reference(entry: Node) -> bool:
    return entry.prev_sibling is not None and entry.prev_sibling.type == "&"


def _capture_initialiser(context: LoweringContext, entry: Node) -> ir.Declare:
    left, right = entry.child_by_field_name("left"), entry.child_by_field_name("right")
    return ir.Declare(
        context.text(left) if left else "",
        None,
        lower_expression(context, right) if right else None,
        reference=entry.children[0].type == "&",
        line=line_of(entry),
    )


_PARAMETERS = {
    "parameter_declaration",
    "optional_parameter_declaration",
    "variadic_parameter_declaration",
}
_Initialiser = tuple[str, tuple[ir.Expr, ...]]


@lowers_declaration("function_definition")
def _definition(context: LoweringContext, node: Node, _out: list[ir.Stmt]) -> None:
    add_function(context, node, read_declarator(node.child_by_field_name("declarator")))


@lowers_statement("function_definition")
def _nested_block(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower what looks like a function in a function, a macro with a block, as its block."""
    body = node.child_by_field_name("body")
    if body is not None:
        lower_statement(context, body, out)


def add_function(context: LoweringContext, node: Node, found: Declarator) -> None:
    """Add the function that a definition or declaration holds to the file's."""
    signature = found.function
    if found.name is not None and found.name.type == "operator_cast":
        signature = found.name.child_by_field_name("declarator")
    name, specialised = qualified_name(context, found.name)
    if found.name is not None:
        context.note_call(found.name)
    if signature is None or not name or not _is_function(context, node, name):
        return
    full = context.qualified(name)
    template = context.take_template()
    with context.enter_scope(full):
        made = ir.Function(
            name=full,
            file=context.file,
            line=line_of(node),
            params=lower_parameters(context, signature.child_by_field_name("parameters")),
            body=_body(context, node),
            returns=_return_type(context, node, signature),
            initialisers=_initialisers(context, node),
            template=template.names,
            defaults=template.defaults,
            specialised=specialised if not template.names and "::" not in name else (),
            static=has_specifier(context, node, "storage_class_specifier", b"static"),
        )
    context.functions.append(made)


def _is_function(context: LoweringContext, node: Node, name: str) -> bool:
    """Return whether it is a function: without a type it needs a body or a class's name."""
    last = name.rpartition("::")[2]
    if node.type == "function_definition" or node.child_by_field_name("type") is not None:
        return True
    own = context.scope.rpartition("::")[2].partition("<")[0]
    return last.startswith(("~", "operator")) or last == own


def _return_type(context: LoweringContext, node: Node, signature: Node) -> ir.TypeRef | None:
    for child in signature.named_children:
        if child.type == "trailing_return_type" and child.named_children:
            return type_of(context, child.named_children[0])
    return type_of(context, node.child_by_field_name("type"))


def _body(context: LoweringContext, node: Node) -> tuple[ir.Stmt, ...] | None:
    body = node.child_by_field_name("body") or _constructor_try(node)
    if body is None:
        defaulted = any(child.type == "default_method_clause" for child in node.named_children)
        return () if defaulted else None
    return lower_block(
        context, body.named_children if body.type == "compound_statement" else [body]
    )


def _constructor_try(node: Node) -> Node | None:
    """Return the `try : member(x) {} catch (…) {}` that a constructor has for its body."""
    return next((child for child in node.named_children if child.type == "try_statement"), None)


def _initialisers(context: LoweringContext, node: Node) -> tuple[_Initialiser, ...]:
    holder = _constructor_try(node) or node
    lists = [child for child in holder.named_children if child.type == "field_initializer_list"]
    return tuple(
        _initialiser(context, child)
        for found in lists
        for child in found.named_children
        if child.type == "field_initializer" and child.named_children
    )


def _initialiser(context: LoweringContext, node: Node) -> _Initialiser:
    """Return a member or base and its arguments; those in braces are one SequenceExpr."""
    member, *rest = node.named_children
    given = rest[0] if rest else None
    args = lower_arguments(context, given)
    if args and given is not None and given.type == "initializer_list":
        args = (
            args[0] if isinstance(args[0], ir.MappingExpr) else ir.SequenceExpr(args, ir.BRACES),
        )
    return qualified_name(context, member)[0], args


def lower_parameters(context: LoweringContext, node: Node | None) -> tuple[ir.Param, ...]:
    """Return a function's parameters; `(void)` has none."""
    children = node.named_children if node else []
    made = [_parameter(context, child) for child in children if child.type in _PARAMETERS]
    is_void = [param.type for param in made] == [ir.TypeRef("void")] and not made[0].name
    return () if is_void else tuple(made)


def _parameter(context: LoweringContext, node: Node) -> ir.Param:
    found = read_declarator(node.child_by_field_name("declarator"))
    type = found.array_type(context, type_of(context, node.child_by_field_name("type")))
    const = has_specifier(context, node, "type_qualifier", b"const")
    name = qualified_name(context, found.name)[0]
    if node.type == "variadic_parameter_declaration":
        context.packs.add(name)
    return ir.Param(
        name,
        type,
        _default(context, node.child_by_field_name("default_value"), type),
        "star" if node.type == "variadic_parameter_declaration" else "plain",
        reference=(found.reference or found.pointer) and not const,
        constant=is_constant(context, node, found) and not found.sizes,
    )


def _default(
    context: LoweringContext, node: Node | None, type: ir.TypeRef | None
) -> ir.Expr | None:
    """Return a parameter's default; what stands in braces alone makes one of its type."""
    default = lower_expression(context, node) if node else None
    if isinstance(default, ir.New) and not default.type.name and type:
        return replace(default, type=type)
    return default


@lowers_expression("lambda_expression")
def _lambda(context: LoweringContext, node: Node) -> ir.Lambda:
    signature = node.child_by_field_name("declarator")
    parameters = signature.child_by_field_name("parameters") if signature else None
    copies, captures = lambda_captures(context, node)
    return ir.Lambda(
        ir.Function(
            name="",
            file=context.file,
            line=line_of(node),
            params=lower_parameters(context, parameters),
            body=_body(context, node),
            returns=_return_type(context, node, signature) if signature else None,
            column=node.start_point[1],
        ),
        copies,
        captures,
    )
