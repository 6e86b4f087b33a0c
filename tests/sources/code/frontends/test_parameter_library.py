"""Code that generate_parameter_library makes: a node's parameters as a struct."""

import pytest
import ros2_runs
from file_tree import write
from ros2_runs import UNLAUNCHED, settings, site

from rtron.sources.code.frontends.parameter_library import generated_code
from rtron.sources.code.ir import SourceLanguage
from rtron.sources.code.program_runner import run_cpp, run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.ros2.app import read_ros2_workspace

DESCRIPTION = """driver:
  topics:
    image: {type: string, description: the input}
    masks: {type: string_array, default_value: [near, far]}
    result: {type: string, default_value: "out\\"put", validation: {not_empty<>: []}}
  rate: {type: int, default_value: 5}
  gains:
    __map_joints: {p: {type: double}}
"""
CPP = """create_subscription<M>(params_.topics.image, 1, callback);
    for (const auto & mask : params_.topics.masks) { create_publisher<M>(mask, 1); }
    create_publisher<M>(params_.topics.result, params_.rate);"""
MEMBERS = """driver::ParamListener listener_{get_node_parameters_interface()};
    driver::Params params_ = listener_.get_params();"""
PYTHON = """
listener = parameters.ParamListener(self)
config = listener.get_params()
self.create_subscription(Bool, config.topics.image, print, 1)
for mask in config.topics.masks:
    self.create_publisher(Bool, mask, 1)
self.create_publisher(Bool, config.topics.result, config.rate)
"""
IMPORT = "from robot.driver_parameters import driver as parameters"
NAMES = ["/ns/camera", "/ns/near", "/ns/far", '/ns/out"put']


def workspace(tmp_path, build, program, description=DESCRIPTION):
    write(
        tmp_path / "robot",
        {
            "package.xml": "<package><name>robot</name></package>",
            "config/driver.yaml": description,
            "robot/__init__.py": "",
            **build,
            **program,
        },
    )
    return WorkspaceSources(read_ros2_workspace([tmp_path]))


def scan_cpp(tmp_path, description=DESCRIPTION, header="robot/driver_parameters.hpp", **given):
    top = f"#include <{header}>"
    text = ros2_runs.CPP.format(top=top, body=CPP, members=MEMBERS)
    cmake = "generate_parameter_library(driver_parameters # target\n  config/driver.yaml)"
    files = workspace(tmp_path, {"CMakeLists.txt": cmake}, {"main.cpp": text}, description)
    return run_cpp((tmp_path / "robot/main.cpp",), site(**given), files)


def scan_python(tmp_path, **given):
    body = "\n".join(f"        {line}" for line in PYTHON.splitlines())
    text = ros2_runs.PYTHON.format(top=IMPORT, body=body, members="")
    setup = """generate_parameter_module(
        "driver_parameters",  # the module
        "config/driver.yaml")"""
    files = workspace(tmp_path, {"setup.py": setup}, {"robot/main.py": text})
    return run_python(tmp_path / "robot/robot/main.py", site(**given), files, "main")


@pytest.mark.parametrize("scan", [scan_cpp, scan_python])
def test_a_struct_has_what_the_launch_and_the_description_say(tmp_path, scan):
    found = scan(tmp_path, settings=settings(topics__image="camera"))
    assert ros2_runs.names(found) == NAMES
    assert {p.name: p.value for p in found.parameters if p.name != "use_sim_time"} == {
        "topics.image": "camera",
        "topics.masks": ("near", "far"),
        "topics.result": 'out"put',
        "rate": 5,
    }
    assert found.unresolved == ()


@pytest.mark.parametrize("scan", [scan_cpp, scan_python])
def test_without_a_launch_what_has_no_default_is_open(tmp_path, scan):
    assert ros2_runs.names(scan(tmp_path, **UNLAUNCHED))[0] == "/{~topics.image}"


def test_a_whole_number_is_the_default_of_a_double(tmp_path):
    described = (
        "robot: {p: {type: double, default_value: 1}, q: {type: double_array, default_value: [1]}}"
    )
    code = generated_code(described.encode(), tmp_path / "p.yaml", SourceLanguage.PYTHON).decode()
    assert "declare_parameter(at + 'p', 1.0)" in code
    assert "declare_parameter(at + 'q', [1.0])" in code


def test_the_header_may_be_named_without_its_package(tmp_path):
    found = scan_cpp(
        tmp_path, header="driver_parameters.hpp", settings=settings(topics__image="camera")
    )
    assert ros2_runs.names(found) == NAMES


@pytest.mark.parametrize(
    "description",
    ["driver: [", "", "driver: {'a b': {type: string}, x: {type: [1]}}", "&a [*a, *a]", "'): {}"],
)
def test_a_description_that_is_none_ends_nothing(tmp_path, description):
    found = scan_cpp(tmp_path, description)
    assert len(ros2_runs.names(found)) >= 2
