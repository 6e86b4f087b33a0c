"""A participant of Cyclone DDS with the files of an enclave, and no RMW: its library by ctypes.

`FOLDER DOMAIN may TOPIC...` prints which topics it may write and read, as JSON; `FOLDER DOMAIN
write|read TOPIC` has one writer or reader until standard input ends, and prints each time with how
many others it is connected.
"""

import ctypes
import json
import select
import sys
from ctypes import POINTER, Structure, byref, c_char_p, c_int32, c_uint32, c_void_p
from pathlib import Path

LIBRARY, PLUGINS = "libddsc.so.0debian", "libddsc0debian"
PLUGIN_NAMES = {
    "auth": ("dds_security_auth", "authentication"),
    "crypto": ("dds_security_crypto", "crypto"),
    "access": ("dds_security_ac", "access_control"),
}
FILES = {
    "dds.sec.auth.identity_ca": "identity_ca.cert.pem",
    "dds.sec.auth.private_key": "key.pem",
    "dds.sec.auth.identity_certificate": "cert.pem",
    "dds.sec.access.permissions_ca": "permissions_ca.cert.pem",
    "dds.sec.access.governance": "governance.p7s",
    "dds.sec.access.permissions": "permissions.p7s",
    "org.eclipse.cyclonedds.sec.auth.crl": "crl.pem",
}
ONE_OCTET = (c_uint32 * 3)(0x01 << 24 | 0x01 << 16, 0, 0)


class Blob(Structure):
    _fields_ = (("data", c_void_p), ("size", c_uint32))


class TopicDescriptor(Structure):
    """dds_topic_descriptor_t of Cyclone DDS 0.10 (dds_public_impl.h)."""

    _fields_ = (
        ("size", c_uint32),
        ("align", c_uint32),
        ("flagset", c_uint32),
        ("nkeys", c_uint32),
        ("typename", c_char_p),
        ("keys", c_void_p),
        ("nops", c_uint32),
        ("ops", POINTER(c_uint32)),
        ("meta", c_char_p),
        ("type_information", Blob),
        ("type_mapping", Blob),
        ("data_representation", c_uint32),
    )


dds = ctypes.CDLL(LIBRARY)
dds.dds_create_qos.restype = c_void_p
dds.dds_qset_prop.argtypes = (c_void_p, c_char_p, c_char_p)
dds.dds_create_participant.argtypes = (c_uint32, c_void_p, c_void_p)
dds.dds_create_topic.argtypes = (c_int32, POINTER(TopicDescriptor), c_char_p, c_void_p, c_void_p)
for make in (dds.dds_create_writer, dds.dds_create_reader):
    make.argtypes = (c_int32, c_int32, c_void_p, c_void_p)
for count in (dds.dds_get_matched_subscriptions, dds.dds_get_matched_publications):
    count.argtypes = (c_int32, c_void_p, ctypes.c_size_t)


def participant(folder, domain):
    qos = dds.dds_create_qos()
    properties = {name: f"file:{folder / file}" for name, file in FILES.items()}
    where = next(Path("/usr/lib").glob(f"*/{PLUGINS}"))
    for kind, (library, name) in PLUGIN_NAMES.items():
        properties[f"dds.sec.{kind}.library.path"] = str(where / f"lib{library}.so")
        properties[f"dds.sec.{kind}.library.init"] = f"init_{name}"
        properties[f"dds.sec.{kind}.library.finalize"] = f"finalize_{name}"
    for name, value in properties.items():
        dds.dds_qset_prop(qos, name.encode(), value.encode())
    return dds.dds_create_participant(domain, qos, None)


def topic(owner, name):
    kind = TopicDescriptor(
        size=1, align=1, flagset=1, typename=b"Octet", nops=2, ops=ONE_OCTET, meta=b""
    )
    return dds.dds_create_topic(owner, byref(kind), name.encode(), None, None)


def may(owner, name):
    """Return whether the participant may write a topic, and whether it may read it."""
    found = topic(owner, name)
    if found < 0:
        return [False, False]
    makers = (dds.dds_create_writer, dds.dds_create_reader)
    return [make(owner, found, None, None) > 0 for make in makers]


def stay(owner, kind, name):
    writes = kind == "write"
    make = dds.dds_create_writer if writes else dds.dds_create_reader
    matched = dds.dds_get_matched_subscriptions if writes else dds.dds_get_matched_publications
    end = make(owner, topic(owner, name), None, None)
    print("up" if end > 0 else "refused", flush=True)
    before = 0
    while not select.select([sys.stdin], [], [], 0.05)[0]:
        now = matched(end, None, 0)
        if now != before:
            print(f"matched {now}", flush=True)
        before = now


def main():
    folder, domain, verb, *names = sys.argv[1:]
    owner = participant(Path(folder), int(domain))
    if owner < 0:
        sys.exit("no participant")
    if verb == "may":
        print(json.dumps({name: may(owner, name) for name in names}))
    else:
        stay(owner, verb, *names)


if __name__ == "__main__":
    main()
