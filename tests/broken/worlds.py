"""Broken worlds, ROS maps and ARNL maps: name → (text, the faults as "line:column code")."""

from __future__ import annotations

import struct
import zlib

SQUARE = "0,0 4,0 4,4 0,4"


def world(body: str, attributes: str = 'name="w"') -> str:
    """A world whose body stands in line 2 from column 3 on, its robot in line 3."""
    return f'<world {attributes}>\n  {body}\n  <robot x="0" y="0"/>\n</world>\n'


def script(action: str) -> str:
    """A world with one scripted action, which stands in column 25 of line 2."""
    return world(f'<script><at t="1">{action}</at></script>')


WORLDS = {
    "unknown element": (world('<wal id="a">0,0 1,1</wal>'), "2:3 unknown-element"),
    "unknown attribute": (world('<wall id="a" color="red">5,5 6,6</wall>'), "2:16 unknown-attribute"),
    "NaN": (world('<circle x="nan" y="3" r="1"/>'), "2:14 bad-value"),
    "endless": (world('<circle x="inf" y="3" r="1"/>'), "2:14 bad-value"),
    "too far": (world('<circle x="1e9" y="3" r="1"/>'), "2:14 bad-value"),
    "radius 0": (world('<circle x="5" y="3" r="0"/>'), "2:26 bad-value"),
    "self-crossing": (world("<polygon>5,5 7,7 7,5 5,7</polygon>"), "2:12 self-crossing"),
    "two corners": (world("<polygon>5,5 7,7</polygon>"), "2:12 too-few-points"),
    "flat": (world("<polygon>5,5 6,6 7,7</polygon>"), "2:12 zero-area"),
    "no points": (world("<wall>5,5 6;6 7</wall>"), "2:13 bad-point 2:17 bad-point"),
    "wall without length": (world("<wall>5,5 5,5</wall>"), "2:9 zero-length"),
    "one id twice": (world('<circle id="a" x="5" y="5" r="1"/><circle id="a" x="8" y="5" r="1"/>'), "2:49 duplicate-id"),
    "two robots": (world('<robot x="1" y="1"/>'), "3:3 duplicate-element"),
    "no such platform": ('<world>\n<robot platform="nope"/></world>', "2:1 unknown-platform"),
    "seed": (world("", 'seed="-1"'), "1:14 bad-value"),
    "kind of area": (world(f'<area id="a" kind="foo">{SQUARE}</area>'), "2:22 bad-value"),
    "goal without id": (world('<goal x="1" y="1"/>'), "2:3 missing-attribute"),
    "backward actor": (world('<actor id="a" r="1" speed="-1">5,5 6,6</actor>'), "2:30 bad-value"),
    "slip above 1": (world(f'<terrain id="t" slip="2">{SQUARE}</terrain>'), "2:25 bad-value"),
    "text": (world("hello"), "2:3 unexpected-text"),
    "start in a circle": (world('<circle id="c" x="0" y="0" r="1"/>'), "3:3 start-blocked"),
    "start inside a polygon": (world("<polygon>-9,-9 9,-9 9,9 -9,9</polygon>"), "3:3 start-blocked"),
    "start across a wall": (world("<wall>-9,0 9,0</wall>"), "3:3 start-blocked"),
    "start over a hole": (world('<hole id="h">-1,-1 1,-1 1,1 -1,1</hole>'), "3:3 start-blocked"),
    "start on someone": (world('<actor id="a" r="1" speed="1">0,0 6,6</actor>'), "3:3 start-blocked"),
    "unknown id in a script": (script('<remove id="no"/>'), "2:33 unknown-id"),
    "unknown device": (script('<fault device="lazer" kind="fatal"/>'), "2:36 unknown-device"),
    "unknown fault": (script('<fault device="laser" kind="fatl"/>'), "2:49 unknown-fault-kind"),
    "senseless fault": (script('<fault device="laser" kind="slip"/>'), "2:49 unknown-fault-kind"),
    "unknown module": (script('<fault device="module:nope" kind="raise"/>'), "2:21 unknown-module"),
    "topic of another": (script('<set topic="drive/status" value="true"/>'), "2:21 read-only"),
    "no flag": (script('<set topic="world/alarm" value="maybe"/>'), "2:21 bad-value"),
    "empty at": (world('<script><at t="1"/></script>'), "2:11 no-action"),
    "missing map": (world('<map src="nope.yaml"/>'), "2:13 no-file"),
    "a world as map": (world('<map src="w.xml"/>'), "2:13 bad-value"),
    "too many points": (world(f"<wall>{'1,1 ' * 200_010}</wall>"), "1:1 too-many-nodes"),
    "too deep": ("<world>\n" * 300, "257:1 too-deep"),
    "entity bomb": ('<!DOCTYPE w [<!ENTITY a "aaaa">]><world>&a;</world>', "1:1 doctype"),
    "a mission": ('<root BTCPP_format="4"/>', "1:1 no-world"),
    "empty": ("", "1:1 no-root"),
}  # fmt: skip

KEYS = {"image": "good.png", "resolution": "0.05", "origin": "[0, 0, 0]", "negate": "0", "occupied_thresh": "0.65", "free_thresh": "0.196"}


def ros_map(**changed: object) -> str:
    """A map file with some keys changed, or left out (None), or added."""
    return "".join(f"{key}: {value}\n" for key, value in (KEYS | changed).items() if value is not None)


MAPS = {
    "resolution 0": (ros_map(resolution=0), "2:13 bad-value"),
    "resolution below 0": (ros_map(resolution=-1), "2:13 bad-value"),
    "resolution NaN": (ros_map(resolution=".nan"), "2:13 bad-value"),
    "resolution endless": (ros_map(resolution=".inf"), "2:13 bad-value"),
    "resolution of atoms": (ros_map(resolution="1e-300"), "2:13 bad-value"),
    "resolution missing": (ros_map(resolution=None), "1:1 missing-key"),
    "origin of two": (ros_map(origin="[1, 2]"), "3:9 bad-value"),
    "origin NaN": (ros_map(origin="[1, .nan, 0]"), "3:13 bad-value"),
    "thresholds crossed": (ros_map(free_thresh=0.9), "6:14 bad-value"),
    "unknown mode": (ros_map(mode="trinry"), "7:7 bad-value"),
    "image missing": (ros_map(image="no.png"), "1:8 no-file"),
    "image is a folder": (ros_map(image="."), "1:8 no-file"),
    "image is a pipe": (ros_map(image="pipe.pgm"), "1:8 no-file"),
    "image cut off": (ros_map(image="cut.png"), "1:8 bad-image"),
    "end cut off": (ros_map(image="endless.png"), "1:8 bad-image"),
    "pixels cut off": (ros_map(image="cut.pgm"), "1:8 bad-image"),
    "image empty": (ros_map(image="empty.pgm"), "1:8 bad-image"),
    "image of nothing": (ros_map(image="nothing.pgm"), "1:8 bad-image"),
    "image bomb": (ros_map(image="bomb.png"), "1:8 too-large"),
    "no mapping": ("- 1\n- 2\n", "1:1 yaml-type"),
    "empty mapping": ("{}", "1:1 missing-key 1:1 missing-key 1:1 missing-key"),
    "no YAML": ("image: [1,\nresolution", "2:11 yaml-syntax"),
    "alias": ("a: &a [1]\nb: *a\n", "2:4 yaml-syntax"),
    "key twice": (ros_map() + "image: good.png\n", "7:1 yaml-syntax"),
    "nested": ("[" * 5000, "1:21 yaml-syntax"),
}  # fmt: skip

ARNL = {
    "no ARNL map": ("3D-Map\n", "1:1 no-arnl-map"),
    "row of three": ("2D-Map\nLINES\n1 2 3\n", "3:1 bad-number"),
    "NaN": ("2D-Map\nLINES\n1 2 nan 4\n", "3:1 bad-number"),
    "count below 0": ("2D-Map\nNumLines: -5\nLINES\n1 2 3 4\n", "2:1 bad-number"),
    "no section": ("2D-Map\nNumLines: 0\n", "3:1 missing-section"),
    "short object": ('2D-Map\nCairn: Goal x 2 0 "" ICON "a"\nLINES\n1 2 3 4\n', "2:13 bad-number"),
    "points apart": ("2D-Map\nDATA\n0 0\n1e9 1e9\n", "1:1 too-large"),
    "junk": ("2D-Map\nfoo bar\nLINES\n1 2 3 4\n", "2:1 bad-line"),
    "home on a wall": ('2D-Map\nCairn: RobotHome 0 0 0 "" ICON ""\nLINES\n-5000 0 5000 0\n', "2:8 start-blocked"),
}


def png(columns: int, rows: int, pixels: bytes) -> bytes:
    """A grey PNG that says it has so many pixels, with these bytes in it."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b"")


WHITE = png(50, 50, (b"\0" + b"\xfe" * 50) * 50)
IMAGES = {
    "good.png": WHITE, "cut.png": WHITE[:60], "endless.png": WHITE[:-8], "bomb.png": png(60_000, 60_000, b"\0"), "empty.pgm": b"",
    "cut.pgm": b"P5\n50 50\n255\n" + b"\0" * 100, "nothing.pgm": b"P5\n0 0\n255\n",
}  # fmt: skip
