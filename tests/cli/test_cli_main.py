import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

import rtron
from rtron import __version__
from rtron.cli.command_registry import COMMANDS, GROUPS, load_command
from rtron.cli.commands.scan import Level
from rtron.sources.graph_json import GraphFile
from rtron.vocabulary import FindingLevel

ALL = [name for table in (COMMANDS, GROUPS) for names in table.values() for name in names]
EVERY = [load_command(name) for names in COMMANDS.values() for name in names]

HEAVY = {"rich", "pydantic", "yaml", "lxml", "rtron.vocabulary", "rtron.sources", "rtron.findings"}
SOURCE = str(Path(rtron.__file__).parents[1])
MODULE = (sys.executable, "-m", "rtron")


def run(*arguments, **keys):
    """Run the real command; it is cut off from this terminal's settings."""
    environment = {"PATH": os.environ["PATH"], "LANG": "C.UTF-8", "PYTHONPATH": SOURCE}
    environment |= keys.pop("env", {})
    command = [*MODULE, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, env=environment, check=False, **keys)


def test_the_module_is_the_command(graph_file):
    ran = run("scan", graph_file, "--format", "json")
    assert (ran.returncode, ran.stderr) == (1, b"")
    assert json.loads(ran.stdout)["schema"] == "rtron.risks/2"


def test_a_pipe_gets_80_columns_and_no_colour(graph_file):
    ran = run("scan", graph_file, env={"TERM": "xterm-256color"})
    assert b"\x1b" not in ran.stdout
    assert max(map(len, ran.stdout.decode().splitlines()[3:-3])) <= 80


def test_a_pipe_that_takes_ascii_only_gets_it(graph_file):
    ran = run("scan", graph_file, "--level", "auditor", env={"PYTHONIOENCODING": "ascii"})
    assert ran.returncode == 1
    assert b"/keyboard (third party) -+-> /cmd_vel ---> /base" in ran.stdout
    graph_file.write_text(graph_file.read_text().replace("/base", "/b\u00e4se"))
    assert b"/b\\xe4se" in run("scan", graph_file, env={"PYTHONIOENCODING": "ascii"}).stdout


def test_a_pipe_that_closes_early_is_no_error(graph_file):
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as closed:
        ran = subprocess.run([*MODULE, "scan", graph_file], stdout=closed, stderr=-1, check=False)
    assert (ran.returncode, ran.stderr) == (1, b"")


def test_a_usage_message_that_nobody_reads_is_no_error_of_ours():
    reader, writer = os.pipe()
    os.close(reader)
    code = (
        "import sys; from rtron.cli import main as cli\n"
        "sys.excepthook = lambda *_: sys.stdout.write(str(_))\n"
        "sys.argv[1:] = ['nothing']; cli.main()"
    )
    with os.fdopen(writer, "wb") as closed:
        ran = subprocess.run([sys.executable, "-c", code], stdout=-1, stderr=closed, check=False)
    assert (ran.returncode, ran.stdout) == (2, b"")


def break_connection(_):
    ours, theirs = socket.socketpair()
    with ours:
        theirs.close()
        ours.sendall(b"x")


def test_another_pipe_that_breaks_is_an_error(rtron, graph_file, monkeypatch):
    monkeypatch.setattr(GraphFile, "read", break_connection)
    ran = rtron("scan", graph_file)
    assert (ran.code, ran.out) == (2, "")
    assert "a connection ended: [Errno 32] Broken pipe" in ran.err


def test_help_that_nobody_reads_is_no_error():
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as closed:
        ran = subprocess.run([*MODULE, "scan", "-h"], stdout=closed, stderr=-1, check=False)
    assert ran.stderr == b""


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_disk_is_2(graph_file, unbuffered):
    command, environ = [*MODULE, "scan", graph_file], {"PYTHONUNBUFFERED": unbuffered}
    with open("/dev/full", "wb") as full:  # noqa: PTH123 - a device
        ran = subprocess.run(command, stdout=full, stderr=-1, check=False, env=os.environ | environ)
    assert ran.returncode == 2
    assert b"error: standard output: No space left on device" in ran.stderr
    assert b"Traceback" not in ran.stderr


def test_a_graph_from_standard_input(graph_file):
    assert run("scan", "-", input=graph_file.read_bytes()).returncode == 1
    assert run("scan", "-", input=b"\xff").returncode == 2


def test_ctrl_c_is_130(rtron, graph_file, monkeypatch):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(GraphFile, "read", interrupted)
    ran = rtron("scan", graph_file)
    assert (ran.code, ran.out, ran.err) == (130, "", "")


def test_the_version(rtron):
    assert rtron("--version").out == f"rtron {__version__}\n"


def test_help_names_every_command_and_shows_an_example_of_each(rtron):
    text = rtron("--help").out
    for command in EVERY:
        name = command.__name__.replace("_", "-")
        assert name in text
        page = rtron(name, "-h")
        assert page.code == 0
        assert f"$ rtron {name}" in page.out
        assert max(map(len, page.out.splitlines())) <= 80


def test_the_list_of_commands_says_what_their_own_help_says(rtron):
    for command, summary in summaries():
        assert command.__doc__.splitlines()[0] == summary
    for name, summary in (pair for each in GROUPS.values() for pair in each.items()):
        assert load_command(name).info.help == summary
        assert rtron(name, "--help").code == 0


def summaries():
    return [
        (load_command(name), summary)
        for each in COMMANDS.values()
        for name, summary in each.items()
    ]


def test_help_loads_nothing_that_only_a_command_needs():
    declared = "".join(f"load_command({name!r});" for name in ALL)
    loaded = loaded_modules(f"from rtron.cli.command_registry import load_command;{declared}")
    assert loaded & {"rtron.cli.commands.scan", "rtron.cli.commands.model"}
    assert loaded & HEAVY == set()


@pytest.mark.parametrize("words", [("--help",), ("scan", "--help"), ("serve", "-h"), ("scna",)])
def test_help_is_shown_without_what_only_a_command_needs(words):
    words = ["rtron", *words]
    loaded = loaded_modules(f"import sys, rtron.__main__; sys.argv={words}; rtron.__main__.main()")
    assert "rtron.cli.main" in loaded
    assert loaded & HEAVY == set()


def loaded_modules(code):
    show = "lambda: sys.stderr.write('\\n' + ' '.join(sys.modules))"
    shown = f"import atexit, sys; atexit.register({show})"
    ran = subprocess.run(
        [sys.executable, "-c", f"{shown};{code}"], capture_output=True, text=True, check=False
    )
    return set(ran.stderr.splitlines()[-1].split())


def test_the_levels_are_those_of_findings():
    assert [each.value for each in Level] == [each.value for each in FindingLevel]


@pytest.mark.parametrize("after", ["typer", "rtron.cli.main"])
def test_ctrl_c_while_it_loads_is_130_without_a_word(after, tmp_path):
    hook = f"""
import builtins, os, signal
load = builtins.__import__
def load_and_interrupt(name, *rest, **keys):
    loaded = load(name, *rest, **keys)
    if name == {after!r}:
        os.kill(os.getpid(), signal.SIGINT)
    return loaded
builtins.__import__ = load_and_interrupt
"""
    (tmp_path / "sitecustomize.py").write_text(hook)
    ran = run("--help", env={"PYTHONPATH": f"{tmp_path}:{SOURCE}"})
    assert (ran.returncode, ran.stdout, ran.stderr) == (130, b"", b"")


def test_examples_in_help_are_commands_that_exist(rtron):
    options = {
        word.split("=")[0]
        for command in EVERY
        for row in command.__doc__.splitlines()
        if row.strip().startswith("$ rtron")
        for word in row.split("|")[0].split(">")[0].split()
        if word.startswith("--")
    }
    names = (command.__name__.replace("_", "-") for command in EVERY)
    pages = "".join(rtron(name, "--help").out for name in names)
    assert {option for option in options if option not in pages} == set()


def test_no_arguments_show_the_help(rtron):
    ran = rtron()
    assert ran.code == 2
    assert "Usage: rtron" in ran.out + ran.err


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("rtron sc", b"scan"),
        ("rtron --ver", b"--version"),
        ("rtron scan --env-", b"--env-all"),
        ("rtron explain gr", b"gr_st"),
        ("rtron explain Pre", b"Preemption"),
    ],
)
def test_completion(words, offered):
    variables = {"_RTRON_COMPLETE": "complete_bash", "COMP_WORDS": words}
    variables["COMP_CWORD"] = str(len(words.split()) - 1)
    assert offered in run(env=variables).stdout
