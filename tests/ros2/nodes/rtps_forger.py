"""Sends Twists in another writer's name: DOMAIN GUID SPEED COUNT, without any DDS.

Each goes to every participant of the domain on this network, by UDP (DDSI-RTPS 2.5, 8.3.8.2 and
9.6.2.3). They have the numbers 1 to COUNT: a reader takes those that the writer has yet to use.
"""

import socket
import struct
import sys
import time

_PORT_BASE, _DOMAIN_GAIN, _PARTICIPANT_GAIN, _UNICAST = 7400, 250, 2, 11
_PARTICIPANTS = range(40)
_PREFIX = 12
_PAUSE_S = 0.001
"""A receiver's buffer is small, and a reader does not go on behind a gap."""
_HEADER = b"RTPS\x02\x03\x01\x0f"
"""Version 2.3, and Fast DDS as its vendor."""
_DATA, _LITTLE_ENDIAN_WITH_DATA = 0x15, 0x05
_ANY_READER = bytes(4)
_CDR = b"\0\1\0\0"


def packet(guid, number, speed):
    """Return the packet of a writer's message."""
    where = struct.pack("<HH4s4siI", 0, 16, _ANY_READER, guid[_PREFIX:], 0, number)
    body = where + _CDR + struct.pack("<6d", speed, 0, 0, 0, 0, 0)
    head = struct.pack("<BBH", _DATA, _LITTLE_ENDIAN_WITH_DATA, len(body))
    return _HEADER + guid[:_PREFIX] + head + body


def main():
    domain, guid, speed, count = sys.argv[1:]
    first = _PORT_BASE + _DOMAIN_GAIN * int(domain) + _UNICAST
    ports = [first + _PARTICIPANT_GAIN * each for each in _PARTICIPANTS]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        print("ready", flush=True)
        for number in range(1, int(count) + 1):
            data = packet(bytes.fromhex(guid), number, float(speed))
            for port in ports:
                sock.sendto(data, ("127.0.0.1", port))
            time.sleep(_PAUSE_S)
    print("said all")


if __name__ == "__main__":
    main()
