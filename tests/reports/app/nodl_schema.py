"""What NoDL 2 asks of a document, said anew (github.com/ros-tooling/nodl: nodl_schema)."""

import re

NAME = re.compile(r"^[A-Za-z]$|^[/~A-Za-z][A-Za-z0-9_/]*[A-Za-z0-9_]$")
TYPE = re.compile(r"^[a-zA-Z][a-zA-Z0-9_]*(/(msg|srv|action))?/[A-Z][a-zA-Z0-9]*$")
TOPICS = ("publishers", "subscriptions")
OTHERS = ("service_servers", "service_clients", "action_servers", "action_clients")
KINDS = {"bool", "int", "double", "string"}
POLICIES = {
    "history": {"KEEP_LAST", "KEEP_ALL", "SYSTEM_DEFAULT"},
    "reliability": {"RELIABLE", "BEST_EFFORT", "SYSTEM_DEFAULT", "BEST_AVAILABLE"},
    "durability": {"TRANSIENT_LOCAL", "VOLATILE", "SYSTEM_DEFAULT", "BEST_AVAILABLE"},
    "liveliness": {"AUTOMATIC", "MANUAL_BY_TOPIC", "SYSTEM_DEFAULT", "BEST_AVAILABLE"},
}
TIMES = {"deadline_ns", "lifespan_ns", "liveliness_lease_duration_ns"}


def faults(document):
    """Return what the schema would refuse."""
    found = [] if document.get("nodl_version") == 2 else ["nodl_version"]
    known = {"nodl_version", "description", "parameters", *TOPICS, *OTHERS}
    found += [f"key {key}" for key in document.keys() - known]
    for section in (*TOPICS, *OTHERS):
        keys = {"name", "type", *(["qos"] if section in TOPICS else [])}
        for entry in document.get(section, []):
            found += [f"{section} {entry}"] * (entry.keys() != keys)
            found += [f"name {entry['name']}"] * (not NAME.match(entry["name"]))
            found += [f"type {entry['type']}"] * (not TYPE.match(entry["type"]))
            found += _qos_faults(
                entry.get("qos", {"history": "KEEP_ALL", "reliability": "RELIABLE"})
            )
    for name, given in document.get("parameters", {}).items():
        plain = given["type"].removesuffix("_array")
        found += [f"parameter {name}"] * (
            plain not in KINDS or given.keys() != {"type", "default_value"}
        )
    return found


def _qos_faults(qos):
    found = [f"qos {key}" for key in qos.keys() - POLICIES.keys() - TIMES - {"depth"}]
    found += [f"{key} is missing" for key in ("history", "reliability") if key not in qos]
    found += [key for key, words in POLICIES.items() if key in qos and qos[key] not in words]
    if qos.get("history") == "KEEP_LAST" and qos.get("depth", 0) < 1:
        found.append("depth")
    return found + [key for key in TIMES if qos.get(key, 1) < 0]
