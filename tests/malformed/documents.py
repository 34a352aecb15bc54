# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged files that kilter itself wrote or is told by: cuts of a result.json, the archive result.kilter, a configuration."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Iterator

from .case import Case, binary_bombs, flipped, seeds

CUTS = {"schema": "kilter.result/1", "submaps": [{"robot": "a", "first_scan": 0, "last_scan": 1}, {"robot": "a", "first_scan": 2, "last_scan": 2}]}


def changed_cuts(submap: int, key: str, value: object) -> bytes:
    submaps = [dict(row) for row in CUTS["submaps"]]
    submaps[submap][key] = value
    return json.dumps(CUTS | {"submaps": submaps}).encode()


def cuts() -> Iterator[Case]:
    good = json.dumps(CUTS).encode()
    damages = {f"cut_at_{at}": good[:at] for at in range(0, len(good), 12)}
    damages |= {f"schema_{i}": json.dumps(CUTS | {"schema": value}).encode() for i, value in enumerate(["other/1", 7, None, [], "kilter.result/9"])}
    damages |= {f"submaps_{i}": json.dumps(CUTS | {"submaps": value}).encode() for i, value in enumerate([[], {}, None, 7, "a", [7], [[]], [None]])}
    for key in ("first_scan", "last_scan"):
        for i, value in enumerate([-1, 1.5, "2", None, 1e30, 2**63, 2**64, 10**40, [], {}, True, 3]):
            damages[f"{key}_{i}"] = changed_cuts(1, key, value)
    damages |= {f"robot_{i}": changed_cuts(0, "robot", value) for i, value in enumerate([None, 7, [], "nobody", "\x1b[2J"])}
    damages |= {"nested": b"[" * 200_000, "nested_objects": b'{"a":' * 200_000, "nested_submaps": b'{"schema":"kilter.result/1","submaps":' + b"[" * 100_000,
                "nan": good.replace(b"2}", b"NaN}"), "comment": b"/* none */" + good, "two_values": good + good, "zeros": bytes(400),
                "latin_1": good.replace(b'"a"', b'"\xe4"'), "long_number": good.replace(b"2}", b"2" * 100_000 + b"}"),
                "keys_twice": good[:-1] + b', "submaps": []}'}
    for name, content in damages.items():
        yield Case("cuts", name, {".json": content})
    for name, content in {"spaces": json.dumps(CUTS, indent=4).encode(), "more_keys": json.dumps(CUTS | {"pairs": [[[1]]]}).encode(),
                          "byte_order_mark": b"\xef\xbb\xbf" + good}.items():
        yield Case("cuts", name, {".json": content}, tolerated=True)


def archives() -> Iterator[Case]:
    """Every section with its checksum made right again, so that its content is what is tried."""
    head = '{"schema": "kilter.result/1", "robots": [{}, {}], "submaps": [{}, {}], "pairs": [{}]}'
    way = struct.pack("<3d", 1, 2, 3)
    paths = struct.pack("<dI", 1, 2) + struct.pack("<I", 1) + way + struct.pack("<I", 0)
    clouds = struct.pack("<I", 2) + seeds.cloud(3) + seeds.cloud(4)
    pairs = struct.pack("<I", 1) + seeds.pair(1, 0, 7, 2)
    good = seeds.archive(head, paths, clouds, pairs)
    yield Case("archive", "good", {".kilter": good}, tolerated=True)
    for at in [0, 4, 8, 12, 16, 20, 24, 31, 40, *range(60, len(good), 40), len(good) - 1]:
        yield Case("archive", f"cut_at_{at}", {".kilter": good[:at]})
    for bit in (0, 65, 90, 97, 140, 200, 230, 2000):
        yield Case("archive", f"bit_{bit}", {".kilter": flipped(good, bit)})
    yield Case("archive", "bytes_behind", {".kilter": good + b"\0"})
    for at in (8, 12):  # how many robots, how many points of the first one's way
        yield Case("archive", f"paths_bomb_at_{at}", {".kilter": seeds.archive(head, paths[:at] + b"\xff" * 4 + paths[at + 4:], clouds, pairs)})
    for name, bomb in binary_bombs(4):
        yield Case("archive", f"clouds_{name}", {".kilter": seeds.archive(head, paths, bomb + clouds[4:], pairs)})
        yield Case("archive", f"points_{name}", {".kilter": seeds.archive(head, paths, clouds[:44] + bomb + clouds[48:], pairs)})
        yield Case("archive", f"pairs_{name}", {".kilter": seeds.archive(head, paths, clouds, bomb + pairs[4:])})
        yield Case("archive", f"source_{name}", {".kilter": seeds.archive(head, paths, clouds, pairs[:4] + bomb + pairs[8:])})
        yield Case("archive", f"stride_{name}", {".kilter": seeds.archive(head, paths, clouds, pairs[:36] + bomb + pairs[40:])})
    for name, text in {"no_json": "", "words": "nonsense", "nested": "[" * 100_000, "schema": head.replace("result/1", "result/2"),
                       "fewer_pairs": head.replace('"pairs": [{}]', '"pairs": []'), "fewer_submaps": head.replace('"submaps": [{}, {}]', '"submaps": [{}]'),
                       "fewer_robots": head.replace('"robots": [{}, {}]', '"robots": []')}.items():
        yield Case("archive", f"json_{name}", {".kilter": seeds.archive(text, paths, clouds, pairs)})
    for name, content in {"search_distance_0": struct.pack("<d", 0), "search_distance_nan": struct.pack("<d", float("nan")),
                          "search_distance_below_0": struct.pack("<d", -1)}.items():
        yield Case("archive", name, {".kilter": seeds.archive(head, content + paths[8:], clouds, pairs)})
    yield Case("archive", "stride_0", {".kilter": seeds.archive(head, paths, clouds, pairs[:36] + bytes(4) + pairs[40:])})
    yield Case("archive", "pair_with_itself", {".kilter": seeds.archive(head, paths, clouds, pairs[:4] + bytes(8) + pairs[12:])})
    body = b"JUNK" + struct.pack("<IQ", zlib.crc32(b""), 0)
    yield Case("archive", "fifth_section", {".kilter": good[:12] + struct.pack("<I", 5) + good[16:] + body})


def configurations() -> Iterator[Case]:
    """A configuration that is wrong ends with the status of a wrong command line."""
    texts = {"word": b"tolerance\n", "no_value": b"tolerance =\n", "other_key": b"tolerances = 0.1\n", "negative": b"tolerance = -1\n", "nan": b"tolerance = nan\n",
             "inf": b"tolerance = inf\n", "text": b'tolerance = "wide"\n', "list": b"tolerance = [1]\n", "table": b"[tolerance]\na = 1\n",
             "twice": b"tolerance = 0.1\ntolerance = 0.2\n", "huge": b"min_matches = 99999999999999999999999\n", "zeros": bytes(400),
             "ones": b"\xff" * 400, "open_string": b'fit = "mom\n', "open_table": b"[T_body_sensor\n", "nested": b"a = " + b"[" * 100_000,
             "nested_tables": b"a = " + b"{b = " * 50_000, "dotted": b"a" + b".a" * 50_000 + b" = 1\n", "dotted_to_the_end": b"a" + b".a" * 500_000 + b" = 1\n",
             "dotted_table": b"[" + b"a." * 200_000 + b"a]\n", "letters_behind_a_quoted_hash": "\"#\"\u03c6\\".encode(), "dotted_behind_a_quoted_hash": b'"#"' + b".a" * 500_000 + b" = 1\n",
             "dotted_behind_a_long_text": b'a = """\n# """\nb' + b".a" * 500_000 + b" = 1\n", "letters_of_no_key": "429\u033e672T95:_".encode(), "brace_in_a_list": b"T_body_sensor = [0, 0, 0.5, 0,} 0, 0, 1]\n", "date": b"tolerance = 1979-05-27\n",
             "control": b"tolerance = \x1b[2J\n", "sensor_of_six": b"[T_body_sensor]\na = [0, 0, 0, 0, 0, 0]\n",
             "sensor_no_rotation": b"[T_body_sensor]\na = [0, 0, 0, 0, 0, 0, 0]\n"}
    for name, text in texts.items():
        yield Case("config", name, {".toml": text})
    for name, text in {"empty": b"", "comment": b"# nothing\n", "crlf": b"tolerance = 0.1\r\n", "comment_behind_a_text": "tolerance = \"10 cm\"  # H\u00f6he\n".encode(), "byte_order_mark": b"\xef\xbb\xbftolerance = 0.1\n"}.items():
        yield Case("config", name, {".toml": text}, tolerated=True)


def cases() -> Iterator[Case]:
    for family in (cuts, archives, configurations):
        yield from family()
