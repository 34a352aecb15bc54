# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged recordings: bags of ROS 1, MCAP and SQLite bags of ROS 2, and the messages in them.

A recording that was cut off is still one as far as its records are whole; a message that cannot be used is counted and
passed over if others of its topic can, and a cloud whose points cannot be read is refused, since a map with a hole would
be judged.
"""

from __future__ import annotations

import bz2
import itertools
import random
import sqlite3
import struct
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from .case import INF, NAN, Case, seeds

Message = tuple[str, str, bytes]


def cloud(order: str | None, second: int = 2, **changes: object) -> bytes:
    """A PointCloud2 of two points, field by field, with some of the fields changed."""
    said = {"height": 1, "width": 2, "names": "xyz", "type": 7, "offsets": (0, 4, 8), "point_step": 12, "row_step": 24, "data": 24,
            "fields": 3, "name_bytes": None, "points": None} | changes
    message = seeds.RosMessage(order).header(second, "lidar").put("I", said["height"], said["width"], said["fields"])
    for name, offset in zip(said["names"], said["offsets"], strict=False):
        if said["name_bytes"] is None:
            message.text(name)
        else:
            message.put("I", said["name_bytes"]).body += name.encode()
        message.put("I", offset).put("B", said["type"]).put("I", 1)
    message.put("B", 0).put("I", said["point_step"], said["row_step"], said["data"])
    message.body += said["points"] or b"".join(struct.pack("<3f", *p) for p in seeds.XYZ)
    return message.put("B", 1).bytes()


BROKEN_CLOUDS: dict[str, dict[str, object]] = {
    "width_bomb": {"width": 0xFFFFFFFF}, "height_bomb": {"height": 0xFFFFFFFF}, "both_bombs": {"width": 0x10000, "height": 0x10000},
    "one_point_more": {"width": 3}, "fields_bomb": {"fields": 0xFFFFFFFF}, "no_x": {"names": "ayz"}, "type_0": {"type": 0},
    "type_255": {"type": 255}, "offset_outside": {"offsets": (0, 4, 9)}, "offset_bomb": {"offsets": (0, 4, 0xFFFFFFFF)},
    "point_step_0": {"point_step": 0}, "point_step_bomb": {"point_step": 0xFFFFFFFF}, "data_bomb": {"data": 0xFFFFFFFF},
    "data_longer_than_the_message": {"data": 26}, "row_step_bomb": {"height": 2, "width": 1, "row_step": 0xFFFFFFFF},
    "row_step_0": {"height": 2, "width": 1, "row_step": 0}, "name_bomb": {"name_bytes": 0x7FFFFFFF}}


def odometry(order: str | None, second: int, *pose: float) -> bytes:
    return seeds.RosMessage(order).header(second, "odom").text("base").put("d", *pose).put("d", *[0] * 78).bytes()


BAD_POSES = {"nan": (NAN, 0, 0, 0, 0, 0, 1), "inf": (0, INF, 0, 0, 0, 0, 1), "quaternion_zeros": (0, 0, 0, 0, 0, 0, 0),
             "quaternion_long": (0, 0, 0, 0, 0, 0, 7), "far": (1e30, 0, 0, 0, 0, 0, 1)}


def with_message(order: str | None, topic: str, changed: bytes) -> list[Message]:
    """The recording of the seeds with the last message of a topic replaced."""
    messages = seeds.drive(order, "odometry")
    last = max(i for i, message in enumerate(messages) if message[0] == topic)
    return [*messages[:last], (*messages[last][:2], changed), *messages[last + 1:]]


def message_cases(format_: str, order: str | None, write: Callable[[list[Message]], dict[str, bytes]]) -> Iterator[Case]:
    for name, changes in BROKEN_CLOUDS.items():
        yield Case(format_, f"cloud_{name}", write(with_message(order, "/points", cloud(order, **changes))))
    whole = cloud(order)
    yield Case(format_, "cloud_cut_in_its_data", write(with_message(order, "/points", whole[:-8])))
    yield Case(format_, "cloud_cut_in_its_header", write(with_message(order, "/points", whole[:9])), tolerated=True)
    yield Case(format_, "cloud_of_no_points", write(with_message(order, "/points", cloud(order, width=0, row_step=0))), tolerated=True)
    for name, pose in BAD_POSES.items():
        one = with_message(order, "/odom", odometry(order, 2, *pose))
        yield Case(format_, f"pose_{name}", write(one), tolerated=True)
    all_bad = [(t, k, odometry(order, 2, *BAD_POSES["nan"]) if t == "/odom" else data) for t, k, data in seeds.drive(order, "odometry")]
    yield Case(format_, "poses_all_nan", write(all_bad))
    for topic, name in (("/odom", "no_poses"), ("/points", "no_clouds")):
        yield Case(format_, name, write([message for message in seeds.drive(order, "odometry") if message[0] != topic]))
    yield Case(format_, "transforms_bomb", write([("/tf_static", "tf2_msgs/TFMessage", seeds.RosMessage(order).put("I", 0xFFFFFFFF).bytes()),
                                                  *seeds.drive(order, "odometry")[1:]]), tolerated=True)


def ros1(messages: list[Message], packing: str = "none") -> dict[str, bytes]:
    return {".bag": seeds.rosbag1(messages, packing)}


def ros1_cases() -> Iterator[Case]:
    yield from message_cases("rosbag1", None, ros1)
    plain = seeds.rosbag1(seeds.drive(None, "odometry"))
    # The second cloud follows the first; from there on something can be read.
    second_cloud = plain.rindex(cloud(None))
    magic, header, chunk = 13, plain.index(b"op=\3"), plain.index(b"op=\5")
    for at in (0, 1, magic - 1, magic, magic + 2, header, header + 20, chunk, chunk + 20, plain.index(b"op=\7"), second_cloud // 2):
        yield Case("rosbag1", f"cut_at_{at}", {".bag": plain[:at]})
    for at in (second_cloud, second_cloud + 30, len(plain) - 100, len(plain) - 1):
        yield Case("rosbag1", f"cut_at_{at}", {".bag": plain[:at]}, tolerated=True)
    changes = {"version_1": (b"V2.0", b"V1.2"), "version_9": (b"V2.0", b"V9.9"), "magic": (b"#ROSBAG", b"#ROSBAD"),
               "no_equals": (b"op=\3", b"opp\3"), "op_missing": (b"op=\5", b"up=\5"), "op_two_bytes": (b"\4\0\0\0op=\5", b"\5\0\0\0op=\5"),
               "field_bomb": (b"\4\0\0\0op=\5", b"\xff\xff\xff\xffop=\5"), "record_bomb": (b"\4\0\0\0op=\3", b"\4\0\0\x7fop=\3"),
               "packing_other": (b"compression=none", b"compression=lzma"), "size_bomb": (b"size=", b"siz=="), "conn_short": (b"conn=", b"con==")}
    for name, (old, new) in changes.items():
        yield Case("rosbag1", f"field_{name}", {".bag": plain.replace(old, new)})
    yield Case("rosbag1", "encrypted", {".bag": b"#ROSBAG V2.0\n" + seeds.bag_record(
        b" " * 8, op=b"\3", index_pos=bytes(8), conn_count=bytes(4), chunk_count=bytes(4), encryptor=b"rosbag/AesCbcEncryptor")})
    # `bz2` and `lz4` chunks: damaged, and claiming other sizes.
    for packing in ("bz2", "lz4"):
        packed = seeds.rosbag1(seeds.drive(None, "odometry"), packing)
        middle = (packed.index(b"op=\5") + len(packed)) // 2
        yield Case("rosbag1", f"{packing}_zeroed", {".bag": packed[:middle] + bytes(40) + packed[middle + 40:]} if packing == "bz2" else
                   {".bag": packed.replace(b"\x04\x22\x4d\x18", b"\0\0\0\0")})
        at = packed.index(b"size=", packed.index(b"op=\5")) + 5
        for name, size in (("bomb", 0xFFFFFFFF), ("one_more", struct.unpack_from("<I", packed, at)[0] + 1), ("nothing", 0)):
            yield Case("rosbag1", f"{packing}_size_{name}", {".bag": packed[:at] + struct.pack("<I", size) + packed[at + 4:]})
        yield Case("rosbag1", f"{packing}_cut", {".bag": packed[:middle]})
    hollow = bz2.compress(bytes(64 << 20))
    chunk_record = seeds.bag_record(hollow, op=b"\5", compression=b"bz2", size=struct.pack("<I", 64 << 20))
    yield Case("rosbag1", "decompression_bomb", {".bag": seeds.rosbag1([])[:seeds.rosbag1([]).index(b"op=\5") - 8] + chunk_record})
    # What bzip2 unpacks slowest for its size: 32 chunks of one cloud, each of 40,000 points of a hundred bytes.
    points = random.Random(1).randbytes(200) * 20000
    much = seeds.rosbag1([("/points", "sensor_msgs/PointCloud2", cloud(None, width=40000, point_step=100, row_step=len(points),
                                                                       data=len(points), points=points)),
                          *seeds.drive(None, "odometry")], "bz2", closed=False)
    begin = much.index(b"op=\5") - 8
    yield Case("rosbag1", "bz2_of_much", {".bag": much[:begin] + 32 * much[begin:]})
    yield Case("rosbag1", "zeros", {".bag": bytes(4096)})
    yield Case("rosbag1", "ones", {".bag": b"#ROSBAG V2.0\n" + b"\xff" * 4096})
    yield Case("rosbag1", "empty", {".bag": b""})
    yield Case("rosbag1", "index_elsewhere", {".bag": plain.replace(b"index_pos=" + struct.pack("<Q", plain.index(b"op=\7", second_cloud) - 8),
                                                                    b"index_pos=" + b"\xff" * 8)}, tolerated=True)


def mcap(messages: list[Message], packing: str = "") -> dict[str, bytes]:
    return {".mcap": seeds.mcap(messages, packing)}


def mcap_cases() -> Iterator[Case]:
    yield from message_cases("mcap", "<", mcap)
    plain = seeds.mcap(seeds.drive("<", "odometry"))
    second_cloud = plain.rindex(cloud("<"))
    for at in (0, 1, 7, 8, 12, 40, 60, 100, second_cloud // 2):
        yield Case("mcap", f"cut_at_{at}", {".mcap": plain[:at]})
    for at in (second_cloud, second_cloud + 30, len(plain) - 9, len(plain) - 1):
        yield Case("mcap", f"cut_at_{at}", {".mcap": plain[:at]}, tolerated=True)
    yield Case("mcap", "version_1", {".mcap": plain.replace(b"\x89MCAP0", b"\x89MCAP1")})
    yield Case("mcap", "magic", {".mcap": b"\x88" + plain[1:]})
    chunk = plain.index(b"\6", 8 + 9 + 12)
    for name, at, content in (("record_bomb", chunk + 1, b"\xff" * 8), ("record_half", chunk + 1, b"\xff\0\0\0\0\0\0\0"),
                              ("packing_name_bomb", chunk + 9 + 28, b"\xff" * 4), ("packing_name", chunk + 9 + 28, b"\x02\0\0\0"),
                              ("records_bomb", chunk + 9 + 32, b"\xff" * 8)):
        yield Case("mcap", f"chunk_{name}", {".mcap": plain[:at] + content + plain[at + len(content):]})
    for packing in ("lz4", "zstd"):
        packed = seeds.mcap(seeds.drive("<", "odometry"), packing)
        chunk = packed.index(b"\6", 8 + 9 + 12)
        size = chunk + 9 + 16
        honest = struct.unpack_from("<Q", packed, size)[0]
        for name, value in (("bomb", 1 << 62), ("gigabyte", 1 << 30), ("one_more", honest + 1), ("one_less", honest - 1), ("nothing", 0)):
            yield Case("mcap", f"{packing}_size_{name}", {".mcap": packed[:size] + struct.pack("<Q", value) + packed[size + 8:]})
        begin = packed.index(packing.encode()) + len(packing) + 8
        yield Case("mcap", f"{packing}_no_frame", {".mcap": packed[:begin] + bytes(4) + packed[begin + 4:]})
        yield Case("mcap", f"{packing}_cut", {".mcap": packed[:begin + 60]})
        yield Case("mcap", f"{packing}_checksum", {".mcap": packed[:size + 8] + b"\1\2\3\4" + packed[size + 12:]})
    yield Case("mcap", "packing_other", {".mcap": seeds.mcap(seeds.drive("<", "odometry"), "lz4").replace(b"\3\0\0\0lz4", b"\3\0\0\0br5")})
    yield Case("mcap", "encoding_other", {".mcap": seeds.mcap(seeds.drive("<", "odometry"), encoding=b"protobuf")})
    yield Case("mcap", "zeros", {".mcap": bytes(4096)})
    yield Case("mcap", "ones", {".mcap": b"\x89MCAP0\r\n" + b"\xff" * 4096})
    records = (seeds.mcap_record(code, b"") for code in itertools.chain(range(3, 7), [0, 200]))
    yield Case("mcap", "empty_records", {".mcap": b"\x89MCAP0\r\n" + b"".join(records)})


SCHEMA = ("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)",
          "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")


def database(messages: list[Message], schema: tuple[str, ...] = SCHEMA, *changes: str) -> bytes:
    """A rosbag 2 in SQLite; `changes` are run at the end."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "bag.db3")
        connection = sqlite3.connect(path)
        for line in schema:
            connection.execute(line)
        names = sorted({(topic, kind) for topic, kind, _ in messages})
        if schema == SCHEMA:
            for i, (topic, kind) in enumerate(names, 1):
                connection.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", (i, topic, kind.replace("/", "/msg/")))
            number = {topic: i for i, (topic, _) in enumerate(names, 1)}
            for i, (topic, _, data) in enumerate(messages):
                connection.execute("INSERT INTO messages VALUES (?, ?, ?, ?)", (i, number[topic], 3_000_000_000 + i, data))
        for line in changes:
            connection.execute(line)
        connection.commit()
        connection.close()
        return path.read_bytes()


def sqlite_cases() -> Iterator[Case]:
    drive = seeds.drive("<", "odometry")
    yield from message_cases("db3", "<", lambda messages: {".db3": database(messages)})
    good = database(drive)
    for name, content in {"empty": b"", "magic": b"X" + good[1:], "header_only": good[:100], "first_page": good[:4096],
                          "one_byte": b"S", "zeros": bytes(8192), "ones": good[:100] + b"\xff" * (len(good) - 100),
                          "page_size_3": good[:16] + b"\0\3" + good[18:], "page_size_0": good[:16] + b"\0\0" + good[18:],
                          "root_page_zeroed": good[:100] + bytes(400) + good[500:], "no_tables": database([], ()),
                          "no_messages_table": database([], SCHEMA[:1]), "no_topics_table": database([], SCHEMA[1:]),
                          "other_columns": database([], ("CREATE TABLE topics(a)", "CREATE TABLE messages(b)")),
                          "tables_are_views": database([], ("CREATE VIEW topics AS SELECT 1 id, 2 name, 3 type, 4 serialization_format",
                                                            "CREATE VIEW messages AS SELECT 1 topic_id, 2 timestamp, 3 data")),
                          "nothing_recorded": database([]), "topics_gone": database(drive, SCHEMA, "DELETE FROM topics"),
                          "not_cdr": database(drive, SCHEMA, "UPDATE topics SET serialization_format = 'xml'"),
                          "clouds_null": database(drive, SCHEMA, "UPDATE messages SET data = NULL"),
                          "clouds_numbers": database(drive, SCHEMA, "UPDATE messages SET data = 7"),
                          "recursive_view": database([], (SCHEMA[0], "CREATE VIEW messages AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL "
                                                          "SELECT x + 1 FROM c) SELECT x id, x topic_id, x timestamp, x data FROM c"))}.items():
        yield Case("db3", name, {".db3": content})
    yield Case("db3", "stamps_text", {".db3": database(drive, SCHEMA, "UPDATE messages SET timestamp = 'noon'")}, tolerated=True)
    yield Case("db3", "last_page_cut", {".db3": good[:-1]})


def cases() -> Iterator[Case]:
    yield from ros1_cases()
    yield from mcap_cases()
    yield from sqlite_cases()
