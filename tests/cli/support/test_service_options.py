"""The options of the connection: declared once, for every command that calls the service."""

import pytest
import typer

from rtron.cli.command_registry import load_command
from rtron.cli.support.outcome import Outcome
from rtron.cli.support.service_options import calls_service
from rtron.errors import InputError

CONNECTION = ("service", "token_file", "ca")


@pytest.fixture
def command():
    """A command with an argument and an option of its own."""
    app, calls = typer.Typer(), []

    @app.command()
    @calls_service
    def look(client, what: str, *, much: bool = False) -> Outcome:
        """Look at it."""
        calls.append((client.service, client.token, client.ca, what, much))
        return Outcome("")

    made = typer.main.get_command(app)
    made.calls = calls
    return made


def run(command, *arguments):
    command.main(list(map(str, arguments)), standalone_mode=False)
    return command.calls.pop()


def test_the_command_gets_the_client_and_its_own_options(command, tmp_path):
    token = tmp_path / "me.token"
    token.write_text("rtron_x\n")
    connection = ("--token-file", token, "--service", "http://127.0.0.1:1", "--ca", "ca.pem")
    service, secret, ca, what, much = run(command, "it", "--much", *connection)
    assert (service, secret, str(ca)) == ("http://127.0.0.1:1", "rtron_x", "ca.pem")
    assert (what, much) == ("it", True)


def test_the_environment_names_the_service_and_the_token(command, tmp_path, monkeypatch):
    (tmp_path / "me.token").write_text("rtron_y\n")
    monkeypatch.setenv("RTRON_SERVICE", "http://127.0.0.1:2")
    monkeypatch.setenv("RTRON_TOKEN_FILE", str(tmp_path / "me.token"))
    assert run(command, "it") == ("http://127.0.0.1:2", "rtron_y", None, "it", False)
    monkeypatch.delenv("RTRON_TOKEN_FILE")
    with pytest.raises(InputError, match="no token"):
        command.main(["it"], standalone_mode=False)


def test_its_help_is_its_own_and_the_connection_comes_last(command):
    assert command.help == "Look at it."
    assert [each.name for each in command.params][:5] == ["what", "much", *CONNECTION]


def commands_of(name):
    """The commands of a group, or the one command."""
    loaded = load_command(name)
    if not isinstance(loaded, typer.Typer):
        app = typer.Typer()
        app.command()(loaded)
        return [typer.main.get_command(app)]
    return typer.main.get_group(loaded).commands.values()


@pytest.mark.parametrize("name", ["events", "rollout", "settings", "upload-graph"])
def test_every_command_has_all_options_of_the_connection(name):
    for each in commands_of(name):
        options = {option.name: option for option in each.params}
        assert set(CONNECTION) <= options.keys(), each.name
        assert options["service"].envvar == "RTRON_SERVICE"
        assert options["token_file"].envvar == "RTRON_TOKEN_FILE"
        assert "client" not in options
