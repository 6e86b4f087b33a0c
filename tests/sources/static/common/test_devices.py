"""What the source of a node opens, and whether it looks at the age of commands."""

import pytest
from file_tree import package

from cpu_time import growth
from rtron.sources.static.common import node_sources
from rtron.sources.static.common.devices import with_devices
from rtron.sources.workspace import Workspace
from rtron.vocabulary import InteractionGraph, Node

CMAKE = "project(robot)\nadd_executable(driver src/driver.cpp)\n"


@pytest.fixture
def facts(tmp_path):
    """Return what is found in a package with some files, whose node runs one of them."""

    def find(files, program="driver.py"):
        folder = package(tmp_path / "robot", files)
        node = Node(name="/driver", package="robot", executable=program)
        graph = InteractionGraph(app="a", nodes=(node, Node(name="/other", package="other")))
        workspace = Workspace({"robot": folder}, [tmp_path])
        return {
            (fact.kind.value, fact.value): (place.file.removeprefix(f"{folder}/"), place.line)
            for fact in with_devices(graph, workspace).wiring
            for place in fact.evidence
        }

    return find


def python(text):
    return {"scripts/driver.py": f"#!/usr/bin/env python3\n{text}\n"}


def cpp(text):
    return {"CMakeLists.txt": CMAKE, "src/driver.cpp": text}


@pytest.mark.parametrize(
    ("line", "device"),
    [
        ("import serial", "serial port"),
        ("from serial import Serial", "serial port"),
        ("import smbus2 as smbus", "I2C"),
        ("from adafruit_servokit import ServoKit", "servo driver"),
        ("import adafruit_bno055", "I2C"),
        ("    pwm = GPIO.PWM(18, 50)", "PWM output"),
        ("import spidev", "SPI"),
        ("    import RPi.GPIO as GPIO", "GPIO"),
        ("import can", "CAN"),
        ("import lcm", "LCM"),
        ("from lcm import LCM", "LCM"),
        ("from dynamixel_sdk import PortHandler", "servo bus"),
        ("import odrive", "motor controller"),
        ("import pyvesc", "VESC"),
        ("import moteus", "moteus"),
        ("from roboteq_driver import Roboteq", "Roboteq"),
        ("from osr_control.roboclaw import Roboclaw", "motor controller"),
        ("from Rosmaster_Lib import Rosmaster", "motor controller"),
        ("import easygopigo3 as easy", "motor controller"),
        ("from Raspi_MotorHAT import Raspi_MotorHAT", "motor controller"),
        ("from pymavlink import mavutil", "vehicle link"),
        ("from xarm.wrapper import XArmAPI", "vendor SDK"),
        ("from pymodbus.client import ModbusTcpClient", "Modbus"),
        ("self.robot.connect((host, 30002))", "TCP link"),
        ("    link = socket.create_connection(address)", "TCP link"),
    ],
)
def test_devices_of_python(facts, line, device):
    assert facts(python(line)) == {("device", device): ("scripts/driver.py", 2)}


@pytest.mark.parametrize(
    ("line", "device"),
    [
        ("cfsetispeed(&options, B115200);", "serial port"),
        ('#include "serial/serial.h"', "serial port"),
        ("# include <linux/can.h>", "CAN"),
        ("#include <linux/i2c-dev.h>", "I2C"),
        ("#include <ethercat.h>", "EtherCAT"),
        ("#include <franka/robot.h>", "vendor SDK"),
        ("  if (connect(fd, (struct sockaddr *)&address, size) < 0) {", "TCP link"),
        ("#include <modbus/modbus.h>", "Modbus"),
    ],
)
def test_devices_of_cpp(facts, line, device):
    assert facts(cpp(f"\n{line}\nint main() {{}}\n"), "driver") == {
        ("device", device): ("src/driver.cpp", 2)
    }


@pytest.mark.parametrize(
    "text",
    [
        "# import serial",
        "import serialization",
        "from vesc_msgs.msg import VescState",
        "from vesc_ackermann import ackermann_to_vesc",
        "x = 'import serial'",
        "import candy",
        "from std_msgs.msg import String",
        "",
    ],
)
def test_what_is_no_device(facts, text):
    assert facts(python(text)) == {}


@pytest.mark.parametrize(
    "text",
    [
        "// #include <linux/can.h>\n",
        "/*\n#include <linux/can.h>\n*/\n",
        "#include <vesc_msgs/State.h>\n",
        "#include <termios.h>\n",
        "#include <mqtt/async_client.h>\n",
        "int main() { tcsetattr(port, TCSANOW, &options); }\n",
    ],
)
def test_what_is_no_device_in_cpp(facts, text):
    assert facts(cpp(text), "driver") == {}


@pytest.mark.parametrize(
    ("line", "how"),
    [
        ("import paho.mqtt.client as mqtt", "MQTT"),
        ("start = websockets.serve(handler, '', 9002)", "WebSocket server"),
        ("from flask import Flask", "web server"),
        ("sock.bind(('', 5000))", "TCP or UDP socket"),
        ("LINK = 'udpin:0.0.0.0:14550'", "MAVLink link"),
        ("pilot.connect(system_address='udp://:14540')", "MAVLink link"),
        ("async with websockets.connect(url) as link:", "WebSocket client"),
        ("link = websocket.WebSocketApp(url, on_message=heard)", "WebSocket client"),
        ("link = socketio.Client()", "WebSocket client"),
        ("import zmq", "ZeroMQ"),
        ("import redis", "Redis"),
        ("from firebase_admin import db", "cloud service"),
        ("from telegram.ext import Application", "chat"),
    ],
)
def test_sockets(facts, line, how):
    assert facts(python(line)) == {("socket", how): ("scripts/driver.py", 2)}


@pytest.mark.parametrize(
    ("line", "how"),
    [
        ("from pygame import joystick", "joystick"),
        ("from inputs import get_gamepad", "joystick"),
        ("pad = open('/dev/input/js0', 'rb')", "joystick"),
        ("termios.tcsetattr(sys.stdin, termios.TCSADRAIN, old)", "keyboard"),
        ("app = QApplication(sys.argv)", "window"),
        ("root = tk.Tk()", "window"),
        ("key = input('w, a, s, d: ')", "keyboard"),
    ],
)
def test_what_a_person_commands_by(facts, line, how):
    assert facts(python(line)) == {("operator", how): ("scripts/driver.py", 2)}


@pytest.mark.parametrize("line", ["from PyQt6 import QtCore", "from tkinter import messagebox"])
def test_parts_of_a_window_without_an_application_are_no_person(facts, line):
    assert facts(python(line)) == {}


def test_the_settings_of_a_serial_port_are_no_keyboard(facts):
    assert facts(python("termios.tcsetattr(fd, termios.TCSADRAIN, old)")) == {}


@pytest.mark.parametrize("address", ["udpin:127.0.0.1:14550", "udpout:10.0.0.2:14550", "udp://:80"])
def test_a_link_to_this_machine_alone_or_to_another_is_no_door(facts, address):
    assert facts(python(f"LINK = '{address}'")) == {}


@pytest.mark.parametrize(
    "line",
    [
        "if now - self.last_cmd_time > 0.5:",
        "self.cmd_vel_timeout = 0.5",
        "if elapsed > CONTROL_LOOP_TIMEOUT_MS:",
        "status.cmd_ts = now",
        "self.watchdog = Timer()",
        "if self.lastCommandTime < now:",
        "declare_parameter('velocity_timeout', 2.0)",
        "if now - self.prev_cmd_time_ > limit:",
        "self.t_last_twist = now()",
        "self.claw.SetTimeout(0x80, 5)",
        "self.port.write(b'SET COMM_TIMEOUT 500')",
    ],
)
def test_the_age_of_a_command(facts, line):
    assert facts(python(line)) == {("command_age", "age of a command"): ("scripts/driver.py", 2)}


@pytest.mark.parametrize(
    "line",
    [
        "dt = now - self.last_time",
        "serial = open(timeout=1)",
        "# watchdog",
        "last_cmd = cmd",
        "x = driver_timeout",
        "velodyne_timeout = 1",
        "dt = now - self.last_control_time",
        '"""No watchdog yet."""',
        "motor_time -= 1",
        "self.port.setTimeout(1)",
        "SETTIMEOUT = 14",
    ],
)
def test_what_is_no_age_of_a_command(facts, line):
    assert facts(python(line)) == {}


def test_a_path_of_devices_is_no_comment_of_python(facts):
    found = facts(python("import serial\nx = glob('/dev/serial/*')\nself.cmd_timeout = 1"))
    assert ("command_age", "age of a command") in found


@pytest.mark.parametrize(
    "line",
    [
        "if ((now() - last_cmd_time_).seconds() > 0.5) stop();",
        "if (Time::now() - last_twist_stamp_ > limit_) stop();",
        'log("/*"); bool late = now() - last_command_received_ > limit_;',
    ],
)
def test_the_age_of_a_command_in_cpp(facts, line):
    assert facts(cpp(line), "driver").keys() == {("command_age", "age of a command")}


@pytest.mark.parametrize("line", ["// watchdog", "/* watchdog */", "/* watchdog"])
def test_comments_of_cpp(facts, line):
    assert facts(cpp(line), "driver") == {}


@pytest.mark.parametrize(
    "unit",
    [
        "\n",
        " ",
        "from ",
        "from a import b,",
        "#include ",
        "import ",
        "/*",
        '"',
        "last_",
        "cmd_time",
        ".",
        '\\"',
        "\\'",
    ],
)
@pytest.mark.parametrize("language", ["python", "cpp"])
def test_hostile_text_takes_time_in_proportion(facts, unit, language):
    write, program = {"python": (python, "driver.py"), "cpp": (cpp, "driver")}[language]
    sizes = [write(unit * (size // len(unit))) for size in (20_000, 80_000)]
    assert growth(lambda files: facts(files, program), *sizes) < 12


def test_a_module_of_the_package_counts_too(facts):
    files = python("from robot.motor import Motor") | {
        "setup.py": "from setuptools import setup\nsetup(name='robot', packages=['robot'])\n",
        "robot/__init__.py": "",
        "robot/motor.py": "import os\nimport serial\n",
    }
    assert facts(files) == {("device", "serial port"): ("robot/motor.py", 2)}


def test_a_header_and_the_source_that_is_called_like_it_count_too(facts):
    files = cpp('#include "robot/port.hpp"\n') | {
        "include/robot/port.hpp": "class Port;\n",
        "src/port.cpp": "#include <linux/can.h>\n",
    }
    assert facts(files, "driver") == {("device", "CAN"): ("src/port.cpp", 1)}


def test_files_that_use_each_other_end(facts):
    files = python("import a") | {
        "scripts/a.py": "import b\nimport serial\n",
        "scripts/b.py": "import a\n",
    }
    assert facts(files) == {("device", "serial port"): ("scripts/a.py", 2)}


def test_so_many_files_are_searched(facts, monkeypatch):
    monkeypatch.setattr(node_sources, "MAX_FILES", 1)
    files = python("import a\nimport can") | {"scripts/a.py": "import serial\n"}
    assert facts(files) == {("device", "CAN"): ("scripts/driver.py", 3)}


def test_of_a_program_that_is_not_there_nothing_is_told(facts):
    assert facts(python("import serial"), "ghost") == {}


_TOOLS = {
    "robot/__init__.py": "",
    "robot/tools/__init__.py": "from .ports import Port, find_port\nfrom .angles import wrap\n",
    "robot/tools/ports.py": "import serial\n",
    "robot/tools/angles.py": "import math\n",
}


@pytest.mark.parametrize(
    ("line", "is_used"),
    [
        ("from robot.tools import wrap", False),
        ("from robot.tools import (\n    wrap,\n)", False),
        ("from robot.tools import wrap, Port", True),
        ("from robot.tools import (\n    wrap,\n    Port,\n)", True),
        ("from robot.tools import wrap\nfrom robot.tools import Port", True),
        ("import robot.tools", True),
        ("from robot.tools import unknown", True),
    ],
)
def test_a_package_that_hands_names_on_opens_what_the_node_takes_of_it(facts, line, is_used):
    found = facts({**_TOOLS, **python(line)})
    assert (("device", "serial port") in found) is is_used


def test_a_package_that_is_called_like_a_vendor_is_no_hardware(facts):
    assert facts(python("from niryo_robot_utils import sentry_init")) == {}
    assert ("device", "vendor SDK") in facts(python("from pyniryo import NiryoRobot"))
