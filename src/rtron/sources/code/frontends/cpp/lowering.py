"""One C++ file lowered: decoded, preprocessed, parsed by tree-sitter, walked once."""

import re
from collections.abc import Iterator, Mapping
from itertools import islice
from types import MappingProxyType

import tree_sitter_cpp
from tree_sitter import Language, Node, Parser

from rtron.sources.code import ir
from rtron.sources.code.endpoint_calls import ENDPOINT_CALL, ENDPOINT_CALLS
from rtron.sources.code.frontends.cpp import (
    declarations,
    functions,
    operators,
    statements,
    switch_statement,
)
from rtron.sources.code.frontends.cpp.grammar_workarounds import work_around_grammar
from rtron.sources.code.frontends.cpp.lowering_context import (
    LoweringContext,
    line_of,
    lower_declaration,
)
from rtron.sources.code.frontends.cpp.macros import Macro
from rtron.sources.code.frontends.cpp.preprocessor import PreprocessedFile, preprocess

_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_CALL = re.compile(ENDPOINT_CALL.pattern.encode())
_UNEVALUATED = frozenset(
    [
        *("string_literal", "raw_string_literal", "char_literal", "comment", "decltype"),
        *("sizeof_expression", "alignof_expression", "noexcept", "requires_clause"),
        *("requires_expression", "using_declaration", "static_assert_declaration"),
    ]
)


_MACRO_USE = re.compile(r"\b[A-Z][A-Z0-9_]{2,}\b(?=\s*\()")
_MAX_USES = 200


def decode_source(data: bytes) -> str:
    """Return the text: UTF-16 by its mark, UTF-8, or else Latin-1; lines end with a newline only.

    NULs, which no parser expects, become spaces; lone surrogates become question marks.
    """
    text = _decode(data).replace("\r\n", "\n").replace("\r", "\n").replace("\0", " ")
    return text.encode("utf-8", "replace").decode("utf-8")


def _decode(data: bytes) -> str:
    if data.startswith(_UTF16):
        return data.decode("utf-16", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


MAX_BYTES = 4 * 2**20
_MAX_ERRORS = 20
_SHOWN = 60
"""So many characters of what cannot be read are shown: the rest is often read after all."""
_CPP = Language(tree_sitter_cpp.language())
_EXPRESSION_MACRO = re.compile(r"[^;{}#\n]{1,400}")
_NO_MACROS: Mapping[str, str] = MappingProxyType({})
_LOWERERS = (declarations, functions, operators, statements, switch_statement)


def lower_cpp(path: str, text: bytes, defined: Mapping[str, str] = _NO_MACROS) -> ir.Unit:
    """Return the unit of a C++ file, a source or a header.

    `defined` are the macros known before it begins, name and body. Nothing is raised: what cannot
    be read is among the unit's problems. A macro that stands for an expression is a Declare
    without a type in the unit's body, for the files that include this one.
    """
    if len(text) > MAX_BYTES:
        why = f"larger than {MAX_BYTES // 2**20} MiB; not read"
        return ir.Unit(
            file=path, language=ir.SourceLanguage.CPP, problems=(ir.SourceProblem(1, why),)
        )
    read = preprocess(decode_source(text), defined)
    source = work_around_grammar(read.code, is_c=path.endswith(".c")).encode()
    context = LoweringContext(path, source, problems=list(read.problems))
    body: list[ir.Stmt] = []
    root = Parser(_CPP).parse(source).root_node
    _note_errors(context, root)
    for child in root.named_children:
        lower_declaration(context, child, body)
    note_lost_calls(context, root)
    body += _macro_constants(path, read.macros)
    return _unit(context, read, body)


def _unit(context: LoweringContext, read: PreprocessedFile, body: list[ir.Stmt]) -> ir.Unit:
    return ir.Unit(
        file=context.file,
        language=ir.SourceLanguage.CPP,
        body=tuple(body),
        functions=tuple(context.functions),
        classes=tuple(context.classes),
        aliases=tuple(context.aliases),
        usings=tuple(context.using_declarations),
        includes=read.includes,
        exports=tuple(context.exports),
        enums=tuple(context.enums.items()),
        endpoint_macros=endpoint_macros(read.macros),
        unexpanded=unexpanded_macros(read.code),
        labels=tuple(context.labels),
        problems=tuple(context.problems),
    )


def _note_errors(context: LoweringContext, root: Node) -> None:
    """Note what the parser could not read, the outermost nodes only."""
    open_nodes = [root] if root.has_error else []
    noted = 0
    while open_nodes and noted < _MAX_ERRORS:
        node = open_nodes.pop()
        if _is_list_without_type(node):
            continue
        if node.is_error or node.is_missing:
            noted += 1
            piece = context.text(node)[:_SHOWN]
            may_join = any(call in piece for call in ENDPOINT_CALLS)
            context.add_problem(line_of(node), f"cannot be read: {piece!r}", may_join=may_join)
        else:
            open_nodes += [child for child in reversed(node.children) if _has_error(child)]


def _is_list_without_type(node: Node) -> bool:
    """Tell whether the type is missing of `T parameter = {}`, which is no error."""
    parent = node.parent
    return node.is_missing and parent is not None and parent.type == "compound_literal_expression"


def _has_error(node: Node) -> bool:
    return node.has_error or node.is_missing


def _macro_constants(path: str, macros: Mapping[str, Macro]) -> list[ir.Stmt]:
    """Return the macros that stand for an expression, each as a variable."""
    plain = {name: macro for name, macro in macros.items() if macro.params is None}
    useful = {
        name: macro for name, macro in plain.items() if _EXPRESSION_MACRO.fullmatch(macro.body)
    }
    source = "\n".join(f"auto {name} = {macro.body};" for name, macro in useful.items()).encode()
    context, body = LoweringContext(path, source), list[ir.Stmt]()
    for child in Parser(_CPP).parse(source).root_node.named_children:
        if child.type == "declaration" and not child.has_error:
            lower_declaration(context, child, body)
    declared = [item for item in body if isinstance(item, ir.Declare) and item.name in useful]
    return [
        ir.Declare(item.name, None, item.value, static=True, line=useful[item.name].line)
        for item in declared
    ]


def endpoint_macros(macros: Mapping[str, Macro]) -> tuple[str, ...]:
    """Return the macros with parameters that hold a call which makes an endpoint."""
    holding = (name for name, macro in macros.items() if ENDPOINT_CALL.search(macro.body))
    return tuple(name for name in holding if macros[name].params is not None)


def unexpanded_macros(code: str) -> tuple[tuple[str, int], ...]:
    """Return what reads like the use of a macro that another file defines, with its line."""
    uses = islice(_MACRO_USE.finditer(code), _MAX_USES)
    return tuple((use.group(), code.count("\n", 0, use.start()) + 1) for use in uses)


def note_lost_calls(context: LoweringContext, root: Node) -> None:
    """Note each call that no lowered expression calls, whatever it was lost by."""
    for start, end in _lost_calls(context):
        node = root.descendant_for_byte_range(start, end)
        if node is not None and not _is_unevaluated(node):
            name = context.source[start:end].decode()
            context.add_problem(node.start_point[0] + 1, f"a call of {name} cannot be read")


def _lost_calls(context: LoweringContext) -> Iterator[tuple[int, int]]:
    """Yield where the names of calls stand that were not noted; both are gone through in order."""
    lowered = iter(sorted(context.called, key=lambda place: place[1]))
    first, last = next(lowered, (0, 0))
    for found in _CALL.finditer(context.source):
        start, end = found.span()
        while last and last < end:
            first, last = next(lowered, (0, 0))
        if not first <= start < last:
            yield start, end


def _is_unevaluated(node: Node) -> bool:
    current: Node | None = node
    while current is not None:
        if current.type in _UNEVALUATED:
            return True
        current = current.parent
    return False
