#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the fuzzers' seeds: small valid files of every variant, under corpus/ beside this script.

The seeds are committed; run this after adding a variant. Same bytes every time.
"""
import bz2
import pathlib
import sqlite3
import struct
import zlib

CORPUS = pathlib.Path(__file__).resolve().parent / "corpus"
XYZ = [(1.0, 2.0, 3.0), (-4.5, 5.0, 6.25)]


def write(name, data):
    path = CORPUS / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data if isinstance(data, bytes) else data.encode())


def pcd(data, body, fields="x y z", size="4 4 4", kind="F F F", count="1 1 1", points=2):
    head = (f"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {fields}\nSIZE {size}\nTYPE {kind}\n"
            f"COUNT {count}\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n")
    return head.encode() + body


def lzf_literals(raw):
    """LZF without any back reference: runs of at most 32 bytes behind their length less one."""
    runs = [raw[i:i + 32] for i in range(0, len(raw), 32)]
    return b"".join(bytes([len(run) - 1]) + run for run in runs)


def compressed(raw):
    packed = lzf_literals(raw)
    return struct.pack("<II", len(packed), len(raw)) + packed


def ply(form, body, before="", after="", kind="float"):
    head = (f"ply\nformat {form} 1.0\ncomment seed\n{before}element vertex 2\n"
            f"property {kind} x\nproperty {kind} y\nproperty {kind} z\n{after}end_header\n")
    return head.encode() + body


def archive(json, paths, clouds, pairs):
    sections = [(b"JSON", json.encode()), (b"PATH", paths), (b"CLDS", clouds), (b"PAIR", pairs)]
    head = b"\x89KILTER\n" + struct.pack("<II", 1, len(sections))
    return head + b"".join(tag + struct.pack("<IQ", zlib.crc32(body), len(body)) + body for tag, body in sections)


def cloud(points):
    """Points 1 mm apart along x, nothing else."""
    low = bytes(i & 255 for i in range(points))
    empty = bytes(points)
    return struct.pack("<Q4dI", points, -1, -2, 0, 0.001, points) + low + 6 * empty


def pair(source, target, flags, samples):
    histogram = struct.pack("<dI3Q", 0.01, 3, 4, 0, 2) if flags & 2 else b""
    parent = struct.pack("<2d", 0.02, 0.03) if flags & 4 else b""
    both = bytes(samples) * (2 if flags & 1 else 1)
    return (struct.pack("<II3dIIIB", source, target, 0.5, 0.25, 0, 2, samples, samples, flags) + histogram + parent +
            both + both)


def octree(binary, size, body, kind="OcTree"):
    line = "# Octomap OcTree binary file" if binary else "# Octomap OcTree file"
    return f"{line}\n# seed\nid {kind}\nsize {size}\nres 0.1\ndata\n".encode() + body


def node(log_odds, children, colour=b""):
    return struct.pack("<f", log_odds) + colour + bytes([children])


def las(minor, kind, record, count, records=b"", number=0):
    """Version 1.`minor`, point format `kind`, points at whole metres."""
    size = 375 if minor == 4 else 227
    old = 0 if minor == 4 else count
    head = b"LASF" + bytes(20) + bytes([1, minor]) + bytes(68)
    head += struct.pack("<HIIBHI", size, size + len(records), number, kind, record, old) + bytes(20)
    head = (head + struct.pack("<6d", 0.01, 0.01, 0.01, 10, -20, 0)).ljust(247, b"\0")
    head = (head[:247] + struct.pack("<Q", count)).ljust(375, b"\0")[:size]
    return head + records + b"".join(struct.pack("<3i", 100 * i, 200, -300).ljust(record, b"\1") for i in range(count))


def write_trees():
    chain = node(0.85, 128) + 14 * node(0.85, 1)
    write("ot/two_cells", octree(False, 18, chain + node(0.85, 33) + node(0.85, 0) + node(-0.4, 0)))
    write("ot/cubes", octree(False, 3, node(1.5, 65) + node(-2.0, 0) + node(1.5, 0)))
    write("ot/colours", octree(False, 2, node(0.5, 1, b"\1\2\3") + node(0.25, 0, b"\4\5\6"), "ColorOcTree"))
    write("ot/empty", octree(False, 0, b""))
    write("ot/full_cube", octree(False, 10, node(1.0, 1) + node(1.0, 255) + 8 * node(1.0, 0)))
    write("bt/cubes", octree(True, 6, b"\xc9\x80\x10\x00"))
    write("bt/one_cell", octree(True, 17, b"\x00\xc0" + 14 * b"\x03\x00" + b"\x02\x00"))
    write("bt/empty", octree(True, 0, b""))
    write("bt/old", struct.pack("<idI", 3, 0.1, 6) + b"\xc9\x80\x10\x00")


class RosMessage:
    """Fields one by one: order None is ROS 1, "<" and ">" are CDR."""

    def __init__(self, order):
        self.order, self.body = order, b""

    def put(self, form, *values):
        for value in values:
            if self.order:
                self.body += bytes(-len(self.body) % struct.calcsize(form))
            self.body += struct.pack((self.order or "<") + form, value)
        return self

    def text(self, value):
        value = value.encode() + (b"\0" if self.order else b"")
        self.put("I", len(value)).body += value
        return self

    def header(self, second, frame):
        if not self.order:
            self.put("I", 1)
        return self.put("I", second, 0).text(frame)

    def pose(self, x=0.5):
        return self.put("d", x, 0, 0, 0, 0, 0, 1)

    def bytes(self):
        return {None: b"", "<": b"\0\1\0\0", ">": b"\0\0\0\0"}[self.order] + self.body


def ros_cloud(order, second=1):
    message = RosMessage(order).header(second, "lidar").put("I", 1, 2, 3)
    for i, name in enumerate("xyz"):
        message.text(name).put("I", 4 * i).put("B", 7).put("I", 1)
    message.put("B", 0).put("I", 12, 24, 24)
    message.body += b"".join(struct.pack("<3f", *p) for p in XYZ)
    return message.put("B", 1).bytes()


def ros_odometry(order, second=1):
    return RosMessage(order).header(second, "odom").text("base").pose().put("d", *[0] * 78).bytes()


def ros_transforms(order, *pairs, second=1):
    message = RosMessage(order).put("I", len(pairs))
    for parent, child in pairs:
        message.header(second, parent).text(child).pose()
    return message.bytes()


def ros_path(order):
    return RosMessage(order).header(1, "map").put("I", 2).header(1, "map").pose().header(2, "map").pose(1).bytes()


def drive(order, poses):
    static = [("/tf_static", "tf2_msgs/TFMessage", ros_transforms(order, ("base", "lidar"), second=0))]
    found = {"odometry": [("/odom", "nav_msgs/Odometry", ros_odometry(order, s)) for s in (1, 2)],
             "path": [("/path", "nav_msgs/Path", ros_path(order))],
             "tf": [("/tf", "tf2_msgs/TFMessage", ros_transforms(order, ("map", "odom"), ("odom", "base"), second=s))
                    for s in (1, 2)]}[poses]
    return static + found + [("/points", "sensor_msgs/PointCloud2", ros_cloud(order, s)) for s in (1, 2)]


def sized(data):
    return struct.pack("<I", len(data)) + data


def lz4_stored(raw):
    return b"\x04\x22\x4d\x18\x60\x40\x82" + struct.pack("<I", len(raw) | 1 << 31) + raw + bytes(4)


def zstd_stored(raw):
    return b"\x28\xb5\x2f\xfd\x60" + struct.pack("<H", len(raw) - 256) + struct.pack("<I", len(raw) << 3 | 1)[:3] + raw


def bag_record(data, **fields):
    return sized(b"".join(sized(name.encode() + b"=" + value) for name, value in fields.items())) + sized(data)


def rosbag1(messages, packing="none", closed=True):
    names = sorted({(topic, kind) for topic, kind, _ in messages})
    number = {topic: struct.pack("<I", i) for i, (topic, _) in enumerate(names)}
    connections = b"".join(
        bag_record(sized(b"topic=" + topic.encode()) + sized(b"type=" + kind.encode()), op=b"\7", conn=number[topic],
                   topic=topic.encode()) for topic, kind in names)
    body = connections + b"".join(bag_record(data, op=b"\2", conn=number[topic], time=struct.pack("<II", 3, 0))
                                  for topic, _, data in messages)
    pack = {"none": bytes, "bz2": bz2.compress, "lz4": lz4_stored}[packing]
    chunk = bag_record(pack(body), op=b"\5", compression=packing.encode(), size=struct.pack("<I", len(body)))
    index = bag_record(bytes(12), op=b"\4", ver=struct.pack("<I", 1), conn=bytes(4), count=struct.pack("<I", 1))

    def start(position):
        return b"#ROSBAG V2.0\n" + bag_record(b" " * 8, op=b"\3", index_pos=struct.pack("<Q", position),
                                              conn_count=struct.pack("<I", len(names)), chunk_count=struct.pack("<I", 1))
    whole = start(0) + chunk + index
    return start(len(whole)) + chunk + index + connections if closed else whole


def mcap_record(code, data):
    return struct.pack("<BQ", code, len(data)) + data


def mcap(messages, packing="", chunked=True, closed=True, encoding=b"cdr"):
    magic = b"\x89MCAP0\r\n"
    names = sorted({(topic, kind) for topic, kind, _ in messages})
    channels = b"".join(
        mcap_record(3, struct.pack("<H", i) + sized(kind.encode()) + sized(b"") + sized(b"")) +
        mcap_record(4, struct.pack("<HH", i, i) + sized(topic.encode()) + sized(encoding) + sized(b""))
        for i, (topic, kind) in enumerate(names, 1))
    number = {topic: i for i, (topic, _) in enumerate(names, 1)}
    body = channels + b"".join(mcap_record(5, struct.pack("<HIQQ", number[topic], 0, 3, 3) + data)
                               for topic, _, data in messages)
    packed = {"": bytes, "lz4": lz4_stored, "zstd": zstd_stored}[packing](body)
    if chunked:
        body = mcap_record(6, struct.pack("<QQQI", 3, 3, len(body), 0) + sized(packing.encode()) +
                           struct.pack("<Q", len(packed)) + packed) + mcap_record(7, struct.pack("<HI", 1, 16) + bytes(16))
    data = magic + mcap_record(1, sized(b"ros2") + sized(b"")) + body
    if not closed:
        return data
    data += mcap_record(15, bytes(4))
    return data + channels + mcap_record(2, struct.pack("<QQI", len(data), 0, 0)) + magic


def sqlite_bag(name, messages):
    """A rosbag 2. Pages as small as can be; the bytes depend on SQLite's version, so an older file is kept."""
    path = CORPUS / name
    if path.exists():
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    bag = sqlite3.connect(path)
    bag.execute("PRAGMA page_size = 512")
    bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
    bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
    names = sorted({(topic, kind) for topic, kind, _ in messages})
    number = {topic: i for i, (topic, _) in enumerate(names, 1)}
    for topic, kind in names:
        bag.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr')", (number[topic], topic, kind.replace("/", "/msg/")))
    for i, (topic, _, data) in enumerate(messages):
        bag.execute("INSERT INTO messages VALUES (?, ?, ?, ?)", (i, number[topic], 3000000000 + i, data))
    bag.commit()
    bag.close()


def write_bags():
    sqlite_bag("db3/odometry", drive("<", "odometry"))
    sqlite_bag("db3/path", drive(">", "path"))
    sqlite_bag("db3/empty", [])
    for order, word in ((None, "ros1"), ("<", "little"), (">", "big")):
        first = 8 if order else 0
        for kind, name, data in ((1, "cloud", ros_cloud(order)), (2, "odometry", ros_odometry(order)),
                                 (3, "pose", RosMessage(order).header(1, "map").pose().bytes()),
                                 (5, "path", ros_path(order)), (6, "transforms", ros_transforms(order, ("a", "b")))):
            write(f"ros_messages/{name}_{word}", bytes([first + kind]) + data)
    write("rosbag1/plain", rosbag1(drive(None, "odometry")))
    write("rosbag1/bz2", rosbag1(drive(None, "tf"), "bz2"))
    write("rosbag1/lz4", rosbag1(drive(None, "tf"), "lz4"))
    write("rosbag1/active", rosbag1(drive(None, "path"), closed=False))
    write("mcap/plain", mcap(drive("<", "odometry")))
    write("mcap/no_chunks", mcap(drive(">", "path"), chunked=False))
    write("mcap/lz4", mcap(drive("<", "tf"), "lz4"))
    write("mcap/zstd", mcap(drive("<", "tf"), "zstd"))
    write("mcap/no_end", mcap(drive("<", "path"), closed=False))
    write("mcap/ros1", mcap(drive(None, "odometry"), encoding=b"ros1"))


def main():
    write_trees()
    write("las/one_two", las(2, 1, 28, 2))
    write("las/one_four", las(4, 6, 30, 3))
    write("las/records", las(2, 0, 20, 1, bytes(20) + struct.pack("<H", 4) + bytes(32) + b"abcd", 1))
    write("las/compressed", las(2, 0x81, 28, 1))
    text = b"".join(b"%g %g %g\n" % p for p in XYZ)
    little = b"".join(struct.pack("<3f", *p) for p in XYZ)
    big = b"".join(struct.pack(">3f", *p) for p in XYZ)
    columns = struct.pack("<6f", *(p[axis] for axis in range(3) for p in XYZ))
    # 4 zeros, then 20 copied from one byte back: a block of two points at the origin.
    back_reference = struct.pack("<II", 8, 24) + bytes([3, 0, 0, 0, 0, (7 << 5) | 0, 11, 0])

    lists = '"robots": [%s], "submaps": [%s], "pairs": [%s]}'
    start = '{"schema": "kilter.result/1", '
    way = struct.pack("<3d", 1, 2, 3)
    write("archive/empty", archive(start + lists % ("", "", ""), struct.pack("<dI", 1, 0), struct.pack("<I", 0),
                                   struct.pack("<I", 0)))
    write("archive/pair", archive(start + lists % ("{}, {}", "{}, {}", "{}"),
                                  struct.pack("<dI", 1, 2) + struct.pack("<I", 1) + way + struct.pack("<I", 0),
                                  struct.pack("<I", 2) + cloud(3) + cloud(4),
                                  struct.pack("<I", 1) + pair(1, 0, 7, 2)))
    write("archive/unregistered", archive(start + lists % ("{}", "{}, {}", "{}"),
                                          struct.pack("<dII", 1, 1, 0), struct.pack("<I", 2) + cloud(2) + cloud(2),
                                          struct.pack("<I", 1) + pair(1, 0, 0, 1)))

    write("pcd/ascii", pcd("ascii", text))
    write("pcd/binary", pcd("binary", little))
    write("pcd/compressed", pcd("binary_compressed", compressed(columns)))
    write("pcd/back_reference", pcd("binary_compressed", back_reference))
    ring = b"".join(struct.pack("<4fH", *p, 0.5, 7) for p in XYZ)
    write("pcd/unaligned", pcd("binary", ring, "x y z intensity ring", "4 4 4 4 2", "F F F F U", "1 1 1 1 1"))
    double = b"".join(struct.pack("<3dBB", *p, 0, 0) for p in XYZ)
    write("pcd/double_padded", pcd("binary", double, "x y z _", "8 8 8 1", "F F F U", "1 1 1 2"))
    write("pcd/empty", pcd("binary", b"", points=0))
    write("pcd/no_count", pcd("ascii", text).replace(b"COUNT 1 1 1\n", b""))
    write("pcd/nan", pcd("ascii", b"nan nan nan\n1e400 1e30 0\n"))

    faces = "element face 1\nproperty list uchar int vertex_indices\n"
    face = struct.pack("<B2i", 2, 0, 1)
    write("ply/ascii", ply("ascii", text))
    write("ply/ascii_lists", ply("ascii", b"2 0 1\n" + text, before=faces))
    write("ply/little", ply("binary_little_endian", little))
    write("ply/little_lists", ply("binary_little_endian", face + little, before=faces))
    write("ply/big", ply("binary_big_endian", big))
    rows = b"".join(struct.pack("<3dHB", *p, 1, 9) for p in XYZ)
    write("ply/vertex_lists", ply("binary_little_endian", rows, after="property list ushort uchar l\n", kind="double"))

    write("bin/two_points", b"".join(struct.pack("<4f", *p, 0.5) for p in XYZ))
    write("bin/not_finite", struct.pack("<4f", float("nan"), float("inf"), 1e30, 0.0))

    write("poses/tum", "# t x y z qx qy qz qw\n0 1 2 3 0 0 0 1\n1.5 1 2 3 0 0 0.7071068 0.7071068\n")
    write("poses/kitti", "1 0 0 1 0 1 0 2 0 0 1 3\n0 -1 0 1e1 1 0 0 +2 0 0 1 3\n")
    write("poses/csv", "\ufeff0, 1, 2, 3, 0, 0, 0, 1\r\n")

    write_bags()

    write("config/keys", 'tolerance = 0.1\nalpha = 0.05\nregister = "always"\n')
    write("config/sensor", "T_body_sensor = [0, 0, 0.5, 0, 0, 0, 1]\n")
    write("config/sensors", '# by robot\n[T_body_sensor]\na = "1 0 0 0 0 0 1"\nb = [0, 0, 0, 0, 0, 0, 1]\n')
    write("config/quoted_hash", '"#&*#.m8m"\u03c6\\')
    write("config/long_text", 'tolerance = """\n# """ # \u00e9\n')
    write("cuts/two", '{"schema":"kilter.result/1","submaps":[{"robot":"a","first_scan":0,"last_scan":3},'
                      '{"robot":"a","first_scan":4,"last_scan":5}],"pairs":[{"target":"a/1"}]}')
    write("cuts/finished", '{"schema":"kilter.result/1","submaps":[{"robot":"a","first_scan":null,"last_scan":null}]}')

    layouts(little)


def layouts(little):
    """Texts beside clouds, as the programs that make such folders write them."""
    vertex = "VERTEX_SE3:QUAT %d 1 2 3 0 0 0.7071068 0.7071068\n"
    write("g2o/graph", "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n" + vertex % 1 + vertex % 0 +
          "FIX 0\nEDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1\n")
    write("g2o/planar", "VERTEX_SE2 0 0 0 0\n")
    write("g2o/twice", "\ufeff" + vertex % 7 + "# again\r\n" + vertex % 7)
    four = "".join(vertex % i for i in (2, 0, 3, 1))
    cuts = ('{"schema":"kilter.result/1","submaps":[{"robot":"a","first_scan":0,"last_scan":3},'
            '{"robot":"a","first_scan":4,"last_scan":%d}]}')
    write("submap_poses/fits", four + "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1\n")
    write("submap_poses/cut", four + "\0" + cuts % 5)
    write("submap_poses/other_scans", four + "\0" + cuts % 6)
    write("submap_poses/too_few", vertex % 0 + vertex % 4)
    write("pose_list/tum", "# timestamp tx ty tz qx qy qz qw\n1403636579.763555584 1 2 3 0 0 0 1\n"
          "1.4e+09 1 2 3 0 0 0 1\n")
    write("pose_list/kitti", "1 0 0 1 0 1 0 2 0 0 1 3\n")
    write("pose_list/g2o", vertex % 4 + vertex % 2)
    write("pose_list/euroc", "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
          "q_RS_y [], q_RS_z []\r\n1403636579763555584,1,2,3,1,0,0,0\r\n")
    write("pose_list/files", "file;t;x;y;z;qx;qy;qz;qw;note;\na/000001.pcd;0;1;2;3;0;0;0;1;good;\n")
    write("pose_list/blanks", "time_s x y z qx qy qz qw\n0.5 1 2 3 0 0 0 1\n")
    matrix = "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n"
    write("submap_text/glim", "gid: 0\nT_world_origin: \n" + matrix + "T_origin_endpoint_L: \n" + matrix +
          "num_frames: 1\nframe_0\nid: 0\nstamp: 12.500000000\nT_world_lidar: \n" + matrix)
    write("submap_text/hdl", "hstamp 1503043136 87654\nestimate\n" + matrix + "odom\n" + matrix +
          "accum_distance 3.5\nfloor_coeffs 0 0 1 0.4\nid 4\n")
    write("submap_text/kitti", "kP0: 718 0 607 0 0 718 185 0 0 0 1 0\nTr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n")
    write("submap_text/points", b"." + little)


if __name__ == "__main__":
    main()
