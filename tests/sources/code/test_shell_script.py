import pytest

from rtron.sources.code.shell_script import read_shell_script


def read(tmp_path, text):
    path = tmp_path / "start.sh"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_shell_script(path)


@pytest.mark.parametrize(
    ("line", "path", "args"),
    [
        ("rosrun pkg node", "pkg/node", ("rosrun",)),
        ("rosrun pkg node _rate:=5 a:=b x", "pkg/node", ("rosrun", "_rate:=5", "a:=b", "x")),
        ("roslaunch pkg file.launch", "pkg/file.launch", ()),
        ("roslaunch pkg file.launch a:=1 b:='x y'", "pkg/file.launch", ("a:=1", "b:=x y")),
        ("roslaunch --wait -p 11311 pkg file.launch", "pkg/file.launch", ()),
        ("roslaunch /abs/file.launch a:=1", "/abs/file.launch", ("a:=1",)),
        ("roslaunch one.launch", "one.launch", ()),
        ("cd /x && nohup rosrun pkg node &", "pkg/node", ("rosrun",)),
        ("if true; then rosrun pkg node; fi", "pkg/node", ("rosrun",)),
        ("A=1 B=2 exec rosrun pkg node > /dev/null 2>&1", "pkg/node", ("rosrun",)),
        ("/opt/ros/noetic/bin/rosrun pkg node", "pkg/node", ("rosrun",)),
        ("rosrun \\\n  pkg \\\n  node", "pkg/node", ("rosrun",)),
    ],
)
def test_what_is_started(tmp_path, line, path, args):
    found = read(tmp_path, f"#!/bin/sh\n{line}\n")
    (started,) = found.runtime_starts
    assert (started.path, started.args) == (path, args)
    assert started.evidence[0].line == 2
    assert (found.declarations, found.unresolved) == ((), ())


@pytest.mark.parametrize(
    "line",
    [
        "rosrun $PKG node",
        "rosrun pkg ${TYPE}",
        "roslaunch $(rospack find x)/a.launch",
        "roslaunch `pwd` x",
        "rostopic pub $TOPIC std_msgs/String x",
        "roslaunch",
    ],
)
def test_words_with_variables_are_not_known(tmp_path, line):
    found = read(tmp_path, line)
    assert found.runtime_starts == found.declarations == ()
    assert len(found.unresolved) == 1


def test_what_rostopic_publishes(tmp_path):
    found = read(tmp_path, "rostopic pub -r 10 --once /go std_msgs/Bool 'data: true'\n")
    (declared,) = found.declarations
    assert (str(declared.kind), declared.name, declared.type) == ("publish", "/go", "std_msgs/Bool")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "# rosrun pkg node",
        "echo rosrun pkg node",
        "rostopic echo /x",
        "rosrun pkg",
        "which roslaunch",
        b"\xff\xfe\x00 " * 100,
        "\\\n" * 5,
    ],
)
def test_what_starts_nothing(tmp_path, text):
    found = read(tmp_path, text)
    assert (found.runtime_starts, found.declarations) == ((), ())


def test_quotes_that_do_not_end_leave_the_rest(tmp_path):
    found = read(tmp_path, "echo 'rosrun x\nrosrun pkg node\n")
    assert [started.path for started in found.runtime_starts] == ["pkg/node"]


def test_a_script_that_cannot_be_read_is_noted(tmp_path):
    assert len(read_shell_script(tmp_path / "none.sh").unresolved) == 1


@pytest.mark.parametrize(
    "line",
    [
        'eval "$(decode x)"',
        'python3 -c "import rospy"',
        "source extra.sh",
        ". ./extra.sh",
        "$COMMAND now",
        "bash -c 'rosrun a b'",
        "echo x | base64 -d | sh",
        'echo "$(rosrun a b)"',
    ],
)
def test_code_that_is_not_seen_is_noted(tmp_path, line):
    script = tmp_path / "run.sh"
    script.write_text(f"#!/bin/bash\n{line}\n")
    (note,) = read_shell_script(script).unresolved
    assert note.evidence[0].line == 2


@pytest.mark.parametrize(
    "line", ["source /opt/ros/noetic/setup.bash", ". devel/setup.sh", "X=$(date)", "echo $X"]
)
def test_usual_lines_are_not_noted(tmp_path, line):
    script = tmp_path / "run.sh"
    script.write_text(f"#!/bin/bash\n{line}\n")
    assert read_shell_script(script).unresolved == ()
