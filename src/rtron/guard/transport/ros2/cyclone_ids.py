"""Cyclone DDS's handles of writers, and the GUIDs behind them, by its public C API (dds/dds.h).

With a message rmw_cyclonedds gives the handle that this process has for its writer
(ros2/rmw_cyclonedds#377). Such a handle is the writer's key in the built-in topic DCPSPublication,
which says its GUID. Cyclone fills that topic before a writer can reach a reader (its function
ddsi_new_proxy_writer), so whoever has sent a message is known there. No handle is used twice.
"""

from __future__ import annotations

import ctypes
from ctypes import (
    POINTER,
    Structure,
    byref,
    c_bool,
    c_int,
    c_int32,
    c_int64,
    c_size_t,
    c_uint8,
    c_uint32,
    c_void_p,
)
from itertools import islice
from typing import Any

from rtron.wire.ros2.c_structures import GID_SIZE, RequestId, typed_function
from rtron.wire.ros2.session import rmw_identifier

_HANDLE_SIZE = 8
_ALIVE = 16
"""DDS_ALIVE_INSTANCE_STATE"""
_PUBLICATIONS = 0x7FFF0003
"""DDS_BUILTIN_TOPIC_DCPSPUBLICATION"""
_MAX_PARTICIPANTS = 256
_AT_ONCE = 64
_MAX_LEFT = 4096
"""So many writers that have left stay known, for the messages that are still to be taken."""


class _SampleInfo(Structure):
    """dds_sample_info_t. Cyclone DDS 0.7 and later."""

    _fields_ = (
        ("sample_state", c_int),
        ("view_state", c_int),
        ("instance_state", c_int),
        ("valid_data", c_bool),
        ("source_timestamp", c_int64),
        ("instance_handle", c_uint8 * _HANDLE_SIZE),
        ("publication_handle", c_uint8 * _HANDLE_SIZE),
        ("counts", c_uint32 * 5),
    )


class _Guid(Structure):
    """dds_guid_t, with which a dds_builtintopic_endpoint_t begins. Cyclone DDS 0.7 and later."""

    _fields_ = (("value", c_uint8 * GID_SIZE),)


class CycloneSenderIds:
    """The writers that this process knows; by their handles.

    The RMW's id of a message is the handle and 8 zeros. That of a request is what the client said,
    the handle and the number; the RMW repeats in a response what the client said.
    """

    request_id_size = ctypes.sizeof(RequestId) + _HANDLE_SIZE

    def __init__(self, library: Any, participant: int) -> None:  # noqa: ANN401 - ctypes
        """Read through a participant of this process."""
        self._take = typed_function(
            library.dds_take,
            c_int32,
            c_int32,
            POINTER(c_void_p),
            POINTER(_SampleInfo),
            c_size_t,
            c_uint32,
        )
        self._return = typed_function(
            library.dds_return_loan, c_int32, c_int32, POINTER(c_void_p), c_int32
        )
        self._delete = typed_function(library.dds_delete, c_int32, c_int32)
        create = typed_function(
            library.dds_create_reader, c_int32, c_int32, c_int32, c_void_p, c_void_p
        )
        self._reader: int = create(participant, _PUBLICATIONS, None, None)
        self._samples, self._infos = (c_void_p * _AT_ONCE)(), (_SampleInfo * _AT_ONCE)()
        self._gids: dict[bytes, bytes] = {}
        self._left: dict[bytes, None] = {}

    @classmethod
    def open(cls, domain: int, participant: bytes) -> CycloneSenderIds | None:
        """Return those of a participant of ours, None where the RMW is not made of Cyclone DDS."""
        library = ctypes.CDLL(f"lib{rmw_identifier()}.so")
        if not hasattr(library, "dds_lookup_participant"):
            return None
        lookup = typed_function(
            library.dds_lookup_participant, c_int32, c_uint32, POINTER(c_int32), c_size_t
        )
        entities = (c_int32 * _MAX_PARTICIPANTS)()
        count = lookup(domain, entities, _MAX_PARTICIPANTS)
        guid_of = typed_function(library.dds_get_guid, c_int32, c_int32, POINTER(_Guid))
        for entity in islice(entities, max(count, 0)):
            guid = _Guid()
            if guid_of(entity, byref(guid)) == 0 and bytes(guid.value).startswith(participant):
                return cls(library, entity)
        return None

    def gid(self, id: bytes) -> bytes:
        """Return the GID of a message's sender; of a sender that is not known, the id itself."""
        found = self._gids.get(id)
        if found is None:
            self.update()
            found = self._gids.get(id, id)
        return found

    def request_id(self, rmw_request_id: bytes) -> bytes:
        """Return our id of a request that was taken."""
        claim, handle = rmw_request_id[:_HANDLE_SIZE], rmw_request_id[_HANDLE_SIZE:GID_SIZE]
        return self.gid(_padded(handle)) + rmw_request_id[GID_SIZE:] + claim

    def rmw_request_id(self, request_id: bytes) -> bytes:
        """Return the RMW's id here of a request; that of nobody, if its client is not there."""
        self.update()
        gid, number = self.gid(request_id[:GID_SIZE]), request_id[GID_SIZE:-_HANDLE_SIZE]
        handle = next((id for id, each in self._gids.items() if each == gid), bytes(GID_SIZE))
        return request_id[-_HANDLE_SIZE:] + handle[:_HANDLE_SIZE] + number

    def update(self) -> None:
        """Learn who has come and who has left."""
        count = _AT_ONCE
        while count == _AT_ONCE:
            count = self._take(self._reader, self._samples, self._infos, _AT_ONCE, _AT_ONCE)
            for sample, info in islice(zip(self._samples, self._infos, strict=True), max(count, 0)):
                self._note(_padded(bytes(info.instance_handle)), sample, info)
            if count > 0:
                self._return(self._reader, self._samples, count)

    def close(self) -> None:
        """Delete the reader."""
        self._delete(self._reader)

    def _note(self, id: bytes, sample: int | None, info: _SampleInfo) -> None:
        """Take what is told of one writer: of one that has left, only its handle counts."""
        if info.instance_state == _ALIVE and info.valid_data and sample:
            self._gids[id] = bytes(_Guid.from_address(sample).value)
            self._left.pop(id, None)
        elif id in self._gids:
            self._left[id] = None
            if len(self._left) > _MAX_LEFT:
                oldest = next(iter(self._left))
                del self._left[oldest], self._gids[oldest]


def _padded(handle: bytes) -> bytes:
    return handle.ljust(GID_SIZE, b"\0")
