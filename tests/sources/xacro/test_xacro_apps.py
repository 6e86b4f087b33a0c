"""Against the real xacro on the descriptions of real robot apps, where they are present."""

import os
from pathlib import Path

import pytest
from xml_differences import run_real_xacro, xml_differences

from rtron.sources.launch.common.packages import find_packages
from rtron.sources.xacro import evaluate_xacro

APPS = os.environ.get("RTRON_APPS", "")


@pytest.mark.skipif(not APPS, reason="RTRON_APPS names no folder of robot apps")
def test_what_the_real_xacro_can_process_comes_out_equal():
    packages = find_packages([Path(APPS)], {})
    files = [path for path in sorted(Path(APPS).rglob("*.xacro")) if path.is_file()]
    answers = run_real_xacro([[str(path), {}] for path in files], packages)
    possible = [answer for answer in answers if "xml" in answer]
    wrong = []
    for answer in possible:
        result = evaluate_xacro(Path(answer["path"]), {}, packages, {})
        if found := xml_differences(result.text, answer["xml"]) or result.unresolved:
            wrong.append((answer["path"], found[:3]))
    print(f"{len(possible) - len(wrong)} of {len(possible)} equal, of {len(files)} files")
    for answer in answers:
        if "error" in answer:
            print("real xacro:", answer["path"], answer["error"][:150])
    assert not wrong
    assert possible
