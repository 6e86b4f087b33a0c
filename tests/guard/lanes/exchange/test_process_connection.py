"""The calls of the guard's two processes: each that one makes, the other one has."""

import ast
import inspect
from pathlib import Path

import rtron.guard
from rtron.guard.lanes.command.node_reports import NodeReports

GUARD = Path(rtron.guard.__file__).parent
PATHS = [path for each in ("lanes", "incidents") for path in (GUARD / each).rglob("*.py")]
MODULES = [ast.parse(path.read_text()) for path in PATHS]
CALLS = [each for tree in MODULES for each in ast.walk(tree) if isinstance(each, ast.Call)]


def called(call):
    """Return the names that a call of `call`, or a partial one, or one at a limited rate has."""
    texts = [ast.unparse(each) for each in (call.func, *call.args)]
    if texts[0] == "partial" and texts[1].endswith(".call"):
        return texts[2:3]
    return texts[1:2] if texts[0].endswith(".call") or texts[0] == "self._call" else []


def test_each_call_has_a_handler_and_each_handler_a_call():
    handled = {
        keyword.arg
        for call in CALLS
        if ast.unparse(call.func) in ("connection.on", "self.on")
        for keyword in call.keywords
    }
    names = {ast.literal_eval(name) for call in CALLS for name in called(call) if name[0] in "'\""}
    source = inspect.getsource(NodeReports)
    limited = {name for name in handled if f'send(("{name}", ' in source}
    assert limited == {"subscribed", "unsubscribed", "shutdown_request"}
    variable = {"settle_alarm", "withdraw_alarm"}
    assert names | limited | variable == handled
