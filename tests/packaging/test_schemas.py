"""The schemas that editors take fit the files that people have, and no others."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from demo_runs import ROOM
from docs_files import stale
from docs_schemas import documents
from jsonschema import Draft202012Validator

from rtron.demos.cases import CASES, RunConditions
from rtron.demos.cases.case_study import merge_decisions
from rtron.demos.runtime.instrumentation import write_decided_plan
from rtron.demos.runtime.isolation import first_party_packages, launch_file, third_party_packages
from rtron.errors import InputError
from rtron.planning import missions
from rtron.planning.plan_file.json_schema import PLAN_SCHEMA_URL, plan_json_schema
from rtron.sources.ignores import config_json_schema, read_config
from rtron.workflows.scan import RULE_NAMES

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
PLAN, CONFIG = plan_json_schema(), config_json_schema(RULE_NAMES)
MISSIONS = sorted(Path(next(iter(missions.__path__))).glob("*.yaml"))


def blocks(language):
    """Return the examples of a language in the docs, each with the name of its page."""
    pattern = re.compile(rf"```{language}\n(.*?)```", re.DOTALL)
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    return [(page.name, text) for page in pages for text in pattern.findall(page.read_text())]


EXCERPTS = {"settings.md"}
"""Pages whose examples leave out what a plan needs."""


def plan_blocks():
    """Return the examples that are plans, or sections of plans."""
    examples = ((page, text) for page, text in blocks("yaml") if page not in EXCERPTS)
    documents = ((page, yaml.safe_load(text)) for page, text in examples)
    return [(page, plan) for page, plan in documents if plan.keys() <= PLAN["properties"].keys()]


def errors(schema, document):
    found = Draft202012Validator(schema).iter_errors(document)
    return [f"{error.json_path}: {error.message}" for error in found]


@pytest.mark.parametrize("schema", [PLAN, CONFIG], ids=["plan", "config"])
def test_a_schema_is_one(schema):
    Draft202012Validator.check_schema(schema)


def test_the_schemas_in_the_repository_are_fresh_and_where_plans_say():
    assert stale(documents()) == {}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    raw = project["urls"]["Source"].replace("github.com", "raw.githubusercontent.com")
    path = PLAN_SCHEMA_URL.removeprefix(f"{raw}/main/")
    assert path != PLAN_SCHEMA_URL
    assert json.loads((ROOT / path).read_text("utf-8")) == PLAN


def test_a_stale_schema_is_named(tmp_path):
    assert {path.name for path in stale(documents(tmp_path))} == {
        "rtron.bridge.json",
        "rtron.graph.json",
        "rtron.plan.json",
        "rtron.toml.json",
    }


@pytest.mark.parametrize("path", MISSIONS, ids=lambda path: path.stem)
def test_the_missions_fit(path):
    assert errors(PLAN, yaml.safe_load(path.read_text("utf-8"))) == []


def test_the_plans_of_the_docs_fit():
    found = plan_blocks()
    pages = {page for page, _ in found}
    assert {"actions.md", "missions.md", "supervisor.md", "tutorial.md", "verify.md"} <= pages
    assert [(page, wrong) for page, plan in found if (wrong := errors(PLAN, plan))] == []


@pytest.mark.parametrize("ros", [1, 2])
def test_the_plan_of_the_demo_fits_and_says_where_its_schema_is(ros, tmp_path):
    proposed, decided = tmp_path / "proposed.yaml", tmp_path / "rtron.yaml"
    folders = (first_party_packages(ros), third_party_packages(ros))
    app = [*map(str, folders), "--launch", str(launch_file(ros))]
    command = [sys.executable, "-m", "rtron", "plan", *app, "-o", str(proposed)]
    subprocess.run(command, check=True, capture_output=True)
    conditions = RunConditions(scene=ROOM, speed=1.0, rate=10.0)
    decisions = merge_decisions(case.decisions(conditions) for case in CASES.values())
    write_decided_plan(proposed, decided, decisions)
    for plan in (proposed, decided):
        text = plan.read_text("utf-8")
        assert text.startswith(f"# yaml-language-server: $schema={PLAN_SCHEMA_URL}\n")
        assert errors(PLAN, yaml.safe_load(text)) == []


def test_the_configs_of_the_docs_fit():
    found = [(page, tomllib.loads(text)) for page, text in blocks("toml")]
    assert [(page, wrong) for page, config in found if (wrong := errors(CONFIG, config))] == []
    assert "findings.md" in {page for page, _ in found}


@pytest.mark.parametrize(
    ("text", "fits"),
    [
        ("", True),
        ('[[ignore]]\nrule = "qos_mismatch"\nreason = "a rig"', True),
        ('[[ignore]]\nrule = "qos_mismatch"\ntopic = "/a*"\nreason = "a rig"', True),
        ('[[ignore]]\nrule = "qos_mismatch"', False),
        ('[[ignore]]\nrule = "qos_mismatch"\nreason = " "', False),
        ('[[ignore]]\nrule = "no_such_rule"\nreason = "a rig"', False),
        ('[[ignore]]\nrule = "qos_mismatch"\nreason = "a rig"\nnode = "/a"', False),
        ('[ignore]\nrule = "qos_mismatch"', False),
        ("[ignored]", False),
    ],
)
def test_a_config_fits_as_it_does_for_the_reader(text, fits, tmp_path):
    assert (errors(CONFIG, tomllib.loads(text)) == []) is fits
    path = tmp_path / "rtron.toml"
    path.write_text(text)
    try:
        read_config(path, RULE_NAMES)
    except InputError:
        assert not fits
    else:
        assert fits
