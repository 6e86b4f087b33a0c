"""Packages of ROS 2: components, entry points, plugins, targets of ament_cmake_auto."""

import pytest
from file_tree import package
from workspace_tree import evaluate_cmake, sources, workspace

from rtron.sources.workspace import ProgramLanguage, Workspace
from rtron.sources.workspace.python_package import read_python_package


def test_components_have_their_class_library_and_executable(tmp_path):
    cmake = """add_library(parts a.cpp)
    rclcpp_components_register_nodes(parts "ns::One" "ns::Two")
    rclcpp_components_register_node(parts PLUGIN "::ns::Three" EXECUTABLE three_node)"""
    found = evaluate_cmake(tmp_path, cmake).components
    assert [(c.class_name, c.library, c.executable) for c in found] == [
        ("ns::One", "parts", ""),
        ("ns::Two", "parts", ""),
        ("ns::Three", "parts", "three_node"),
    ]


def test_an_executable_of_a_component_is_its_library(tmp_path):
    cmake = (
        'add_library(parts a.cpp)\nrclcpp_components_register_node(parts PLUGIN "N" EXECUTABLE n)'
    )
    package(tmp_path / "p", {"CMakeLists.txt": cmake, "a.cpp": ""})
    found = workspace(tmp_path)
    assert found.executable("p", "n") == found.component("p", "N")
    program = found.component("p", "N")
    assert (program.entry, [path.name for path in program.sources]) == ("N", ["a.cpp"])
    assert found.component("p", "M") is None


def test_auto_targets_take_the_files_of_a_folder_and_link_the_libraries(tmp_path):
    cmake = """ament_auto_add_library(lib SHARED DIRECTORY src)
    ament_auto_add_library(other b.cpp)
    ament_auto_add_executable(exe a.cpp)"""
    (tmp_path / "src" / "inner").mkdir(parents=True)
    (tmp_path / "src" / "one.cpp").write_text("")
    (tmp_path / "src" / "inner" / "two.cc").write_text("")
    contents = evaluate_cmake(tmp_path, cmake)
    found = sources(contents)
    assert sorted(found["lib"]) == ["src/inner/two.cc", "src/one.cpp"]
    assert found["exe"] == ["a.cpp"]
    assert [target.links for target in contents.targets] == [(), ("lib",), ("lib", "other")]


def test_dependencies_of_ament_are_links(tmp_path):
    cmake = "add_executable(n a.cpp)\nament_target_dependencies(n PUBLIC rclcpp q)"
    (target,) = evaluate_cmake(tmp_path, cmake).targets
    assert target.links == ("rclcpp", "q")


def test_plugins_that_cmake_exports_are_found(tmp_path):
    cmake = "add_library(parts a.cpp)\npluginlib_export_plugin_description_file(core plugins.xml)"
    text = '<library path="parts"><class type="p::A" base_class_type="core::B"/></library>'
    package(tmp_path / "p", {"CMakeLists.txt": cmake, "a.cpp": "", "plugins.xml": text})
    found = workspace(tmp_path).plugin("p::A", "core::B")
    assert [path.name for path in found.program.sources] == ["a.cpp"]


SETUP = """from setuptools import setup
setup(name='p', entry_points={'console_scripts': [
    'talk = p.talker:main', 'listen=p.sub.listener:run', 'wrong'], 'other': ['x = p.y:z']})
"""
FORMATTED = """package = 'p'
setup(name=package, entry_points={'console_scripts': [
    f'talk = {package}.talker:main', 'listen = ' + package + '.listener:run']})
"""
CONFIG = "[options.entry_points]\nconsole_scripts =\n    talk = p.talker:main\n"


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("setup.py", SETUP, {"talk": ("p.talker", "main"), "listen": ("p.sub.listener", "run")}),
        ("setup.cfg", CONFIG, {"talk": ("p.talker", "main")}),
        ("setup.py", FORMATTED, {"talk": ("p.talker", "main"), "listen": ("p.listener", "run")}),
        ("setup.py", FORMATTED.replace("package = 'p'", "package = find()"),
         {"talk": (".talker", "main"), "listen": (".listener", "run")}),
        ("setup.py", f"setup(entry_points={{'console_scripts': [{'+'.join(['x'] * 5000)}]}})", {}),
        ("setup.py", "raise SystemExit(", {}),
        ("setup.cfg", "no section", {}),
    ],
)  # fmt: skip
def test_entry_points_are_read(tmp_path, name, text, expected):
    (tmp_path / name).write_text(text)
    assert read_python_package(tmp_path, "p").entry_points == expected


def test_an_entry_point_is_a_program(tmp_path):
    files = {"setup.py": SETUP, "p/__init__.py": "", "p/talker.py": "def main(): pass"}
    package(tmp_path / "p", files)
    program = workspace(tmp_path).executable("p", "talk")
    assert (program.language, program.entry) == (ProgramLanguage.PYTHON, "main")
    assert [path.name for path in program.sources] == ["talker.py"]
    assert workspace(tmp_path).executable("p", "listen") is None


def test_the_folder_of_a_package_may_have_another_name(tmp_path):
    files = {"setup.py": SETUP, "p/__init__.py": "", "p/talker.py": "def main(): pass"}
    package(tmp_path / "p", files).rename(tmp_path / "here")
    found = Workspace({"p": tmp_path / "here"}, [tmp_path])
    assert found.executable("p", "talk").sources == (tmp_path / "here" / "p" / "talker.py",)


def test_a_module_of_another_python_package_is_found(tmp_path):
    package(tmp_path / "p", {"p/__init__.py": "", "p/a.py": ""})
    package(tmp_path / "q", {"q/__init__.py": "", "q/b.py": ""})
    found = workspace(tmp_path).python_module("q.b", "p", tmp_path / "p/p/a.py")
    assert found == tmp_path / "q/q/b.py"
