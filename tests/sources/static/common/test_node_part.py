"""Why nothing is read of a node: its package, or its program, is not here, or not understood."""

from dataclasses import replace

import pytest

from rtron.sources.declaration import Declaration, DeclarationKind, NodeInterface, NodeSite
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.models import ROS2_LIBRARY, load_models
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.node_part import NodePart, node_parts
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, Resolution, UnresolvedCause, UnresolvedItem

EXPORT = "<export><nodelet plugin='${prefix}/n.xml'/></export>"
CMAKE = """add_executable(driver a.cpp)
add_executable(lost gone.cpp)
add_executable(generated ${GENERATED})
mystery_executable(odd a.cpp)
add_library(parts a.cpp)
rclcpp_components_register_nodes(parts "own::Camera")
rclcpp_components_register_nodes(absent "own::Absent")
install(PROGRAMS tool.pl RENAME tool DESTINATION lib/own)
"""
SETUP = "setup(entry_points={'console_scripts': ['away = own.away:main']})"
PLUGINS = """<library path="lib/libgone"><class name="own/Filter" type="own::Filter"
 base_class_type="nodelet::Nodelet"/></library>"""


@pytest.fixture
def packages(tmp_path):
    """Return a workspace with a package of the user's own, and one of somebody else."""
    files = {"CMakeLists.txt": CMAKE, "setup.py": SETUP, "a.cpp": "", "tool.pl": "#!/usr/bin/perl"}
    for package in ("src/own", "elsewhere/other"):
        folder = tmp_path / package
        folder.mkdir(parents=True)
        (folder / "package.xml").write_text(
            f"<package><name>{folder.name}</name>{EXPORT}</package>"
        )
    for name, text in {**files, "n.xml": PLUGINS}.items():
        (tmp_path / "src/own" / name).write_text(text)
    return Workspace(find_packages([tmp_path], {}), [tmp_path / "src"])


def note(packages, package, program, *, ros=2, container="", args=()):
    place = Evidence(file="app.launch", line=3)
    site = NodeSite(name="/n", ros=ros, args=args)
    node = AppNode(site=site, package=package, type=program, evidence=place, container=container)
    models = load_models(ROS2_LIBRARY) if ros > 1 else load_models()
    *_, part = node_parts(node, packages, models)
    (item,) = part.interface.unresolved
    assert item.evidence == (place,)
    return item


WHYS = {
    ("own", "drivr"): ("makes no program of this name: did you mean driver?", "own/drivr"),
    ("own", "x"): ("choose from away, driver, generated, lost, tool", "own/x"),
    ("own", "lost"): ("none of the sources of this program: generated or missing", ""),
    ("own", "generated"): ("none of the sources of this program: generated or missing", ""),
    ("own", "odd"): (
        "name its program in a way that is not understood, or behind a return() under no condition",
        "",
    ),
    ("own", "away"): ("the module own.away of this program is not", ""),
    ("own", "tool"): ("what this program is written in is not read", ""),
    ("other", "x"): ("no source of it is here, and no model", ""),
    ("none", "x"): ("its package is not here: give the folder of its source too", ""),
}


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(("package", "program"), WHYS)
def test_a_program_that_is_not_read_has_a_reason(packages, package, program, ros):
    item = note(packages, package, program, ros=ros)
    why, missing = WHYS[package, program]
    assert item.why.endswith(why)
    assert item.missing == missing
    assert bool(item.nearest) is bool(missing)
    assert item.why.endswith(item.nearest)
    is_own = item.why.startswith(("its package is here, and", "the build files of its package"))
    assert is_own is (package == "own")
    assert (item.cause is UnresolvedCause.MISSING_SOURCE) is not is_own


@pytest.mark.parametrize(
    ("build_type", "is_read"),
    [("ament_cargo", False), ("ament_python", True), ("ament_cmake", True), ("catkin", True)],
)
def test_a_package_that_another_tool_builds_does_not_lack_a_program(tmp_path, build_type, is_read):
    folder = tmp_path / "src" / "own"
    folder.mkdir(parents=True)
    manifest = f"<package><name>own</name><export><build_type>{build_type}</build_type></export>"
    (folder / "package.xml").write_text(f"{manifest}</package>")
    item = note(Workspace(find_packages([tmp_path], {}), [tmp_path / "src"]), "own", "driver")
    assert bool(item.missing) is is_read
    assert (item.cause is UnresolvedCause.PARTLY_READ) is not is_read


@pytest.mark.parametrize(
    ("command", "is_open"),
    [
        ("add_custom_target(firmware ALL COMMAND make -C firmware)", True),
        ("add_custom_command(OUTPUT reader DEPENDS reader.go COMMAND go build)", True),
        ("ExternalProject_Add(vendored GIT_REPOSITORY https://host/vendored)", True),
        ("FetchContent_MakeAvailable(vendored)", True),
        ("corrosion_import_crate(MANIFEST_PATH Cargo.toml)", True),
        ("build_all_examples()", True),
        ("add_executable(${UNSET} a.cpp)", True),
        ("add_library(${UNSET} a.cpp)", False),
        ("add_custom_target(docs COMMAND doxygen)", False),
        ("add_custom_target(headers DEPENDS a.h)", False),
        ("add_custom_command(OUTPUT a.h COMMAND python make.py)", False),
        ("add_custom_command(TARGET driver POST_BUILD COMMAND cp a b)", False),
        ("find_package(roscpp REQUIRED)", False),
        ("message(STATUS hello)\nament_package()\nenable_testing()", False),
        ("function(mine)\nendfunction()\nmine()", False),
    ],
)
def test_a_package_that_makes_programs_by_commands_of_its_own_does_not_lack_one(
    tmp_path, command, is_open
):
    folder = tmp_path / "src" / "own"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>own</name></package>")
    (folder / "CMakeLists.txt").write_text(
        f"project(own)\nadd_executable(driver a.cpp)\n{command}\n"
    )
    item = note(Workspace(find_packages([tmp_path], {}), [tmp_path / "src"]), "own", "reader")
    assert item.missing == ("" if is_open else "own/reader")
    assert is_open == item.why.startswith("commands that are not followed make programs")


def test_a_component_that_its_package_does_not_register(packages):
    item = note(packages, "own", "own::Camra", container="/box")
    assert item.why.endswith("registers no class of this name: did you mean own::Camera?")
    assert item.missing == "own/own::Camra"


def test_a_component_of_a_library_that_its_package_does_not_make(packages):
    item = note(packages, "own", "own::Absent", container="/box")
    assert item.why.endswith("registers it in a library that is not made there")
    assert not item.missing


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("own/Filtr", "registers no class of this name: did you mean own/Filter?"),
        ("own/Filter", "its library lib/libgone is built by none that is, or without sources"),
        ("other/Filter", "no source of it is here, and no model"),
    ],
)
def test_a_nodelet_that_is_not_there(packages, name, why):
    item = note(packages, "nodelet", "nodelet", ros=1, args=("load", name, "manager"))
    assert item.why.endswith(why)


SENT = Declaration(kind=DeclarationKind.PUBLISH, name="/a")
OPEN = replace(SENT, name="/{a}", resolution=Resolution.SYMBOLIC)


@pytest.mark.parametrize(
    ("declared", "notes", "is_cut"),
    [
        ((), (), False),
        ((SENT,), (), False),
        ((SENT, OPEN), (None,), False),
        ((SENT,), (UnresolvedCause.LIMIT,), True),
        ((OPEN,), (), True),
        ((OPEN, replace(SENT, kind=DeclarationKind.SERVICE)), (), True),
        ((replace(SENT, kind=DeclarationKind.SERVICE),), (None,), False),
        ((replace(SENT, implicit=True),), (UnresolvedCause.PARTLY_READ,), True),
    ],
)
def test_a_source_that_tells_not_all_is_cut(declared, notes, is_cut):
    site = NodeSite(name="/n", ros=2)
    task = InterpretationTask(kind=TaskKind.CPP, sources=(), site=site)
    node = AppNode(site=site, package="p", type="x", evidence=Evidence(file="a", line=1))
    unresolved = tuple(UnresolvedItem(what="x", why="?", cause=cause) for cause in notes)
    interface = NodeInterface(declarations=declared, unresolved=unresolved)
    part = NodePart(node=node, owner="/n", task=task, interface=interface)
    assert part.is_cut is is_cut
    assert not replace(part, task=None).is_cut
