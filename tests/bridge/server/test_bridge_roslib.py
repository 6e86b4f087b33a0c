"""roslibjs, as pages have it, under node: it signs in, hears, publishes, calls, and is refused."""

import json
import os
import shutil
import struct
import subprocess
from pathlib import Path

import pytest
from bridge_parts import TOKEN, WALL
from harness import Process, wait_for
from memory_bridge import memory_bridge

from rtron.messages import Encoding
from rtron.messages.common.json_encoder import encode_json

CLIENT = Path(__file__).parents[1] / "nodes" / "roslib_client.mjs"


def library():
    """Return where roslib is: in the folder that ROSLIB names, or npm's global one."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        pytest.skip("node and npm are not installed")
    root = (
        os.environ.get("ROSLIB")
        or subprocess.run(
            [npm, "root", "--global"], capture_output=True, text=True, check=True
        ).stdout.strip()
    )
    found = Path(root) / "roslib" / "dist" / "RosLib.js"
    if not found.exists():
        pytest.skip("roslib is not installed: npm install --global roslib")
    return found


@pytest.fixture
def bridge():
    with memory_bridge() as running:
        yield running


@pytest.fixture
def page(bridge, tmp_path):
    started = []

    def start(address="/", token=""):
        command = ("node", CLIENT, library(), f"ws://127.0.0.1:{bridge.port}{address}", token)
        process = Process(command, os.environ, tmp_path / "page.log")
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()


def heard(process, what):
    rows = (json.loads(line) for line in process.log.splitlines() if line.startswith("["))
    return [each[1] for each in rows if each[0] == what]


def wait_for_heard(process, what, count=1):
    wait_for(lambda: len(heard(process, what)) >= count or process.ended, what=what)
    assert len(heard(process, what)) >= count, process.log
    return heard(process, what)


def chat(bridge, text):
    body = text.encode()
    message = struct.pack("<II", 4 + len(body), len(body)) + body
    bridge.in_loop(lambda: bridge.nodes["web"].listener.on_message("/chat", message))


@pytest.mark.parametrize(
    ("address", "token"), [(f"/?token={TOKEN}", ""), ("/", TOKEN)], ids=["address", "auth"]
)
def test_a_page_does_what_it_may(bridge, page, address, token):
    process = page(address, token)
    assert wait_for_heard(process, "topics") == [["/cmd_vel", "/chat", "/odom"]]
    done = bridge.nodes["web"].done
    assert {each[0] for each in done} == {"read", "advertise", "publish", "call"}
    (published,) = (each for each in done if each[0] == "publish")
    assert published[2].endswith(b"from a page")
    chat(bridge, "grüße")
    assert wait_for_heard(process, "heard") == [{"data": "grüße"}]
    (request,) = (each[1] for each in done if each[0] == "call")
    _, response = bridge.in_loop(lambda: bridge.bridge._types.service("std_srvs/SetBool"))
    given = {"success": True, "message": "on"}
    answer = encode_json(response, Encoding.ROS1, given, WALL, 1000)[0]
    bridge.in_loop(lambda: bridge.nodes["web"].listener.on_answer(request.number, answer))
    assert wait_for_heard(process, "answer") == [given]


def test_a_page_is_told_what_it_may_not(bridge, page):
    process = page(f"/?token={TOKEN}")
    assert "web may not call /shutdown" in wait_for_heard(process, "refused")
    assert "web may not read /scan" in wait_for_heard(process, "status", 2)
    assert heard(process, "leak") == []


@pytest.mark.parametrize("compression", ["png", "cbor"])
def test_a_page_takes_a_picture_and_cbor(bridge, page, compression):
    process = page(f"/?token={TOKEN}#{compression}")
    wait_for_heard(process, "topics")
    chat(bridge, "grüße")
    assert wait_for_heard(process, "heard") == [{"data": "grüße"}]


@pytest.mark.parametrize("token", ["", "rtb_wrong"])
def test_a_page_without_a_token_is_told_to_sign_in(bridge, page, token):
    process = page("/", token)
    told = wait_for_heard(process, "status")
    assert told == ["that token is nobody's" if token else told[0]]
    assert "sign in first" in told[0] or token
    wait_for_heard(process, "close")
    assert bridge.nodes == {}
