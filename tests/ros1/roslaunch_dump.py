"""What ROS's own loader makes of a launch file; needs no master. Run with ROS's Python.

Reads a JSON request a line, {"path", "args": {…}, "environ": {…}}, and answers each with a line:
{"nodes", "tests", "params", "clear_params", "machines", "executables", "server"} or {"error"}.
"server" is the master's parameter tree after the launch, "before" in the request that before it.
With "output" in the request no `command=` is run: each is taken to print that.
"""

import contextlib
import json
import os
import subprocess
import sys
import xmlrpc.client
from functools import partial

import rosgraph.names
import roslaunch.config
import roslaunch.launch
import roslaunch.substitution_args
import roslaunch.xmlloader
import rosmaster.paramserver

ANONYMOUS = "_rtron_anonymous"
NODE_FIELDS = (
    "package", "type", "name", "namespace", "machine_name", "args", "remap_args", "env_args",
    "output", "cwd", "launch_prefix",
)  # fmt: skip

POPEN = subprocess.Popen


class PrintedProcess:
    """A process that ended well and printed a text."""

    returncode = 0

    def __init__(self, output, *_, **__):
        self.output = output

    def communicate(self):
        return self.output.encode(), None


def answer(request):
    os.environ.pop("ROS_PACKAGE_PATH", None)
    os.environ.update(request["environ"])
    run = partial(PrintedProcess, request["output"]) if "output" in request else POPEN
    subprocess.Popen = run  # as roslaunch finds it
    roslaunch.substitution_args._rospack = None
    argv = [f"{name}:={value}" for name, value in request["args"].items()]
    loader = roslaunch.xmlloader.XmlLoader()
    loader.ignore_unset_args = False
    config = roslaunch.config.ROSLaunchConfig()  # without roscore.xml, which runs commands
    loader.load(request["path"], config, argv=argv, verbose=False)
    return {
        "nodes": [node(n) | {"respawn": n.respawn, "required": n.required} for n in config.nodes],
        "tests": [node(t) | {"test_name": t.test_name} for t in config.tests],
        "params": {name: repr(param.value) for name, param in config.params.items()},
        "clear_params": sorted(config.clear_params),
        "machines": sorted(config.machines),
        "executables": [repr((e.command, e.args)) for e in config.executables],
        "errors": config.config_errors,
        "server": server(config, request.get("before", {})),
    }


def server(config, before):
    """Return the master's tree after what roslaunch does to it: delete, clear, set."""
    parameters = rosmaster.paramserver.ParamDictionary(None)
    parameters.parameters = before
    deletes = [e.args[1] for e in config.executables if e.args[0] == "delete"]
    for name in [*deletes, *roslaunch.launch._unify_clear_params(config.clear_params)]:
        with contextlib.suppress(KeyError):
            parameters.delete_param(name)
    for name, param in config.params.items():
        (sent,), _ = xmlrpc.client.loads(xmlrpc.client.dumps((param.value,)))
        parameters.set_param(rosgraph.names.resolve_name(name, "/roslaunch"), sent)
    return parameters.parameters


def shown(value):
    """Return what JSON cannot hold as text."""
    return "binary data" if isinstance(value, xmlrpc.client.Binary) else repr(value)


def node(fake_study):
    full_name = rosgraph.names.ns_join(fake_study.namespace, fake_study.name)
    resolved = [
        [rosgraph.names.resolve_name(name, full_name) for name in pair]
        for pair in fake_study.remap_args
    ]
    fields = {name: getattr(fake_study, name) for name in NODE_FIELDS}
    return fields | {"full_name": full_name, "resolved_remaps": resolved}


def main():
    rosgraph.names.anonymous_name = lambda name: name + ANONYMOUS
    out, sys.stdout = sys.stdout, sys.stderr
    for line in sys.stdin:
        request = json.loads(line)
        before = dict(os.environ)
        try:
            reply = answer(request)
        except Exception as error:  # noqa: BLE001 - whatever roslaunch raises, it refuses
            reply = {"error": f"{type(error).__name__}: {error}"}
        os.environ.clear()
        os.environ.update(before)
        print(json.dumps(reply, default=shown), file=out, flush=True)


if __name__ == "__main__":
    main()
