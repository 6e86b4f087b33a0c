import sys
from types import ModuleType

import pytest

STARTED = ("small", "http://localhost:11311", "INFO", False, None, None, None)


@pytest.fixture
def started(monkeypatch):
    """Put a supervisor in place that only notes what it is told."""
    calls = []
    module = ModuleType("rtron.guard.supervision.programs")

    def supervise(plan, master, *, log_level, dry_run, control, figures, link):
        calls.append((plan.app, master, log_level, dry_run, control, figures, link))
        sys.exit(0)

    module.supervise = supervise
    monkeypatch.setitem(sys.modules, "rtron.guard.supervision.programs", module)
    return calls


def test_what_roslaunch_appends_is_accepted(rtron, plan_file, started):
    ran = rtron("guard", "--plan", plan_file, "__name:=rtron_guard", "__log:=/x.log")
    assert (ran.code, ran.out, ran.err) == (0, "", "")
    assert started == [STARTED]


def test_the_master_and_the_log_level_are_handed_on(rtron, plan_file, started):
    rtron("guard", "--plan", plan_file, "--master", "http://m:1", "--log-level", "debug")
    assert started == [("small", "http://m:1", "DEBUG", False, None, None, None)]


def test_a_dry_run_and_another_door_are_handed_on(rtron, plan_file, started, tmp_path):
    rtron("guard", "--plan", plan_file, "--dry-run", "--control-socket", tmp_path / "door.sock")
    assert started[0][3:5] == (True, tmp_path / "door.sock")


def test_a_plan_that_does_not_fit_the_app_is_refused(rtron, plan_file, started, quiet_file):
    checked = rtron("check", plan_file, "--graph", quiet_file)
    ran = rtron("guard", "--plan", plan_file, "--graph", quiet_file)
    assert (checked.code, ran.code, started) == (1, 2, [])
    assert "error: the plan does not fit the app" in ran.err
    assert "no topic /cmd_vel in the app" in ran.err


def test_a_plan_that_fits_the_app_is_guarded(rtron, plan_file, started, graph_file, caplog):
    assert rtron("guard", "--plan", plan_file, "--graph", graph_file).code == 0
    assert started == [STARTED]
    assert "not checked" not in caplog.text


def test_what_check_warns_of_is_logged_and_what_is_not_checked(rtron, plan_file, started, caplog):
    plan = plan_file.read_text()
    plan_file.write_text(plan.replace("mode: enforce", "mode: observe"))
    with caplog.at_level("INFO"):
        assert rtron("guard", "--plan", plan_file).code == 0
    assert "plan: nothing enforces: the guard only watches" in caplog.text
    assert "not checked: whether the plan's topics, nodes and types are the app's" in caplog.text
    assert started == [STARTED]


@pytest.fixture
def linked(tmp_path, monkeypatch):
    """Name a service in the environment, as before a roslaunch."""
    token = tmp_path / "token"
    token.write_text("secret\n")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("RTRON_SERVICE", "https://robots.example:8600/")
    monkeypatch.setenv("RTRON_TOKEN_FILE", str(token))
    monkeypatch.setenv("RTRON_ROBOT", "car1")
    return token


def test_the_service_may_stand_in_the_environment(rtron, plan_file, started, linked, tmp_path):
    assert rtron("guard", "--plan", plan_file).err == ""
    link = started[0][-1]
    assert (link.url, link.robot) == ("wss://robots.example:8600/link/v1", "car1")
    assert (link.token(), link.state) == ("secret", tmp_path / "state" / "rtron" / "small")
    assert (link.state.stat().st_mode & 0o777) == 0o700


def test_a_token_that_others_could_read_on_its_way_is_told(rtron, plan_file, started, linked):
    ran = rtron("guard", "--plan", plan_file, "--service", "http://robots.example:8600")
    assert "others can read the token" in ran.err
    assert len(started) == 1


@pytest.mark.parametrize("service", ["robots.example", "ftp://robots.example", "https://"])
def test_a_service_without_an_address_is_refused(rtron, plan_file, started, linked, service):
    ran = rtron("guard", "--plan", plan_file, "--service", service)
    assert ran.code == 2
    assert "is no address of a service" in ran.err
    assert started == []


@pytest.mark.parametrize("text", ["", "two words", "\0"])
def test_a_file_without_a_token_is_refused(rtron, plan_file, started, linked, text):
    linked.write_text(text)
    ran = rtron("guard", "--plan", plan_file)
    assert ran.code == 2
    assert "rtron token create" in ran.err
    linked.unlink()
    assert rtron("guard", "--plan", plan_file).code == 2
    assert started == []


def test_a_service_needs_a_token(rtron, plan_file, started, linked, monkeypatch):
    monkeypatch.delenv("RTRON_TOKEN_FILE")
    assert "--token-file" in rtron("guard", "--plan", plan_file).err
    assert started == []


def test_anything_else_is_2(rtron, plan_file, started, tmp_path):
    assert rtron("guard", "--plan", plan_file, "surplus").code == 2
    assert rtron("guard", "--plan", tmp_path / "none.yaml").code == 2
    assert rtron("guard").code == 2
    assert started == []


def test_the_plan_that_a_roll_out_has_brought_goes_before_that_of_the_start(
    rtron, plan_file, started, linked, tmp_path
):
    folder, given = tmp_path / "plans", []

    def supervise(plan, *_, link, **__):
        given.append((plan, link.plans))
        sys.exit(0)

    sys.modules["rtron.guard.supervision.programs"].supervise = supervise
    text = plan_file.read_text()
    changed = f"{text}\nrevision: 7\n"
    for document in ("", changed):
        if document:
            (folder / "plan.yaml").write_text(document)
        rtron("guard", "--plan", plan_file, "--plans", folder)
    (first, plans), (second, same) = given
    assert (first, same.start) == (plans.start, plans.start)
    assert (first.revision, second.revision) == (0, 7)


def test_plans_come_from_a_service(rtron, plan_file, started, tmp_path):
    ran = rtron("guard", "--plan", plan_file, "--plans", tmp_path / "plans")
    assert (ran.code, started) == (2, [])
    assert "--plans without --service" in ran.err
