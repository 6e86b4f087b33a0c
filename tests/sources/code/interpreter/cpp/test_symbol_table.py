"""C++ names, overloads and the binding of parameters."""

from dataclasses import replace
from pathlib import Path

import pytest

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.overload_resolution import choose_overload
from rtron.sources.code.interpreter.cpp.symbol_table import MAX_FILES, SymbolTable
from rtron.sources.code.interpreter.execution.arguments import Arguments, bind_parameters
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame

FRAME = StackFrame(file="f.cpp")


class Folder:
    """Units by their file, which a header's name is as well."""

    def __init__(self, **units):
        self.units = {
            Path(name): ir.Unit(file=name, language=ir.SourceLanguage.CPP, **u)
            for name, u in units.items()
        }

    def lowered_unit(self, path, language):
        return self.units[path]

    def header(self, include, includer):
        path = Path(include)
        return path if path in self.units else None


def loaded(**units):
    symbols = SymbolTable(Folder(**units))
    symbols.load(Path(next(iter(units))))
    return symbols


def passed(*values, **keywords):
    return Arguments(values=tuple(map(av.Scalar, values)), keywords=keywords, frame=FRAME)


def params(text):
    found = []
    for word in text.split():
        kind = {"**": "stars", "*": "star", "!": "keyword"}.get(word.rstrip("abckwrgs=1"), "plain")
        name, _, default = word.lstrip("*!").partition("=")
        found.append(ir.Param(name, None, ir.Const(int(default)) if default else None, kind))
    return tuple(found)


def bound(text, arguments):
    found = bind_parameters(params(text), arguments, lambda node: av.Scalar(node.value))
    return {
        name: value.value if isinstance(value, av.Scalar) else value
        for name, value in found.items()
    }


def test_plain_parameters_are_bound_by_place_and_name():
    assert bound("a b", passed(1, 2)) == {"a": 1, "b": 2}
    assert bound("a b", passed(1, b=av.Scalar(2))) == {"a": 1, "b": 2}
    assert bound("a b=1", passed(5)) == {"a": 5, "b": 1}


def test_what_nobody_gives_is_a_hole_of_its_name():
    found = bound("a b", passed(1))
    assert isinstance(found["b"], av.Unknown)
    assert found["b"].label == "b"


def test_more_arguments_than_parameters_are_left():
    assert bound("a", passed(1, 2, 3)) == {"a": 1}
    assert bound("", passed(1)) == {}


def test_stars_take_the_rest():
    found = bind_parameters(
        params("a *args !k=1 **kw"),
        passed(1, 2, 3, k=av.Scalar(4), c=av.Scalar(5)),
        lambda n: av.FALSE,
    )
    assert av.items_of(found["args"]) == ((av.Scalar(2), av.Scalar(3)), True)
    assert found["k"] == av.Scalar(4)
    assert found["kw"].entries == {"c": av.Scalar(5)}


def test_stars_may_be_empty():
    found = bind_parameters(params("a *args **kw"), passed(1), lambda n: av.FALSE)
    assert av.items_of(found["args"]) == ((), True)
    assert found["kw"].entries == {}


def test_a_keyword_only_parameter_is_not_bound_by_place():
    assert bound("*args !k=1", passed(7, 8))["k"] == 1


@pytest.mark.parametrize("other", [True, False])
def test_a_name_is_constant_where_it_is_in_every_file(other):
    first = ir.Declare("T", None, ir.Const("a"), constant=True)
    second = ir.Declare("T", None, ir.Const("b"), constant=other)
    symbols = loaded(a={"body": (first,)}, b={"body": (second,)})
    symbols.load(Path("b"))
    assert symbols.variables["T"] == (ir.Declare("T", None, ir.Const("a"), constant=other), "a")
    symbols = loaded(b={"body": (replace(second, value=None),)}, a={"body": (first,)})
    symbols.load(Path("a"))
    assert symbols.variables["T"] == (ir.Declare("T", None, ir.Const("a"), constant=other), "a")


def overload(*types, defaults=0, body=()):
    parameters = [
        ir.Param(f"p{at}", ir.TypeRef(type), ir.Const(0) if at >= len(types) - defaults else None)
        for at, type in enumerate(types)
    ]
    return ir.Function(name="f", file="f.cpp", params=tuple(parameters), body=body)


TEXT, NUMBER, BOTH = overload("std::string"), overload("int"), overload("std::string", "int")
OBJECT = overload("ros::NodeHandle")


@pytest.mark.parametrize(
    ("functions", "values", "chosen"),
    [
        ((TEXT, NUMBER), (av.Scalar("a"),), TEXT),
        ((NUMBER, TEXT), (av.Scalar("a"),), TEXT),
        ((TEXT, NUMBER), (av.Scalar(1),), NUMBER),
        ((TEXT, BOTH), (av.Scalar("a"), av.Scalar(1)), BOTH),
        ((BOTH, TEXT), (av.Scalar("a"),), TEXT),
        ((TEXT, OBJECT), (av.Instance(av.LibraryClass("ros::NodeHandle")),), OBJECT),
        ((NUMBER, OBJECT), (av.Instance(av.LibraryClass("ros::NodeHandle")),), OBJECT),
        ((TEXT,), (), TEXT),
        ((TEXT, NUMBER), (av.Unknown("h"),), TEXT),
    ],
)
def test_the_overload_that_fits_is_called(functions, values, chosen):
    assert choose_overload(functions, Arguments(values=values, frame=FRAME)) is chosen


def test_a_default_makes_an_overload_fit():
    with_default = overload("std::string", "int", defaults=1)
    assert choose_overload((NUMBER, with_default), passed("a")) is with_default


def test_a_definition_is_taken_before_a_mere_declaration():
    declared = overload("int", body=None)
    assert choose_overload((declared, NUMBER), passed(1)) is NUMBER
    assert choose_overload((NUMBER, declared), passed(1)) is NUMBER


@pytest.mark.parametrize(
    ("name", "scope", "fake_study"),
    [
        ("x", "", ["x"]),
        ("x", "a::b", ["a::b::x", "a::x", "x"]),
        ("c::x", "a", ["a::c::x", "c::x"]),
        ("::x", "a::b", ["x"]),
    ],
)
def test_candidates_nearest_first(name, scope, fake_study):
    assert [*loaded(f={}).candidates(name, scope)] == fake_study


def test_an_opened_namespace_and_a_name_brought_in_are_candidates():
    symbols = loaded(f={"usings": ("ros", "hard::Base")})
    assert "ros::NodeHandle" in [*symbols.candidates("NodeHandle", "")]
    assert "hard::Base" in [*symbols.candidates("Base", "a")]
    assert "hard::Base::run" in [*symbols.candidates("Base::run", "")]


def test_aliases_are_followed_and_keep_their_arguments():
    symbols = loaded(
        f={
            "aliases": (
                ("A", ir.TypeRef("B")),
                ("B", ir.TypeRef("std::vector", (ir.TypeRef("int"),))),
            )
        }
    )
    assert symbols.resolve_type(ir.TypeRef("A"), "") == ir.TypeRef(
        "std::vector", (ir.TypeRef("int"),)
    )


def test_an_alias_is_looked_up_where_it_stands():
    aliases = (
        ("a::T", ir.TypeRef("U")),
        ("a::U", ir.TypeRef("ros::NodeHandle")),
        ("U", ir.TypeRef("int")),
    )
    symbols = loaded(f={"aliases": aliases})
    assert symbols.resolve_type(ir.TypeRef("T"), "a::b") == ir.TypeRef("ros::NodeHandle")
    assert symbols.resolve_type(ir.TypeRef("a::T"), "") == ir.TypeRef("ros::NodeHandle")


def test_a_namespace_alias_is_followed():
    symbols = loaded(f={"aliases": (("mf", ir.TypeRef("message_filters")),)})
    assert (
        symbols.resolve_type(ir.TypeRef("mf::Subscriber"), "").name == "message_filters::Subscriber"
    )


@pytest.mark.parametrize("cycle", [[("A", "A")], [("A", "B"), ("B", "A")], [("A", "A::A")]])
def test_aliases_in_a_circle_end(cycle):
    symbols = loaded(f={"aliases": tuple((name, ir.TypeRef(of)) for name, of in cycle)})
    assert isinstance(symbols.resolve_type(ir.TypeRef("A"), ""), ir.TypeRef)


def test_a_scanned_class_hides_an_alias_further_out():
    symbols = loaded(
        f={"aliases": (("T", ir.TypeRef("int")),), "classes": (ir.Class(name="a::T", file="f"),)}
    )
    assert symbols.resolve_type(ir.TypeRef("T"), "a") == ir.TypeRef("T")
    assert symbols.class_named("T", "a").name == "a::T"
    assert symbols.class_named("T", "") is None


def test_headers_are_taken_in_once_even_in_a_circle():
    f = ir.Function(name="a::f", file="h")
    symbols = loaded(
        f={"includes": ("h", "h", "missing")}, h={"includes": ("f", "h"), "functions": (f,)}
    )
    assert symbols.functions["a::f"] == [f]
    assert symbols.functions_named("f") == (f,)


def test_so_many_files_and_no_more():
    units = {f"f{n}": {"includes": (f"f{n + 1}",)} for n in range(200)}
    assert len(loaded(**units).units) == 200
    wide = {"f": {"includes": tuple(f"h{n}" for n in range(MAX_FILES + 50))}}
    wide |= {f"h{n}": {} for n in range(MAX_FILES + 50)}
    assert len(loaded(**wide).units) == MAX_FILES
