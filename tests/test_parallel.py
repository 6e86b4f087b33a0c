"""What runs the tests in several processes: each test once, and what ends a process is told."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from junit_report import read_report

SHARED = """
import os
from pathlib import Path
import pytest

@pytest.fixture(scope="session", autouse=True)
def whole(tmp_path_factory):
    yield
    Path(f"ended.{os.getpid()}").write_text(str(tmp_path_factory.getbasetemp()))

@pytest.fixture(scope="module")
def begun(tmp_path_factory, request):
    with Path(f"{request.module.__name__}.begun").open("a") as log:
        log.write(f"{os.getpid()} ")
"""
MEETING = """
def test_meet(begun):
    {} as pipe:
        {}

def test_again(begun):
    pass
"""
FILES = {
    "conftest.py": SHARED,
    "test_reads.py": MEETING.format("with open('pipe')", "assert pipe.read() == 'met'"),
    "test_writes.py": MEETING.format("with open('pipe', 'w')", "pipe.write('met')"),
    "test_bad.py": "def test_bad():\n    print('said by', 'it')\n    assert 1 == 2, 'not two'\n",
    "test_dies.py": """
import os

def test_good():
    pass

def test_dies():
    os._exit(7)

def test_behind_it():
    pass
""",
}

BAD_END = """
import pytest

@pytest.fixture(scope="session")
def bad():
    yield
    1 / 0

def test_it(bad):
    pass
"""


def run_in(folder, *options):
    environment = os.environ | {
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        "PYTHONPATH": str(Path(__file__).parent),
    }
    options = (
        "-p",
        "parallel",
        "--processes=2",
        f"--rootdir={folder}",
        "--junitxml=it.xml",
        *options,
    )
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *options],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("parallel")
    for name, text in FILES.items():
        (path / name).write_text(text)
    os.mkfifo(path / "pipe")
    return path


@pytest.fixture(scope="module")
def ran(folder):
    return run_in(folder)


def test_each_test_runs_once_and_a_dead_process_is_followed_by_another(ran, folder):
    outcomes = {
        f"{each.place}::{each.name}": each.outcome for each in read_report(folder / "it.xml")
    }
    assert outcomes == {
        "test_reads::test_meet": "passed",
        "test_reads::test_again": "passed",
        "test_writes::test_meet": "passed",
        "test_writes::test_again": "passed",
        "test_bad::test_bad": "failed",
        "test_dies::test_good": "passed",
        "test_dies::test_dies": "failed",
        "test_dies::test_behind_it": "passed",
    }
    assert ran.stdout.splitlines()[-1].startswith("2 failed, 6 passed")
    assert "the process of the test has ended with code 7" in ran.stdout
    assert ran.returncode == 1


def test_the_tests_of_a_file_share_its_fixtures_in_one_process(ran, folder):
    begun = {(folder / f"test_{name}.begun").read_text() for name in ("reads", "writes")}
    assert [len(each.split()) for each in begun] == [1, 1]


def test_the_output_of_a_test_is_its_own(ran):
    assert ran.stdout.count("said by it") == 1


def test_what_lasts_as_long_as_the_run_ends_in_each_process_and_shares_a_folder(ran, folder):
    ended = [path.read_text() for path in folder.glob("ended.*")]
    assert len(ended) == 2
    assert len(set(ended)) == 1


def test_a_run_may_stop_at_the_first_failure(folder):
    ran = run_in(folder, "-x", "test_bad.py", "test_reads.py")
    assert "stopping after 1 failures" in ran.stdout
    assert "test_meet" not in ran.stdout


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("import no_such_module", "No module named 'no_such_module'"),
        (BAD_END, "ZeroDivisionError"),
    ],
)
def test_what_fails_outside_of_a_test_fails_the_run(tmp_path, text, told):
    (tmp_path / "test_outside.py").write_text(text)
    ran = run_in(tmp_path)
    assert ran.returncode != 0
    assert told in ran.stdout + ran.stderr
