"""The intermediate representation of a source file: what C++ and Python have in common.

A front end (`frontends/python/`, `frontends/cpp/`) lowers one file to a `Unit`; the interpreter
runs units together. Names of C++ stand as they are written (`ns::Class`, template arguments taken
out into a TypeRef); what a front end does not understand becomes an `Opaque` with the expressions
inside it, so that calls in it are still seen.
"""

from rtron.sources.code.ir.declarations import (
    Class,
    Function,
    Param,
    SourceLanguage,
    SourceProblem,
    Unit,
)
from rtron.sources.code.ir.expressions import (
    BRACES,
    AssignExpr,
    Attr,
    Binary,
    Call,
    Comprehension,
    Concat,
    Conditional,
    Const,
    Expansion,
    Expr,
    Index,
    Lambda,
    Logic,
    MappingExpr,
    Name,
    New,
    Opaque,
    SequenceExpr,
    Star,
    TypeRef,
    Unary,
    adapter_alias,
    alias_parameter,
    substituted,
)
from rtron.sources.code.ir.statements import (
    Assign,
    Break,
    Breakable,
    Continue,
    Declare,
    Define,
    Delete,
    Evaluate,
    ForEach,
    Global,
    If,
    Import,
    Jump,
    Raise,
    Return,
    Stmt,
    Try,
    While,
    With,
    Yield,
)

__all__ = [
    "BRACES",
    "Assign", "AssignExpr", "Attr", "Binary", "Break", "Breakable", "Call", "Class",
    "Comprehension", "Concat", "Conditional", "Const", "Continue", "Declare", "Define", "Delete",
    "Evaluate", "Expansion", "Expr", "ForEach", "Function", "Global", "If", "Import", "Index",
    "Jump", "Lambda", "Logic", "MappingExpr", "Name", "New", "Opaque", "Param", "Raise", "Return",
    "SequenceExpr", "SourceLanguage", "SourceProblem", "Star", "Stmt", "Try", "TypeRef", "Unary",
    "Unit", "While", "With", "Yield", "adapter_alias", "alias_parameter", "substituted",
]  # fmt: skip
