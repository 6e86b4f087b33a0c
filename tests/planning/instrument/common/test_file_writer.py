"""Writing a guarded launch."""

import os
import subprocess
from dataclasses import replace

import pytest

from rtron.errors import InputError
from rtron.planning.instrument import GuardedLaunch, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GUARD_SCRIPT, GuardFiles


def guarded(folder, **more):
    launch, beside = folder / "out.launch", folder / "out.d"
    files = {beside / "guard": "#!/bin/sh\n", beside / "rtron.yaml": "plan", launch: "<launch/>"}
    more_files = {beside / name: text for name, text in more.items()}
    return GuardedLaunch(launch=launch, folder=beside, files=files | more_files)


def written(folder):
    return {str(p.relative_to(folder)): p.read_text() for p in folder.rglob("*") if p.is_file()}


def test_every_file_is_written_and_only_the_script_can_be_run(tmp_path):
    write_guarded_launch(guarded(tmp_path / "new" / "folder", sub="<launch>é</launch>"))
    folder = tmp_path / "new" / "folder"
    assert written(folder)["out.d/sub"] == "<launch>é</launch>"
    assert len(written(folder)) == 4
    runnable = [
        path.name for path in folder.rglob("*") if path.is_file() and os.access(path, os.X_OK)
    ]
    assert runnable == ["guard"]


def test_an_earlier_guarded_launch_is_replaced_as_a_whole(tmp_path):
    write_guarded_launch(guarded(tmp_path, old="x"))
    write_guarded_launch(guarded(tmp_path, new="y"))
    assert set(written(tmp_path)) == {"out.launch", "out.d/guard", "out.d/rtron.yaml", "out.d/new"}


def test_scripts_are_copied_and_the_rest_is_linked(tmp_path):
    original, beside = tmp_path / "node", tmp_path / "beside"
    original.write_bytes(b"#!/usr/bin/python\n# \xe9")
    beside.mkdir()
    overlay = tmp_path / "out.d" / "overlay"
    more = {"copies": {overlay / "a/node": original}, "links": {overlay / "b/beside": beside}}
    write_guarded_launch(replace(guarded(tmp_path), **more))
    write_guarded_launch(replace(guarded(tmp_path), **more))
    assert (overlay / "a/node").read_bytes() == original.read_bytes()
    assert os.access(overlay / "a/node", os.X_OK)
    assert (overlay / "b/beside").readlink() == beside
    write_guarded_launch(guarded(tmp_path))
    assert beside.is_dir()
    assert not overlay.exists()


def test_a_folder_of_somebody_else_is_not_replaced(tmp_path):
    (tmp_path / "out.d").mkdir()
    (tmp_path / "out.d" / "mine").write_text("x")
    with pytest.raises(InputError, match="not RTron's"):
        write_guarded_launch(guarded(tmp_path))
    assert written(tmp_path) == {"out.d/mine": "x"}


def test_where_nothing_can_be_written_nothing_changes(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="cannot be written"):
        write_guarded_launch(guarded(tmp_path / "file"))
    assert written(tmp_path) == {"file": "x"}


def test_the_script_finds_the_plan_beside_it_and_does_not_run_what_it_prefixes(tmp_path):
    folder = tmp_path / "with space"
    folder.mkdir()
    script = folder / "guard"
    script.write_text(GuardFiles("", command=["printf", "%s|"]).texts()[GUARD_SCRIPT])
    script.chmod(0o755)
    ran = subprocess.run(
        [script, "/usr/lib/rosout/rosout", "__name:=x"], capture_output=True, text=True, check=True
    )
    assert ran.stdout == f"--plan|{folder}/rtron.yaml|"
