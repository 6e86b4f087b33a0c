"""What ROS's own loader makes of a launch file; needs no master. Run with ROS's Python.

Reads a JSON request a line, {"path", "args": {…}, "environ": {…}}, and answers each with a line:
{"nodes", "tests", "params", "clear_params", "machines", "executables"} or {"error"}.
"""

import json
import os
import sys

import rosgraph.names
import roslaunch.config
import roslaunch.substitution_args
import roslaunch.xmlloader

ANONYMOUS = "_rtron_anonymous"
NODE_FIELDS = (
    "package", "type", "name", "namespace", "machine_name", "args", "remap_args", "env_args",
    "output", "cwd", "launch_prefix",
)  # fmt: skip


def answer(request):
    os.environ.pop("ROS_PACKAGE_PATH", None)
    os.environ.update(request["environ"])
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
    }


def node(found):
    full_name = rosgraph.names.ns_join(found.namespace, found.name)
    resolved = [
        [rosgraph.names.resolve_name(name, full_name) for name in pair] for pair in found.remap_args
    ]
    fields = {name: getattr(found, name) for name in NODE_FIELDS}
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
        print(json.dumps(reply), file=out, flush=True)


if __name__ == "__main__":
    main()
