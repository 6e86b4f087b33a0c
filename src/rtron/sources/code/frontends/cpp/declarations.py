"""Namespaces, classes, and what stands in them."""

from dataclasses import replace

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.functions import add_function
from rtron.sources.code.frontends.cpp.literals import integer_value
from rtron.sources.code.frontends.cpp.lowering_context import (
    LoweringContext,
    line_of,
    lower_declaration,
    lower_expression,
    lower_expressions,
    lowers_declaration,
)
from rtron.sources.code.frontends.cpp.predefined_macros import ADAPTER_ALIAS, EXPORT_ALIAS
from rtron.sources.code.frontends.cpp.types import (
    anonymous_name,
    one_line_text,
    qualified_name,
    read_declarator,
    specialised_name,
    type_of,
)
from rtron.sources.code.frontends.cpp.variables import lower_variable, named_declarators

_CLASSES = ("class_specifier", "struct_specifier", "union_specifier")
_TYPE_PARAMETERS = {
    "type_parameter_declaration",
    "optional_type_parameter_declaration",
    "variadic_type_parameter_declaration",
}
_NO_BASES = {"access_specifier", "virtual", "attribute_declaration"}


@lowers_declaration("namespace_definition")
def _namespace(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    name, body = node.child_by_field_name("name"), node.child_by_field_name("body")
    full = context.qualified(context.text(name).replace(" ", "")) if name else context.scope
    if any(child.type == "inline" for child in node.children):
        context.using_declarations.append(full)
    with context.enter_scope(full):
        _members(context, body, out)


@lowers_declaration("friend_declaration")
def _friend(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower a function that a class defines as its friend: one of the namespace around."""
    with context.enter_scope(context.scope.rpartition("::")[0]):
        for child in node.named_children:
            if child.type == "function_definition":
                lower_declaration(context, child, out)


@lowers_declaration("declaration_list", "ERROR")
def _list(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    _members(context, node, out)


def _members(context: LoweringContext, node: Node | None, out: list[ir.Stmt]) -> None:
    for child in node.named_children if node else ():
        lower_declaration(context, child, out)


@lowers_declaration("linkage_specification")
def _linkage(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    body = node.child_by_field_name("body")
    if body is not None:
        lower_declaration(context, body, out)


@lowers_declaration("template_declaration")
def _template(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    parameters = node.child_by_field_name("parameters")
    found = parameters.named_children if parameters else []
    context.template = tuple(_template_parameter(context, child) for child in found)
    for child in node.named_children[1:]:
        lower_declaration(context, child, out)
    context.template = ()


def _template_parameter(context: LoweringContext, node: Node) -> tuple[str, ir.TypeRef | None]:
    """Return a parameter's name and default; that of a value is its text."""
    if node.type in _TYPE_PARAMETERS:
        name = node.child_by_field_name("name") or next(iter(node.named_children), None)
        default = type_of(context, node.child_by_field_name("default_type"))
        return (context.text(name) if name else ""), default
    name = node.child_by_field_name("declarator")
    value = node.child_by_field_name("default_value")
    return (context.text(name) if name else ""), ir.TypeRef(context.text(value)) if value else None


@lowers_declaration(*_CLASSES)
def _class(context: LoweringContext, node: Node, _out: list[ir.Stmt]) -> None:
    name = node.child_by_field_name("name")
    written, types = qualified_name(context, name) if name else (anonymous_name(node), ())
    add_class(context, node, specialised_name(written, types), types)


def add_class(
    context: LoweringContext, node: Node, name: str, specialised: tuple[ir.TypeRef, ...] = ()
) -> None:
    """Add a class under a name, and all that it declares, to the file's; not if it has no body."""
    body = node.child_by_field_name("body")
    if body is None:
        return
    fields: list[ir.Stmt] = []
    full, template = context.qualified(name), context.take_template()
    bases = tuple(base for child in node.named_children for base in _bases(context, child))
    with context.enter_scope(full, in_class=True):
        _members(context, body, fields)
    context.classes.append(
        ir.Class(
            name=full,
            file=context.file,
            line=line_of(node),
            bases=bases,
            fields=tuple(field for field in fields if isinstance(field, ir.Declare)),
            template=template.names,
            defaults=template.defaults,
            specialised=specialised,
        )
    )


def _bases(context: LoweringContext, node: Node) -> list[ir.TypeRef]:
    if node.type != "base_class_clause":
        return []
    found = [
        type_of(context, child) for child in node.named_children if child.type not in _NO_BASES
    ]
    return [base for base in found if base]


@lowers_declaration("enum_specifier")
def _enum(context: LoweringContext, node: Node, _out: list[ir.Stmt]) -> None:
    name = node.child_by_field_name("name")
    add_enum(context, node, qualified_name(context, name)[0] if name else "")


def add_enum(context: LoweringContext, node: Node, name: str) -> None:
    """Add the enumerators, each with and without the enum's name."""
    body = node.child_by_field_name("body")
    known: int | None = -1
    for child in body.named_children if body else ():
        given = child.child_by_field_name("value")
        label = child.child_by_field_name("name")
        if child.type != "enumerator" or label is None:
            continue
        if given is not None:
            known = integer_value(context, lower_expression(context, given))
        elif known is not None:
            known += 1
        for prefix in {"", f"{name}::" if name else ""}:
            context.enums[context.qualified(prefix + context.text(label))] = known


@lowers_declaration("type_definition")
def _typedef(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    type = node.child_by_field_name("type")
    names = [read_declarator(child) for child in node.children_by_field_name("declarator")]
    if type is None or not names or names[0].name is None:
        return
    if type.child_by_field_name("body") is not None:
        if type.child_by_field_name("name") is None:
            _add_anonymous(context, type, context.text(names[0].name))
            return
        lower_declaration(context, type, out)
    for found in names:
        written = (
            ir.TypeRef(one_line_text(context, node)) if found.function else type_of(context, type)
        )
        target = found.array_type(context, written)
        if found.name is not None and target is not None:
            context.aliases.append((context.qualified(context.text(found.name)), target))


def _add_anonymous(context: LoweringContext, node: Node, name: str) -> None:
    if node.type == "enum_specifier":
        add_enum(context, node, name)
    else:
        add_class(context, node, name)


@lowers_declaration("alias_declaration")
def _alias(context: LoweringContext, node: Node, _out: list[ir.Stmt]) -> None:
    name = context.text(node.child_by_field_name("name") or node)
    target = type_of(context, node.child_by_field_name("type"))
    parameters = context.take_template().names
    if target is None:
        return
    if name == EXPORT_ALIAS:
        _export(context, target)
    elif name == ADAPTER_ALIAS and len(target.args) == 2:  # noqa: PLR2004 - the type and its message
        custom, message = target.args
        context.aliases.append((ir.adapter_alias(str(custom)), message))
    else:
        places = {each: ir.TypeRef(ir.alias_parameter(at)) for at, each in enumerate(parameters)}
        context.aliases.append((context.qualified(name), ir.substituted(target, places)))


def _export(context: LoweringContext, target: ir.TypeRef) -> None:
    names = [str(arg).removeprefix("::") for arg in target.args]
    if names:
        exported = names[0] if "::" in names[0] else context.qualified(names[0])
        context.exports.append((exported, names[1] if names[1:] else ""))


@lowers_declaration("namespace_alias_definition")
def _namespace_alias(context: LoweringContext, node: Node, _out: list[ir.Stmt]) -> None:
    name, *target = node.named_children
    if target:
        alias = ir.TypeRef(context.text(target[0]).replace(" ", "").removeprefix("::"))
        context.aliases.append((context.qualified(context.text(name)), alias))


@lowers_declaration("using_declaration")
def _using(context: LoweringContext, node: Node, _out: list[ir.Stmt]) -> None:
    for child in node.named_children[-1:]:
        context.using_declarations.append(qualified_name(context, child)[0])


@lowers_declaration("expression_statement")
def _stray_statement(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Keep a call that stands outside of all functions, as in a file with a brace too many."""
    if not context.in_class:
        values = lower_expressions(context, node.named_children)
        out.extend(ir.Evaluate(value, line_of(node)) for value in values)


@lowers_declaration("declaration", "field_declaration")
def _declaration(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    type = node.child_by_field_name("type")
    if type is not None and type.child_by_field_name("body") is not None:
        _define_type(context, node, type, out)
    if any(
        context.text(c) == "extern" for c in node.named_children if c.type.startswith("storage")
    ):
        return
    for one in named_declarators(node):
        found = one.declarator
        if found.function is not None or found.name is None or found.name.type == "operator_cast":
            add_function(context, node, found)
        else:
            name = qualified_name(context, found.name)[0]
            full = name if context.in_class else context.qualified(name)
            made = lower_variable(context, node, one, full)
            out.append(made if context.in_class else replace(made, static=False))


def _define_type(context: LoweringContext, node: Node, type: Node, out: list[ir.Stmt]) -> None:
    """Declare the type that a declaration defines; one without a name and variable is dissolved."""
    plain = node.child_by_field_name("declarator") is None
    if (
        plain
        and context.in_class
        and type.type in _CLASSES
        and not type.child_by_field_name("name")
    ):
        _members(context, type.child_by_field_name("body"), out)
    else:
        lower_declaration(context, type, out)
