"""Statements of Python, lowered."""

import pytest

from rtron.sources.code import ir
from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.ir.references import ir_nodes

A, B, C, D = ir.Name("a"), ir.Name("b"), ir.Name("c"), ir.Name("d")
DO_A, DO_B, DO_C = (ir.Evaluate(name, 2) for name in (A, B, C))


def body(text):
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    return unit.body


def test_a_unit_knows_its_file_and_language():
    unit = lower_python("f.py", b"")
    assert (unit.file, unit.language, unit.body) == ("f.py", ir.SourceLanguage.PYTHON, ())


CASES = {
    "a": (ir.Evaluate(A, 1),),
    "'doc'": (),
    "pass": (),
    "...": (),
    "a: int": (),
    "a: int = b": (ir.Assign((A,), B, 1),),
    "a = b = c": (ir.Assign((A, B), C, 1),),
    "a, b = c": (ir.Assign((ir.SequenceExpr((A, B), "tuple"),), C, 1),),
    "a += b": (ir.Assign((A,), ir.Binary("+=", A, B, 1), 1),),
    "a -= b": (ir.Assign((A,), ir.Binary("-", A, B, 1), 1),),
    "if a:\n b": (ir.If(A, (ir.Evaluate(B, 2),), (), 1),),
    "if a:\n b\nelif c:\n d": (
        ir.If(A, (ir.Evaluate(B, 2),), (ir.If(C, (ir.Evaluate(D, 4),), (), 3),), 1),
    ),
    "while a:\n break": (ir.While(A, (ir.Break(),), line=1),),
    "for a in b:\n continue": (ir.ForEach(A, B, (ir.Continue(),), 1),),
    "for a in b:\n c\nelse:\n d": (
        ir.ForEach(A, B, (ir.Evaluate(C, 2),), 1, (ir.Evaluate(D, 4),)),
    ),
    "while a:\n b\nelse:\n d": (
        ir.While(A, (ir.Evaluate(B, 2),), line=1, orelse=(ir.Evaluate(D, 4),)),
    ),
    "with a as b, c:\n d": (ir.With(A, B, (ir.With(C, None, (ir.Evaluate(D, 2),), 1),), 1),),
    "raise": (ir.Raise(),),
    "raise a from b": (ir.Raise(A),),
    "del a, b": (ir.Delete((A, B)),),
    "global a, b": (ir.Global(("a", "b")),),
    "assert a": (
        ir.If(
            ir.Unary("not", A), (ir.Raise(ir.Call(ir.Name("AssertionError"), (), (), 1)),), (), 1
        ),
    ),
    "assert a, b": (
        ir.If(
            ir.Unary("not", A), (ir.Raise(ir.Call(ir.Name("AssertionError"), (B,), (), 1)),), (), 1
        ),
    ),
    "import a": (ir.Import("a", None, "", 0, 1),),
    "import a.b as c": (ir.Import("a.b", None, "c", 0, 1),),
    "import a, b": (ir.Import("a", None, "", 0, 1), ir.Import("b", None, "", 0, 1)),
    "from a import b": (ir.Import("a", "b", "b", 0, 1),),
    "from a.b import c as d": (ir.Import("a.b", "c", "d", 0, 1),),
    "from .. import *": (ir.Import("", "*", "*", 2, 1),),
    "try:\n a\nexcept b.C as e:\n c\nexcept (b, c):\n pass\nexcept:\n pass": (
        ir.Try(
            (DO_A,), ((("b.C",), "e", (ir.Evaluate(C, 4),)), (("b", "c"), "", ()), ((), "", ()))
        ),
    ),
    "try:\n a\nexcept b:\n pass\nelse:\n c\nfinally:\n d": (
        ir.Try((DO_A,), ((("b",), "", ()),), (ir.Evaluate(C, 6),), (ir.Evaluate(D, 8),)),
    ),
}


@pytest.mark.parametrize("text", CASES)
def test_each_statement_has_its_counterpart(text):
    assert body(text) == CASES[text]


def test_a_function_with_all_kinds_of_parameters():
    (define,) = body(
        "@d(a)\ndef f(p, /, q: x.Y, r=a, *s, t, u=b, **v) -> List[x.Y]:\n 'doc'\n return q\n"
    )
    assert define == ir.Define(
        ir.Function(
            name="f",
            file="f.py",
            line=2,
            params=(
                ir.Param("p"),
                ir.Param("q", ir.TypeRef("x.Y")),
                ir.Param("r", default=A),
                ir.Param("s", kind="star"),
                ir.Param("t", kind="keyword"),
                ir.Param("u", default=B, kind="keyword"),
                ir.Param("v", kind="stars"),
            ),
            body=(ir.Return(ir.Name("q"), 4),),
            returns=ir.TypeRef("List", (ir.TypeRef("x.Y"),)),
        ),
        (ir.Call(D, (A,), (), 1),),
    )


@pytest.mark.parametrize(
    ("annotation", "type_"),
    [
        ("'x.Y'", ir.TypeRef("x.Y")),
        ("Dict[a, 'b']", ir.TypeRef("Dict", (ir.TypeRef("a"), ir.TypeRef("b")))),
        ("f()", None),
        ("1", None),
    ],
)
def test_an_annotation_is_a_type_if_it_names_one(annotation, type_):
    (define,) = body(f"def f(a: {annotation}): pass")
    assert define.definition.params == (ir.Param("a", type_),)


def test_a_class_holds_its_bases_and_statements():
    (define,) = body("@a\nclass K(b, metaclass=c):\n 'doc'\n d = 1\n def m(self): pass\n")
    assert define.decorators == (A,)
    assert define.definition == ir.Class(
        name="K",
        file="f.py",
        line=2,
        bases=(B,),
        keywords=(("metaclass", C),),
        body=(
            ir.Assign((D,), ir.Const(1), 4),
            ir.Define(
                ir.Function(name="m", file="f.py", line=5, params=(ir.Param("self"),), body=())
            ),
        ),
    )


def test_functions_nest_and_write_to_outer_names():
    (define,) = body("def f():\n def g():\n  nonlocal a\n")
    (inner,) = define.definition.body
    assert inner.definition.body == (ir.Global(("a",), module=False),)


def test_async_statements_are_like_the_others():
    (define,) = body("async def f():\n async for a in b: c\n async with a as b: c\n")
    assert define.definition.body == (
        ir.ForEach(A, B, (ir.Evaluate(C, 2),), 2),
        ir.With(A, B, (ir.Evaluate(C, 3),), 3),
    )


def test_match_is_a_chain_of_ifs():
    subject, one, two = ir.Name("<match 1>"), ir.Const(1), ir.Const("s")
    last = ir.If(ir.Const(value=True), (ir.Evaluate(D, 5),), (), 5)
    either = ir.Logic(
        "or", (ir.Binary("==", subject, two, 4), ir.Binary("is", subject, ir.Const(None), 4))
    )
    text = "match a:\n case 1: b\n case 2 if b: c\n case 's' | None: c\n case _: d\n"
    guarded = ir.Logic("and", (ir.Binary("==", subject, ir.Const(2), 3), B))
    assert body(text) == (
        ir.Assign((subject,), A, 1),
        ir.If(
            ir.Binary("==", subject, one, 2),
            (ir.Evaluate(B, 2),),
            (
                ir.If(
                    guarded,
                    (ir.Evaluate(C, 3),),
                    (ir.If(either, (ir.Evaluate(C, 4),), (last,), 4),),
                    3,
                ),
            ),
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
    bound = (node for node in ir_nodes(chain.test) if isinstance(node, ir.AssignExpr))
    assert {node.target.id for node in bound} == names


def test_a_private_name_is_its_class_s_own():
    (define,) = body("class _K:\n def __m(self, __a): self.__b = __c__, __a\n")
    (method,) = define.definition.body
    assert (method.definition.name, method.definition.params[1].name) == ("_K__m", "_K__a")
    assert method.definition.body == (
        ir.Assign(
            (ir.Attr(ir.Name("self"), "_K__b"),),
            ir.SequenceExpr((ir.Name("__c__"), ir.Name("_K__a")), "tuple"),
            2,
        ),
    )
