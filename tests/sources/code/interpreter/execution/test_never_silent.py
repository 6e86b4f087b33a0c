"""What is cut, skipped or not known, and could make an endpoint, is noted with its place."""

from pathlib import Path

import pytest
import ros1_runs
import ros2_runs

from rtron.sources.code.interpreter.cpp import symbol_table
from rtron.sources.code.program_runner import run_cpp
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace
from rtron.vocabulary import UnresolvedCause

ADVERTISE = 'nh.advertise<std_msgs::Bool>("x", 1);'


def notes(interface):
    return [
        (note.what, note.why, [at.line for at in note.evidence]) for note in interface.unresolved
    ]


def test_a_jump_is_noted_where_endpoints_are_made():
    body = f"again: {ADVERTISE} goto again;"
    assert notes(ros1_runs.cpp(body)) == [("goto again", "jumps are not followed", [6])]
    top = "int f(int n) { again: if (n < 3) { n++; goto again; } return n; }"
    assert notes(ros1_runs.cpp("f(1);", top)) == []


def test_python_that_a_cpp_program_runs_is_noted():
    body = 'namespace py = pybind11; py::exec("run()"); py::module_::import("m").attr("f")();'
    whats = [what for what, *_ in notes(ros1_runs.cpp(body))]
    assert whats == ["call of run()", "call of m"]


def test_functions_and_lambdas_that_nothing_calls_are_noted_each_with_its_line():
    top = f"void make(ros::NodeHandle nh) {{ {ADVERTISE} }}\n"
    top += "void f(ros::NodeHandle nh) { make(nh); }"
    body = f"auto kept = [&] {{ {ADVERTISE} }};"
    found = ros1_runs.cpp(body, top)
    ((what, why, lines),) = notes(found)
    assert found.unresolved[0].cause is UnresolvedCause.UNREACHED
    assert (what, lines) == ("make() and 2 more", [3, 4, 7])
    assert why == "may join nodes, but nothing that is seen calls it"


@pytest.mark.parametrize(
    ("body", "what"),
    [
        ('thing_->create_publisher<std_msgs::msg::Bool>("x", 1);', "create_publisher(x)"),
        ('other::create_subscription("x", 1, callback);', "create_subscription(x)"),
    ],
)
def test_a_call_on_what_is_not_known(body, what):
    found = ros2_runs.cpp(body)
    assert notes(found) == [(what, "what it is called on is not known", [7])]


def test_a_subscription_on_what_is_not_known():
    found = ros1_runs.cpp('thing->subscribe("x", 1, callback); thing->subscribe(callback);')
    assert notes(found) == [("subscribe(x)", "what it is called on is not known", [6])]


@pytest.mark.parametrize(
    ("call", "source"),
    [
        ("other::join(this)", "; give the source of other too"),
        ("thing_->join(shared_from_this())", ""),
        ("JOIN_ALL(this)", ""),
        ("rclcpp::join(this)", ""),
    ],
)
def test_a_node_that_code_gets_which_is_not_here(call, source):
    found = ros2_runs.cpp(f"{call};")
    ((what, why, lines),) = notes(found)
    assert found.unresolved[0].cause is UnresolvedCause.MISSING_CODE
    assert (what, lines) == (f"{call.split('->')[-1].partition('(')[0]}()", [7])
    node = "its code is not here, and it gets the node /ns/n: it may give it endpoints"
    assert why == node + source


def test_what_takes_a_node_and_makes_nothing_is_not_noted():
    body = "rclcpp::executors::SingleThreadedExecutor e; e.add_node(shared_from_this()); e.spin();"
    assert notes(ros2_runs.cpp(body)) == []


def test_an_object_within_too_many_others():
    top = f"struct A {{ A(ros::NodeHandle nh) : a(nh) {{ {ADVERTISE} }} A a; }};"
    assert ("A", "is made within too many others, or within itself", [3]) in notes(
        ros1_runs.cpp("A a(nh);", top)
    )


def test_what_may_stand_in_a_container_that_unknown_code_gets_empty():
    body = "std::vector<std::string> names; other::fill(names); for (auto & n : names) {"
    found = ros1_runs.cpp(body + " nh.advertise<std_msgs::Bool>(n, 1); }")
    assert ros1_runs.names(found) == ["{n}"]
    body = 'std::vector<std::string> names{"a"}; names.shuffle(); for (auto & n : names) {'
    found = ros1_runs.cpp(body + " nh.advertise<std_msgs::Bool>(n, 1); }")
    assert ros1_runs.names(found) == ["a", "{n}"]


def test_more_combinations_than_are_kept_are_not_cut_to_some():
    parts = " ".join(f'std::string p{n} = x{n} ? "a{n}" : "b{n}";' for n in range(5))
    name = " + ".join(f"p{n}" for n in range(5))
    found = ros1_runs.cpp(f"{parts} nh.advertise<std_msgs::Bool>({name}, 1);")
    assert ros1_runs.names(found) == ["{many}"]


@pytest.fixture
def program(tmp_path):
    def run(source, **headers):
        for name, text in {"n.cpp": source, **headers}.items():
            (tmp_path / name.replace("_hpp", ".hpp")).write_text(text)
        files = WorkspaceSources(Workspace({"p": tmp_path}, [tmp_path]))
        return run_cpp((tmp_path / "n.cpp",), NodeSite(name="/n"), files)

    return run


def test_a_macro_of_a_header_that_makes_an_endpoint(program):
    header = "#define MAKE(name) \\\n  nh.advertise<std_msgs::Bool>(name, 1)\n"
    found = program('#include "m.hpp"\nint main() {\n  MAKE("x");\n}\n', m_hpp=header)
    (note,) = [note for note in found.unresolved if "MAKE" in note.why]
    assert (Path(note.evidence[0].file).name, note.evidence[0].line) == ("n.cpp", 3)


def test_what_cannot_be_read_of_a_header(program):
    header = "struct S {\n  int n : nh.subscribe(a, 1);\n};\n"
    found = program('#include "m.hpp"\nint main() {}\n', m_hpp=header)
    assert [(note.what, note.evidence[0].line) for note in found.unresolved] == [("m.hpp", 2)]


def test_more_files_than_are_read(program, monkeypatch):
    monkeypatch.setattr(symbol_table, "MAX_FILES", 1)
    found = program('#include "m.hpp"\nint main() {}\n', m_hpp="int x;\n")
    ((what, why, _),) = notes(found)
    assert (what, why.partition(":")[0]) == ("m.hpp", "not read")


def test_no_header_takes_the_place_of_the_programs_own_files(tmp_path, monkeypatch):
    monkeypatch.setattr(symbol_table, "MAX_FILES", 2)
    (tmp_path / "m.hpp").write_text("int x;\n")
    (tmp_path / "a.cpp").write_text('#include "m.hpp"\n')
    (tmp_path / "n.cpp").write_text("int main() {}\n")
    files = WorkspaceSources(Workspace({"p": tmp_path}, [tmp_path]))
    found = run_cpp((tmp_path / "a.cpp", tmp_path / "n.cpp"), NodeSite(name="/n"), files)
    assert found.unresolved == ()


def test_a_number_that_is_thrown_is_caught_where_it_may_be():
    body = f"try {{ try {{ throw f(); }} catch (int) {{ }} }} catch (...) {{ throw; }} {ADVERTISE}"
    found = ros1_runs.cpp(body, "int f() { return 1; }")
    assert (ros1_runs.names(found), found.unresolved) == (["x"], ())


def test_an_exception_that_ends_main_is_noted():
    found = ros1_runs.cpp(f'throw std::runtime_error("no"); {ADVERTISE}')
    why = "an exception ends it before all of it is run"
    assert notes(found) == [("main", why, [4])]
    assert found.unresolved[0].cause is UnresolvedCause.PARTLY_READ


@pytest.mark.parametrize("loop", ["for (auto x : load())", "for (int x = 0; x < load(); x++)"])
def test_how_many_items_a_loop_adds_is_not_known_where_its_rounds_are_not(loop):
    check = 'if (items.size() != 12) { throw std::runtime_error("no"); }'
    body = f"std::vector<int> items; {loop} {{ items.push_back(x); }}"
    body += f" try {{ {check} {ADVERTISE} }} catch (const std::exception & e) {{ return 1; }}"
    assert ros1_runs.names(ros1_runs.cpp(body)) == ["x"]


def test_macros_of_another_file_side_by_side_hide_nothing_behind_them():
    top = "#define ITEMS ITEM(rate, int, 5) ITEM(name, std::string, 0)\n"
    body = f"SET_UP(ITEMS)\n CHECK(nh, ITEMS)\n {ADVERTISE}"
    found = ros1_runs.cpp(body, top)
    assert ros1_runs.names(found) == ["x"]
    assert [note.what for note in found.unresolved] == ["CHECK()"]
