"""The GitHub Action and the pre-commit hooks, with their own steps, on an app in a repository."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from small_app import LAUNCH_FILE, write_app

ROOT = Path(__file__).parents[2]
ACTION = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
HOOKS = {each["id"]: each for each in yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())}
SHELL = ("bash", "--noprofile", "--norc", "-eo", "pipefail", "-c")
"""How GitHub runs a step with `shell: bash`."""
RTRON = f'#!/bin/sh\nexec "{sys.executable}" -m rtron "$@"\n'


def write_program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)


class Runner:
    """Runs the steps of the action as GitHub does, but those that use other actions."""

    def __init__(self, folder, **inputs):
        self.repository, self.temp = folder / "repository", folder / "temp"
        self.temp.mkdir(parents=True)
        write_app(self.repository)
        write_program(self.temp / "rtron" / "bin" / "rtron", RTRON)
        defaults = {name: each.get("default", "") for name, each in ACTION["inputs"].items()}
        self.inputs = defaults | {name.replace("_", "-"): text for name, text in inputs.items()}
        self.outputs, self.stdout = {}, ""
        self.summary = self.temp / "summary.md"

    def run(self):
        """Run the steps; return the exit code of the first that fails, 0 if none does."""
        for step in ACTION["runs"]["steps"]:
            if "run" in step and step["name"] != "Install RTron":
                code = self._run_step(step)
                if code:
                    return code
        return 0

    def _run_step(self, step):
        output = self.temp / "output"
        output.write_text("")
        environment = {name: self._value(text) for name, text in step["env"].items()}
        environment |= {
            "RUNNER_TEMP": str(self.temp),
            "GITHUB_OUTPUT": str(output),
            "GITHUB_STEP_SUMMARY": str(self.summary),
        }
        command, environment = [*SHELL, step["run"]], os.environ | environment
        ran = subprocess.run(
            command,
            cwd=self.repository,
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
            check=False,
        )
        self.stdout += ran.stdout
        self.outputs |= dict(line.split("=", 1) for line in output.read_text().splitlines())
        return ran.returncode

    def _value(self, text):
        kind, name = re.fullmatch(
            r"\$\{\{ (inputs|steps\.scan\.outputs)\.([\w-]+) \}\}", text
        ).groups()
        return self.inputs[name] if kind == "inputs" else self.outputs[name]


def test_no_step_puts_an_input_into_a_script():
    for step in ACTION["runs"]["steps"]:
        assert "${{" not in step.get("run", "")


@pytest.fixture(scope="module")
def scanned(tmp_path_factory):
    """Run the action once on the app, with two arguments of its launch file."""
    folder = tmp_path_factory.mktemp("scanned")
    runner = Runner(folder, launch=LAUNCH_FILE, arguments="first:=1\nsecond:=2\n")
    runner.code = runner.run()
    return runner


def test_the_action_fails_on_a_finding_and_leaves_its_reports(scanned):
    assert scanned.code == 1
    sarif = json.loads(Path(scanned.outputs["sarif"]).read_text())
    (result,) = sarif["runs"][0]["results"]
    uri = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert (scanned.repository / uri).is_file()
    assert json.loads(Path(scanned.outputs["report"]).read_text())["findings"]
    assert "/cmd_vel" in scanned.summary.read_text()
    paths = {name: each["value"] for name, each in ACTION["outputs"].items()}
    assert {name: scanned._value(text) for name, text in paths.items()} == {
        name: scanned.outputs[name] for name in paths
    }


def test_arguments_may_stand_on_lines_of_their_own(scanned):
    report = scanned.summary.read_text()
    assert "launch argument first" in report
    assert "launch argument second" in report


def test_no_line_of_the_report_is_a_command_to_the_runner(scanned):
    said = scanned.stdout.splitlines()
    begin = next(at for at, line in enumerate(said) if line.startswith("::stop-commands::"))
    end = said.index(f"::{said[begin].removeprefix('::stop-commands::')}::")
    assert any("/cmd_vel" in line for line in said[begin:end])
    assert not any("/cmd_vel" in line for line in said[:begin] + said[end:])
    assert all(line.startswith("    ") for line in scanned.summary.read_text().splitlines())


def test_what_the_baseline_has_does_not_fail_again(scanned, tmp_path):
    again = Runner(tmp_path, launch=LAUNCH_FILE, baseline=scanned.outputs["report"])
    assert again.run() == 0


@pytest.mark.parametrize(
    "inputs",
    [
        {"launch": "$(touch injected)"},
        {"launch": LAUNCH_FILE, "baseline": "none.json"},
        {"launch": LAUNCH_FILE, "fail_on": "sometimes"},
    ],
)
def test_a_wrong_input_fails_the_job_with_2(inputs, tmp_path):
    runner = Runner(tmp_path, **inputs)
    assert runner.run() == 2
    assert not (runner.repository / "injected").exists()


def run_hook(folder, hook, *files, args=()):
    """Run a hook as pre-commit does: its entry, its arguments, then the files that fit."""
    write_program(folder / "bin" / "rtron", RTRON)
    named = files if hook.get("pass_filenames", True) else ()
    command = [*shlex.split(hook["entry"]), *args, *named]
    environment = os.environ | {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_the_scan_hook_fails_where_two_nodes_drive(tmp_path):
    write_app(tmp_path)
    hook = HOOKS["rtron-scan"]
    ran = run_hook(tmp_path, hook, args=("--launch", LAUNCH_FILE))
    assert (ran.returncode, ran.stderr) == (1, "")
    assert "/cmd_vel" in ran.stdout
    names = [path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.launch")]
    assert all(re.search(hook["files"], name) for name in [*names, "src/robot/scripts/drive.py"])


@pytest.mark.parametrize(
    ("file", "matches"),
    [
        *((name, True) for name in ("CMakeLists.txt", "package.xml", "setup.cfg", "rtron.toml")),
        *((f"a/b/{name}", True) for name in ("CMakeLists.txt", "package.xml", "app.launch.py")),
        *((name, True) for name in ("scripts/drive", "a/nodes/drive", "robot.urdf", "msg/A.msg")),
        *((name, False) for name in ("README.md", "MyCMakeLists.txt", "a/scripts/LICENSE.txt")),
    ],
)
def test_the_scan_hook_runs_for_what_a_scan_reads(file, matches):
    assert bool(re.search(HOOKS["rtron-scan"]["files"], file)) is matches


def test_the_check_hook_looks_at_each_plan(tmp_path):
    hook = HOOKS["rtron-check"]
    (tmp_path / "a").mkdir()
    good, wrong = tmp_path / "a" / "rtron.yaml", tmp_path / "rtron.yaml"
    shutil.copy(ROOT / "src/rtron/planning/missions/red_light.yaml", good)
    wrong.write_text("app: x\ngrnc: []\n")
    assert all(re.search(hook["files"], name) for name in ("rtron.yaml", "a/rtron.yaml"))
    assert run_hook(tmp_path, hook, good).returncode == 0
    ran = run_hook(tmp_path, hook, good, wrong)
    assert ran.returncode == 2
    assert "grnc" in ran.stderr
