"""Statements of Python, lowered."""

import pytest

from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.ir import (
    Assign,
    AssignExpr,
    Attr,
    Binary,
    Break,
    Call,
    Class,
    Const,
    Continue,
    Define,
    Delete,
    Evaluate,
    ForEach,
    Function,
    Global,
    If,
    Import,
    Logic,
    Name,
    Param,
    Raise,
    Return,
    SequenceExpr,
    SourceLanguage,
    Try,
    TypeRef,
    Unary,
    While,
    With,
)
from rtron.sources.code.ir.references import ir_nodes

A, B, C, D = Name("a"), Name("b"), Name("c"), Name("d")
DO_A, DO_B, DO_C = (Evaluate(name, 2) for name in (A, B, C))


def body(text):
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    return unit.body


def test_a_unit_knows_its_file_and_language():
    unit = lower_python("f.py", b"")
    assert (unit.file, unit.language, unit.body) == ("f.py", SourceLanguage.PYTHON, ())


CASES = {
    "a": (Evaluate(A, 1),),
    "'doc'": (),
    "pass": (),
    "...": (),
    "a: int": (),
    "a: int = b": (Assign((A,), B, 1),),
    "a = b = c": (Assign((A, B), C, 1),),
    "a, b = c": (Assign((SequenceExpr((A, B), "tuple"),), C, 1),),
    "a += b": (Assign((A,), Binary("+=", A, B, 1), 1),),
    "a -= b": (Assign((A,), Binary("-", A, B, 1), 1),),
    "if a:\n b": (If(A, (Evaluate(B, 2),), (), 1),),
    "if a:\n b\nelif c:\n d": (If(A, (Evaluate(B, 2),), (If(C, (Evaluate(D, 4),), (), 3),), 1),),
    "while a:\n break": (While(A, (Break(),), line=1),),
    "for a in b:\n continue": (ForEach(A, B, (Continue(),), 1),),
    "for a in b:\n c\nelse:\n d": (ForEach(A, B, (Evaluate(C, 2),), 1, (Evaluate(D, 4),)),),
    "while a:\n b\nelse:\n d": (While(A, (Evaluate(B, 2),), line=1, orelse=(Evaluate(D, 4),)),),
    "with a as b, c:\n d": (With(A, B, (With(C, None, (Evaluate(D, 2),), 1),), 1),),
    "raise": (Raise(),),
    "raise a from b": (Raise(A),),
    "del a, b": (Delete((A, B)),),
    "global a, b": (Global(("a", "b")),),
    "assert a": (If(Unary("not", A), (Raise(Call(Name("AssertionError"), (), (), 1)),), (), 1),),
    "assert a, b": (
        If(Unary("not", A), (Raise(Call(Name("AssertionError"), (B,), (), 1)),), (), 1),
    ),
    "import a": (Import("a", None, "", 0, 1),),
    "import a.b as c": (Import("a.b", None, "c", 0, 1),),
    "import a, b": (Import("a", None, "", 0, 1), Import("b", None, "", 0, 1)),
    "from a import b": (Import("a", "b", "b", 0, 1),),
    "from a.b import c as d": (Import("a.b", "c", "d", 0, 1),),
    "from .. import *": (Import("", "*", "*", 2, 1),),
    "try:\n a\nexcept b.C as e:\n c\nexcept (b, c):\n pass\nexcept:\n pass": (
        Try((DO_A,), ((("b.C",), "e", (Evaluate(C, 4),)), (("b", "c"), "", ()), ((), "", ()))),
    ),
    "try:\n a\nexcept b:\n pass\nelse:\n c\nfinally:\n d": (
        Try((DO_A,), ((("b",), "", ()),), (Evaluate(C, 6),), (Evaluate(D, 8),)),
    ),
}


@pytest.mark.parametrize("text", CASES)
def test_each_statement_has_its_counterpart(text):
    assert body(text) == CASES[text]


def test_a_function_with_all_kinds_of_parameters():
    (define,) = body(
        "@d(a)\ndef f(p, /, q: x.Y, r=a, *s, t, u=b, **v) -> List[x.Y]:\n 'doc'\n return q\n"
    )
    assert define == Define(
        Function(
            name="f",
            file="f.py",
            line=2,
            params=(
                Param("p"),
                Param("q", TypeRef("x.Y")),
                Param("r", default=A),
                Param("s", kind="star"),
                Param("t", kind="keyword"),
                Param("u", default=B, kind="keyword"),
                Param("v", kind="stars"),
            ),
            body=(Return(Name("q"), 4),),
            returns=TypeRef("List", (TypeRef("x.Y"),)),
        ),
        (Call(D, (A,), (), 1),),
    )


@pytest.mark.parametrize(
    ("annotation", "type_"),
    [
        ("'x.Y'", TypeRef("x.Y")),
        ("Dict[a, 'b']", TypeRef("Dict", (TypeRef("a"), TypeRef("b")))),
        ("f()", None),
        ("1", None),
    ],
)
def test_an_annotation_is_a_type_if_it_names_one(annotation, type_):
    (define,) = body(f"def f(a: {annotation}): pass")
    assert define.definition.params == (Param("a", type_),)


def test_a_class_holds_its_bases_and_statements():
    (define,) = body("@a\nclass K(b, metaclass=c):\n 'doc'\n d = 1\n def m(self): pass\n")
    assert define.decorators == (A,)
    assert define.definition == Class(
        name="K",
        file="f.py",
        line=2,
        bases=(B,),
        keywords=(("metaclass", C),),
        body=(
            Assign((D,), Const(1), 4),
            Define(Function(name="m", file="f.py", line=5, params=(Param("self"),), body=())),
        ),
    )


def test_functions_nest_and_write_to_outer_names():
    (define,) = body("def f():\n def g():\n  nonlocal a\n")
    (inner,) = define.definition.body
    assert inner.definition.body == (Global(("a",), module=False),)


def test_async_statements_are_like_the_others():
    (define,) = body("async def f():\n async for a in b: c\n async with a as b: c\n")
    assert define.definition.body == (
        ForEach(A, B, (Evaluate(C, 2),), 2),
        With(A, B, (Evaluate(C, 3),), 3),
    )


def test_match_is_a_chain_of_ifs():
    subject, one, two = Name("<match 1>"), Const(1), Const("s")
    last = If(Const(value=True), (Evaluate(D, 5),), (), 5)
    either = Logic("or", (Binary("==", subject, two, 4), Binary("is", subject, Const(None), 4)))
    text = "match a:\n case 1: b\n case 2 if b: c\n case 's' | None: c\n case _: d\n"
    guarded = Logic("and", (Binary("==", subject, Const(2), 3), B))
    assert body(text) == (
        Assign((subject,), A, 1),
        If(
            Binary("==", subject, one, 2),
            (Evaluate(B, 2),),
            (If(guarded, (Evaluate(C, 3),), (If(either, (Evaluate(C, 4),), (last,), 4),), 3),),
            2,
        ),
    )


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("[b, *c]", {"b", "c"}),
        ("{'k': b, **c}", {"b", "c"}),
        ("K(b, x=c)", {"b", "c"}),
        ("(1 | 2) as b", {"b"}),
        ("b", {"b"}),
        ("b if b", {"b"}),
    ],
)
def test_a_case_binds_the_names_of_its_pattern(pattern, names):
    (_, chain) = body(f"match a:\n case {pattern}: pass\n")
    bound = (node for node in ir_nodes(chain.test) if isinstance(node, AssignExpr))
    assert {node.target.id for node in bound} == names


def test_a_private_name_is_its_class_s_own():
    (define,) = body("class _K:\n def __m(self, __a): self.__b = __c__, __a\n")
    (method,) = define.definition.body
    assert (method.definition.name, method.definition.params[1].name) == ("_K__m", "_K__a")
    assert method.definition.body == (
        Assign(
            (Attr(Name("self"), "_K__b"),), SequenceExpr((Name("__c__"), Name("_K__a")), "tuple"), 2
        ),
    )
