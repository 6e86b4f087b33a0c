"""The script that runs the tests: what it chooses, when it stops, what it says at the end."""

import sys

import pytest
import run_tests
from run_tests import Group, Result, all_groups, print_summary, run_all

PASSING = "def test_good(): assert True\n"
FAILING = "def test_bad():\n    assert 1 == 2, 'two is not one'\n"


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Keep the reports of a run of its own, whose pytest loads no plugins: they take a second."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setattr(run_tests, "RESULTS", tmp_path / "results")
    return tmp_path


def group(folder, name, text, *, is_gate):
    path = folder / f"test_{name}.py"
    path.write_text(text)
    report = folder / "results" / f"{name}.xml"
    command = (sys.executable, "-m", "pytest", "-q", f"--rootdir={folder}", f"--junitxml={report}")
    return Group(name, (*command, str(path)), is_gate)


def test_each_file_of_tests_is_in_a_group():
    groups = {each.name: each.command for each in all_groups(is_long=False)}
    ros1 = named_in(groups["ros1"])
    assert left_out_of(groups["pure"]) == ros1 | named_in(groups["service"])
    assert left_out_of(groups["service"]) == ros1


def left_out_of(command):
    return {each.removeprefix("--ignore=") for each in command if each.startswith("--ignore=")}


def named_in(command):
    return {each for each in command if each.startswith("tests/")}


def test_the_groups_without_ros_come_first():
    groups = all_groups(is_long=False)
    gates = [each.is_gate for each in groups]
    assert gates == sorted(gates, reverse=True)
    assert [each.name for each in groups[:3]] == ["lint", "covered", "pure"]


def test_the_files_that_begin_exist():
    begin = run_tests.LONGEST_FIRST.read_text("utf-8").split()
    assert begin
    assert [path for path in begin if not (run_tests.ROOT / path).is_file()] == []


def test_the_longest_files_of_the_last_run_are_named(results, capsys):
    run_tests.RESULTS.mkdir()
    for name, seconds in (("one", 21), ("two", 60), ("three", 19)):
        case = f'<testcase classname="test_{name}" name="test_good" time="{seconds}"/>'
        (run_tests.RESULTS / f"{name}.xml").write_text(f"<testsuite>{case}</testsuite>")
    run_tests.print_durations()
    told = capsys.readouterr().out
    assert "for longest_first.txt:\ntest_two.py\ntest_one.py\n\n" in told
    assert "60.0 s  test_two::test_good" in told


def test_only_all_groups_have_the_long_tests():
    short, all_tests = (str(all_groups(is_long=each)) for each in (False, True))
    assert "not long" in short
    assert "not long" not in all_tests


def test_nothing_runs_behind_a_gate_that_failed(results, capfd):
    groups = [
        group(results, "first", FAILING, is_gate=True),
        group(results, "second", PASSING, is_gate=True),
    ]
    ran = run_all(groups)
    print_summary(ran, groups)
    lines = capfd.readouterr().out.splitlines()
    assert [each.name for each in ran] == ["first"]
    assert "second        -  did not run" in lines
    assert "FAILED test_first::test_bad: AssertionError: two is not one" in lines
    assert lines[-1] == "0 passed, 1 failed, 0 skipped"


def test_the_next_group_runs_behind_one_that_is_no_gate(results, capfd):
    groups = [
        group(results, "first", FAILING, is_gate=False),
        group(results, "second", PASSING, is_gate=False),
    ]
    ran = run_all(groups)
    print_summary(ran, groups)
    assert [(each.name, bool(each.code), each.counts) for each in ran] == [
        ("first", True, {"failed": 1}),
        ("second", False, {"passed": 1}),
    ]
    assert capfd.readouterr().out.splitlines()[-1] == "1 passed, 1 failed, 0 skipped"


def test_a_group_without_a_test_has_not_failed(results):
    assert run_all([group(results, "empty", "", is_gate=True)])[0].code == 0


def test_a_group_that_does_not_end_has_failed(results, monkeypatch):
    monkeypatch.setattr(run_tests, "LONGEST_GROUP", 0.1)
    hanging = Group("hanging", (sys.executable, "-c", "import time; time.sleep(60)"))
    assert run_all([hanging])[0].code != 0


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        ("src/rtron/policies/queues/fifo.py", "tests/policies/queues"),
        ("src/rtron/no_such_room/module.py", None),
        ("tests/packaging/test_run_tests.py", "tests/packaging/test_run_tests.py"),
        ("tests/packaging/test_that_is_gone.py", None),
        ("tests/packaging/small_app.py", "tests/packaging"),
    ],
)
def test_what_changed_names_its_tests(changed, tests):
    assert run_tests._tests_of(run_tests.Path(changed)) == tests


def test_a_summary_tells_the_time_of_each_group(capsys):
    print_summary([Result("lint", 0, 65.4), Result("ros1", 1, 600, {"passed": 7})], [])
    lines = capsys.readouterr().out.splitlines()
    assert lines[2:4] == [
        "lint       1:05  ok           ",
        "ros1      10:00  FAILED (1)   7 passed",
    ]
    assert lines[-2:] == ["in 11:05", "7 passed, 0 failed, 0 skipped"]
