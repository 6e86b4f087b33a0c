"""Programs, plugins, headers and modules of a workspace."""

import os
from pathlib import Path

import pytest
from file_tree import package
from workspace_tree import workspace

from rtron.sources.workspace import ProgramLanguage, program_digest, read_workspace
from rtron.sources.workspace.package_files import is_in_build_files, list_files
from rtron.vocabulary import Trust

PYTHON = "#!/usr/bin/env python3\n"
NODELETS = (
    '<library path="lib/libnodes"><class name="p/N" type="ns::N"'
    ' base_class_type="nodelet::Nodelet"/></library>'
)
EXPORT = '<export><nodelet plugin="${prefix}/n.xml"/></export>'


def test_a_program_has_the_libraries_of_its_package_and_reaches_others(tmp_path):
    cmake = (
        "find_package(catkin REQUIRED COMPONENTS q gone)\n"
        "add_library(low l.cpp)\nadd_library(mid m.cpp)\ntarget_link_libraries(mid low mid)\n"
        "add_executable(n n.cpp)\ntarget_link_libraries(n mid ${catkin_LIBRARIES} pthread)"
    )
    names = ("l.cpp", "m.cpp", "n.cpp")
    package(tmp_path / "p", {"CMakeLists.txt": cmake, **dict.fromkeys(names, "")})
    package(tmp_path / "q", {})
    program = workspace(tmp_path).executable("p", "n")
    assert [path.name for path in program.sources] == ["n.cpp", "m.cpp", "l.cpp"]
    assert program.language is ProgramLanguage.CPP


def test_neither_package_nor_program_is_an_error(tmp_path):
    package(tmp_path / "p", {})
    found = workspace(tmp_path)
    assert found.executable("p", "n") is None
    assert found.executable("q", "n") is None
    assert found.contents("q") is None
    assert found.library("libn.so") is None
    assert found.messages("q") == frozenset()


@pytest.mark.parametrize(
    ("files", "expected", "language"),
    [
        ({"n": PYTHON}, "n", ProgramLanguage.PYTHON),
        ({"a/n": PYTHON, "scripts/n": PYTHON}, "scripts/n", ProgramLanguage.PYTHON),
        ({"bin/n": PYTHON, "nodes/n": PYTHON}, "nodes/n", ProgramLanguage.PYTHON),
        ({"n": "#!/bin/sh\n"}, "n", ProgramLanguage.SHELL),
        ({"n": "#!/usr/bin/env bash\n"}, "n", ProgramLanguage.SHELL),
        ({"n": "#!/usr/bin/perl\n"}, "n", ProgramLanguage.OTHER),
        ({"n": "", "other": PYTHON}, None, None),
        ({"n": "print()"}, None, None),
        ({".git/n": PYTHON}, None, None),
        ({"n.py": PYTHON}, None, None),
    ],
)
def test_scripts_are_found_by_name(tmp_path, files, expected, language):
    path = package(tmp_path / "p", files)
    program = workspace(tmp_path).executable("p", "n")
    assert (program and program.sources) == (expected and (path / expected,))
    assert (program and program.language) is language


def test_without_modes_an_ending_makes_a_script(tmp_path):
    path = package(tmp_path / "p", {"n.py": "", "n.yaml": ""})
    assert workspace(tmp_path).executable("p", "n.py").sources == (path / "n.py",)
    assert workspace(tmp_path).executable("p", "n.yaml") is None


def test_an_installed_script_has_its_new_name(tmp_path):
    cmake = "install(PROGRAMS s/a.py RENAME n DESTINATION bin)"
    path = package(tmp_path / "p", {"CMakeLists.txt": cmake, "s/a.py": ""})
    assert workspace(tmp_path).executable("p", "n").sources == (path / "s/a.py",)


@pytest.mark.parametrize(
    ("cmake", "asked"),
    [
        ("DIRECTORY x/config y/maps DESTINATION share/${PROJECT_NAME}", "config/n.yaml"),
        ("DIRECTORY x/config/ DESTINATION share/p/settings/", "settings/n.yaml"),
        ("DIRECTORY x/ DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}", "config/n.yaml"),
        ("FILES x/config/n.yaml DESTINATION share/p", "n.yaml"),
        ("FILES x/config/n.yaml DESTINATION share/p RENAME m.yaml", "m.yaml"),
        ("DIRECTORY x DESTINATION share/p FILES_MATCHING PATTERN *.yaml", "x/config/n.yaml"),
    ],
)
def test_a_shared_file_lies_where_cmake_installs_it_from(tmp_path, cmake, asked):
    files = {"x/config/n.yaml": "", "y/config/n.yaml": "", "CMakeLists.txt": f"install({cmake})"}
    path = package(tmp_path / "p", files)
    assert workspace(tmp_path).installed_source(path / asked) == path / "x/config/n.yaml"


@pytest.mark.parametrize(
    "cmake",
    [
        "",
        "install(DIRECTORY x/config DESTINATION share/other)",
        "install(DIRECTORY x/config DESTINATION etc)",
        "install(DIRECTORY x/config DESTINATION share/p/settings)",
        "install(DIRECTORY z/config DESTINATION share/p)",
    ],
)
def test_which_of_two_files_is_installed_is_not_guessed(tmp_path, cmake):
    files = {"x/config/n.yaml": "", "y/config/n.yaml": "", "CMakeLists.txt": cmake}
    asked = package(tmp_path / "p", files) / "config/n.yaml"
    assert workspace(tmp_path).installed_source(asked) == asked


LEFT_OUT = {
    "option(ARM)\nif(ARM)\nadd_executable(n n.cpp)\nendif()": "if(ARM)",
    "option(S x ON)\nif(NOT S)\nadd_executable(n n.cpp)\nendif()": "if(NOT S)",
    "if(UNIX)\nadd_library(o n.cpp)\nelse()\nadd_executable(n n.cpp)\nendif()": "else()",
    "option(S x ON)\nif(S)\nreturn()\nendif()\nadd_executable(n n.cpp)": "return()",
    "option(S x ON)\nif(S)\ninclude(all)\nreturn()\nendif()\nadd_subdirectory(in)": "return()",
    "option(X)\nif(X)\ninstall(PROGRAMS n.py RENAME n)\nendif()": "if(X)",
    ("option(X)\nif(X)\nadd_executable(m n.cpp)\n"
     "set_target_properties(m PROPERTIES OUTPUT_NAME n)\nendif()"): "if(X)",
}  # fmt: skip


@pytest.mark.parametrize("cmake", LEFT_OUT)
def test_a_program_that_the_defaults_leave_out_counts_and_is_noted(tmp_path, cmake):
    files = {"in/CMakeLists.txt": "add_executable(n ../n.cpp)", "n.cpp": "", "n.py": ""}
    path = package(tmp_path / "p", {"CMakeLists.txt": cmake, **files})
    found = workspace(tmp_path)
    assert found.executable("p", "n") == found.executable("p", "n")
    (source,) = found.executable("p", "n").sources
    assert source in {path / "n.cpp", path / "n.py"}
    (note,) = found.unresolved()
    assert (note.what, LEFT_OUT[cmake] in note.why) == ("program p/n", True)
    line = 1 + cmake.split("\n").index(LEFT_OUT[cmake])
    assert [(each.file, each.line) for each in note.evidence] == [(f"{path}/CMakeLists.txt", line)]
    assert found.executable("p", "none") is None


def test_what_stands_behind_a_return_under_no_condition_is_never_built(tmp_path):
    cmake = "add_executable(m n.cpp)\nreturn()\nadd_executable(n n.cpp)\n"
    path = package(tmp_path / "p", {"CMakeLists.txt": cmake, "n.cpp": ""})
    found = workspace(tmp_path)
    assert found.executable("p", "n") is None
    assert found.executable("p", "m").sources == (path / "n.cpp",)


def test_a_component_that_the_defaults_leave_out_is_noted(tmp_path):
    cmake = (
        "option(X)\nif(X)\nadd_library(l n.cpp)\n"
        'rclcpp_components_register_node(l PLUGIN "N" EXECUTABLE n)\nendif()'
    )
    package(tmp_path / "p", {"CMakeLists.txt": cmake, "n.cpp": ""})
    found = workspace(tmp_path)
    assert found.component("p", "N").entry == "N"
    assert [note.what for note in found.unresolved()] == ["program p/N"]


def test_the_programs_of_a_package_have_names(tmp_path):
    cmake = (
        "add_executable(a n.cpp)\nadd_library(l n.cpp)\ninstall(PROGRAMS n.cpp RENAME b)\n"
        "rclcpp_components_register_node(l PLUGIN N EXECUTABLE c)"
    )
    setup = "setup(entry_points={'console_scripts': ['d = p.d:main']})"
    files = {"CMakeLists.txt": cmake, "n.cpp": "", "setup.py": setup, "e": PYTHON}
    package(tmp_path / "p", files)
    assert workspace(tmp_path).program_names("p") == ("a", "b", "c", "d", "e")
    assert workspace(tmp_path).program_names("q") == ()


@pytest.mark.parametrize(
    "description",
    [
        NODELETS,
        f"<class_libraries>{NODELETS}</class_libraries>",
        f'<?xml version="1.0"?>\n{NODELETS}\n{NODELETS}',
    ],
)
def test_nodelets_are_found_by_name_and_type(tmp_path, description):
    files = {"CMakeLists.txt": "add_library(nodes n.cpp)", "n.cpp": "", "n.xml": description}
    path = package(tmp_path / "p", files, EXPORT)
    for name in ("p/N", "ns::N"):
        plugin = workspace(tmp_path).nodelet(name)
        assert (plugin.plugin_class.type, plugin.plugin_class.base) == ("ns::N", "nodelet::Nodelet")
        assert plugin.program.sources == (path / "n.cpp",)
    assert workspace(tmp_path).nodelet("p/M") is None


def test_plugins_are_found_by_tag_and_base_class(tmp_path):
    package(tmp_path / "p", {"n.xml": NODELETS}, EXPORT.replace("nodelet ", "nav "))
    found = workspace(tmp_path)
    assert found.plugin("p/N", "nav").program is None
    assert found.plugin("p/N", "nodelet::Nodelet").plugin_class == found.plugins("nav")[0]
    assert found.plugins("other") == ()


@pytest.mark.parametrize("name", ["libx.so", "x", "lib/libx", "/opt/lib/libx.so.1"])
def test_a_library_is_found_by_its_file(tmp_path, name):
    cmake = "add_library(t x.cpp)\nset_target_properties(t PROPERTIES OUTPUT_NAME x)"
    path = package(tmp_path / "p", {"CMakeLists.txt": cmake, "x.cpp": ""})
    assert workspace(tmp_path).library(name).sources == (path / "x.cpp",)


@pytest.mark.parametrize(
    ("description", "why"),
    [
        ("<library>", "not XML"),
        ('<!DOCTYPE x [<!ENTITY e "e">]><library path="&e;"/>', "not XML"),
        (None, "is not there"),
    ],
)
def test_a_bad_description_is_noted(tmp_path, description, why):
    package(tmp_path / "p", {} if description is None else {"n.xml": description}, EXPORT)
    found = workspace(tmp_path)
    assert found.nodelet("p/N") is None
    assert why in found.unresolved()[0].why


def test_headers_are_looked_for_near_then_in_the_package_then_everywhere(tmp_path):
    cmake = "include_directories(inc)"
    p = package(
        tmp_path / "p",
        {"CMakeLists.txt": cmake, "src/n.cpp": "", "src/a.h": "", "inc/a.h": "", "inc/b.h": ""},
    )
    q = package(tmp_path / "q", {"include/q/c.h": "", "include/b.h": ""})
    (tmp_path.parent / "secret.h").write_text("")
    found, source = workspace(tmp_path), p / "src" / "n.cpp"
    assert found.header("a.h", source) == p / "src" / "a.h"
    assert found.header("b.h", source) == p / "inc" / "b.h"
    assert found.header("q/c.h", source) == q / "include" / "q" / "c.h"
    assert found.header("../src/a.h", source) == p / "src" / "a.h"
    for text in ("none.h", "/etc/passwd", "../../../secret.h", "a\0b", "x" * 5000):
        assert found.header(text, source) is None


def test_python_modules_are_looked_for_near_then_in_packages(tmp_path):
    setup = "d = generate_distutils_setup(packages=['p'], package_dir={'': 'lib'})\n"
    p = package(tmp_path / "p", {"setup.py": setup, "lib/p/__init__.py": "", "scripts/near.py": ""})
    q = package(tmp_path / "q", {"setup.py": "setup(package_dir={'q': 'py/q'})", "py/q/m.py": ""})
    r = package(tmp_path / "r", {"src/r.py": "", "setup.py": "("})
    cmake = {"tools/__init__.py": "", "tools/m.py": "", "launch/a.py": ""}
    s = package(tmp_path / "s", {"CMakeLists.txt": "ament_python_install_package(tools)", **cmake})
    found, script = workspace(tmp_path), p / "scripts" / "n"
    assert found.python_module("tools.m", "p", script) == s / "tools/m.py"
    assert found.python_module("launch.a", "p", script) is None
    assert found.python_module("p", "p", script) == p / "lib/p/__init__.py"
    assert found.python_module("near", "p", script) == p / "scripts" / "near.py"
    assert found.python_module("q.m", "p", script) == q / "py/q/m.py"
    assert found.python_module("r", "p", script) == r / "src/r.py"
    for dotted in ("", "rospy", "p.none", "..etc", "a" * 5000):
        assert found.python_module(dotted, "p", script) is None


@pytest.mark.parametrize(
    ("files", "is_there"),
    [
        ({"setup.py": 'f"camera_node = {name}.camera_node:main"'}, True),
        ({"sub/CMakeLists.txt": "add_executable(camera_node a.cpp)"}, True),
        ({"cmake/all.cmake": "foreach(name camera_node other)"}, True),
        ({"setup.cfg": "[entry_points]\nconsole_scripts =\n  camera_node = a.b:c\n"}, True),
        ({"setup.py": "setup(name='camera_node', packages=['camera_node'])"}, False),
        ({"CMakeLists.txt": "project(camera_node)"}, False),
        ({"xCMakeLists.txt": "add_executable(camera_node a.cpp)"}, False),
        ({"CMakeLists.txt": "# add_executable(camera_node a.cpp)"}, False),
        ({"CMakeLists.txt": "add_executable(camera_nodes a.cpp)"}, False),
        ({"CMakeLists.txt": "add_executable(my_camera_node a.cpp)"}, False),
        ({"CMakeLists.txt": "install(PROGRAMS camera_node.py)"}, False),
        ({"camera.py": "camera_node"}, False),
        ({}, False),
    ],
)
def test_a_program_is_named_in_build_files_or_not(tmp_path, files, is_there):
    folder = package(tmp_path / "pkg", files)
    assert is_in_build_files(list_files(folder, ()), "camera_node") is is_there


def test_no_build_file_names_a_program_that_no_file_can_have(tmp_path):
    folder = package(tmp_path / "pkg", {"setup.py": "setup()"})
    assert not is_in_build_files(list_files(folder, ()), "\ud800reader")


def test_messages_name_what_is_made_of_them(tmp_path):
    package(tmp_path / "p", {"msg/A.msg": "", "srv/B.srv": "", "action/C.action": "", "msg/D": ""})
    made = "A B BRequest BResponse CAction CGoal CResult CFeedback"
    actions = "CActionGoal CActionResult CActionFeedback"
    assert workspace(tmp_path).messages("p") == {*made.split(), *actions.split()}


def test_trust_says_where_a_package_lies(tmp_path):
    package(tmp_path / "own" / "p", {})
    package(tmp_path / "other" / "q", {})
    found = read_workspace([tmp_path / "own"], {"ROS_PACKAGE_PATH": str(tmp_path)})
    assert found.trust("p") is Trust.OWN
    assert found.trust("q") is Trust.THIRD_PARTY
    assert found.trust("r") is Trust.UNKNOWN


def test_the_package_of_a_file(tmp_path):
    path = package(tmp_path / "p", {"src/a.cpp": ""})
    assert workspace(tmp_path).package_of(path / "src" / "a.cpp") == "p"
    assert workspace(tmp_path).package_of(tmp_path / "a.cpp") is None


def test_a_digest_changes_with_content_and_definitions(tmp_path):
    cmake = "add_executable(n a.cpp)\n"
    path = package(tmp_path / "p", {"CMakeLists.txt": cmake, "a.cpp": ""})
    first = program_digest(workspace(tmp_path).executable("p", "n"))
    assert first == program_digest(workspace(tmp_path).executable("p", "n"))
    (path / "a.cpp").write_text("x")
    second = program_digest(workspace(tmp_path).executable("p", "n"))
    (path / "CMakeLists.txt").write_text(cmake + "add_definitions(-DX)")
    assert len({first, second, program_digest(workspace(tmp_path).executable("p", "n"))}) == 3
    program = workspace(tmp_path).executable("p", "n")
    (path / "a.cpp").unlink()
    assert program_digest(program) not in {first, second}


def test_a_manifest_that_is_no_xml_is_noted(tmp_path):
    package(tmp_path / "p", {"package.xml": "<"})
    found = workspace(tmp_path)
    assert found.manifest("p").depends == ()
    assert "not XML" in found.unresolved()[0].why


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("<description>Drives\n   wheels</description>", "Drives wheels"),
        ("<description><b>Drives</b> two <p>wheels</p></description>", "Drives two wheels"),
        ("<description/>", ""),
        ("", ""),
        (f"<description>{'x' * 5000}</description>", "x" * 4096),
    ],
)
def test_a_manifest_describes_its_package(tmp_path, written, read):
    package(tmp_path / "p", {"package.xml": f"<package><name>p</name>{written}</package>"})
    assert workspace(tmp_path).manifest("p").description == read


@pytest.mark.skipif("RTRON_APPS" not in os.environ, reason="RTRON_APPS names no folder of apps")
@pytest.mark.parametrize(
    ("app", "name", "type", "source"),
    [
        ("AutoRally/autorally@c2692f2", "autorally_control", "gpsWaypoint", ".cpp"),
        ("ROBOTIS-GIT/turtlebot3_autorace@391144a", "turtlebot3_autorace_core",
         "core_node_controller", "core_node_controller"),
        ("ros-planning/navigation@9ad6441", "move_base", "move_base", "move_base.cpp"),
    ],
)  # fmt: skip
def test_programs_of_real_apps(app, name, type, source):
    found = read_workspace([Path(os.environ["RTRON_APPS"]) / app], {})
    program = found.executable(name, type)
    assert any(path.name.endswith(source) for path in program.sources)
