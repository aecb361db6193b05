"""ROS maps: the three modes, the images, every fault with its place."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image
from shared_data import shared_file

from pluto_bt.maps.load import load_world
from pluto_bt.maps.world import OccupancyGrid
from pluto_bt.source import Fault, Faults, InputError

YAML = "image: m.pgm\nresolution: 0.5\norigin: [-1.0, 2, 0.25]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def pgm(pixels: np.ndarray, white: int = 255, comment: bool = False) -> bytes:
    rows, columns = pixels.shape
    head = f"P5\n{'# made by hand' + chr(10) if comment else ''}{columns} {rows}\n{white}\n"
    return head.encode() + pixels.astype(">u2" if white > 255 else "u1").tobytes()


def png(pixels: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def grid_of(folder: Path, image: bytes, yaml: str = YAML) -> OccupancyGrid:
    (folder / "m.yaml").write_text(yaml)
    (folder / "m.pgm").write_bytes(image)
    grid = load_world(folder / "m.yaml", "m.yaml").grid
    assert grid is not None
    return grid


def faults_of(folder: Path, image: bytes | None, yaml: str = YAML) -> tuple[Fault, ...]:
    (folder / "m.yaml").write_text(yaml)
    if image is not None:
        (folder / "m.pgm").write_bytes(image)
    with pytest.raises(InputError) as caught:
        load_world(folder / "m.yaml", "m.yaml")
    return caught.value.faults


PIXELS = np.array([[0, 100, 205], [254, 89, 206]], dtype=np.uint8)


@pytest.mark.parametrize(
    ("settings_", "occupied", "unknown"),
    [
        ("mode: trinary", [[0, 1, 0], [1, 0, 0]], [[0, 0, 0], [0, 1, 1]]),
        ("", [[0, 1, 0], [1, 0, 0]], [[0, 0, 0], [0, 1, 1]]),
        ("mode: scale", [[0, 1, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, 0]]),
        ("mode: raw", [[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [0, 0, 1]]),
    ],
)
def test_the_top_row_of_the_image_is_the_last_of_the_grid(tmp_path: Path, settings_: str, occupied: list, unknown: list) -> None:  # type: ignore[type-arg]
    grid = grid_of(tmp_path, pgm(PIXELS, comment=True), YAML + settings_)
    assert grid.occupied.tolist() == occupied and grid.unknown.tolist() == unknown
    assert (grid.resolution_m, grid.origin) == (0.5, (-1.0, 2.0, 0.25))
    assert not grid.occupied.flags.writeable and not grid.unknown.flags.writeable


def test_negate_turns_black_and_white(tmp_path: Path) -> None:
    grid = grid_of(tmp_path, pgm(PIXELS), YAML.replace("negate: 0", "negate: true"))
    assert grid.occupied.tolist() == [[1, 0, 1], [0, 0, 1]]


def test_thresholds_are_those_of_map_server_and_have_its_defaults(tmp_path: Path) -> None:
    """205 of 255 is the grey that map_saver writes for unknown: darkness 0.19608 lies above 0.196, but below nav2's default 0.25."""
    pixels = np.array([[205]])
    assert grid_of(tmp_path, pgm(pixels)).unknown.tolist() == [[1]]
    assert grid_of(tmp_path, pgm(pixels), "image: m.pgm\nresolution: 5e-2\norigin: [0, 0, 0]").unknown.tolist() == [[0]]


@pytest.mark.parametrize(
    "image",
    [
        pgm(PIXELS), pgm(PIXELS.astype(int) * 257, 65535), png(PIXELS), png(np.dstack([PIXELS] * 3)), png(PIXELS.astype(np.uint16) * 257),
        b"P2\n# text\n3 2\n255\n0 100 205\n# between\n254 89 206\n", png(np.dstack([PIXELS] * 3 + [np.full((2, 3), 255, np.uint8)])),
    ],
)  # fmt: skip
def test_all_kinds_of_images_give_the_same_map(tmp_path: Path, image: bytes) -> None:
    grid = grid_of(tmp_path, image)
    assert grid.occupied.tolist() == [[0, 1, 0], [1, 0, 0]] and grid.unknown.tolist() == [[0, 0, 0], [0, 1, 1]]


def test_transparent_pixels_are_unknown_in_scale_mode(tmp_path: Path) -> None:
    pixels = np.zeros((1, 2, 4), np.uint8)
    pixels[0, 1, 3] = 255
    grid = grid_of(tmp_path, png(pixels), YAML + "mode: scale")
    assert grid.occupied.tolist() == [[0, 1]] and grid.unknown.tolist() == [[1, 0]]


@pytest.mark.parametrize(("name", "shape", "occupied"), [("nav2_depot", (307, 604), 5947), ("nav2_tb3_sandbox", (384, 384), 870)])
def test_real_maps(name: str, shape: tuple[int, int], occupied: int) -> None:
    world = load_world(shared_file("data", "maps", f"{name}.yaml"))
    assert world.grid is not None
    assert world.grid.occupied.shape == shape and int(world.grid.occupied.sum()) == occupied
    assert world.grid.resolution_m == 0.05 and world.name == name


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "code", "message"),
    [
        ("resolution: 0.5", "resolution: 0", 2, 13, "bad-value", "resolution must be greater than 0"),
        ("resolution: 0.5", "resolution: -1", 2, 13, "bad-value", "resolution must be a number from 0 to 1e+06"),
        ("resolution: 0.5", "resolution: .nan", 2, 13, "bad-value", "resolution must be a number from 0 to 1e+06"),
        ("resolution: 0.5", "resolution: .inf", 2, 13, "bad-value", "resolution must be a number from 0 to 1e+06"),
        ("resolution: 0.5", "resolution: wide", 2, 13, "bad-value", "resolution must be a number from 0 to 1e+06"),
        ("resolution: 0.5", "resolution: [1]", 2, 13, "bad-value", "resolution must be a number from 0 to 1e+06"),
        ("resolution: 0.5", "#", 1, 1, "missing-key", 'key "resolution" is missing'),
        ("origin: [-1.0, 2, 0.25]", "#", 1, 1, "missing-key", 'key "origin" is missing'),
        ("image: m.pgm", "#", 1, 1, "missing-key", 'key "image" is missing'),
        ("origin: [-1.0, 2, 0.25]", "origin: [1, 2]", 3, 9, "bad-value", "origin must be a list of three numbers"),
        ("origin: [-1.0, 2, 0.25]", "origin: [1, .nan, 0]", 3, 13, "bad-value", "number 2 of origin is no finite number"),
        ("origin: [-1.0, 2, 0.25]", "origin: [1, 2, north]", 3, 16, "bad-value", "number 3 of origin is no finite number"),
        ("image: m.pgm", "image: 7", 1, 8, "bad-value", "image must name a file"),
        ("image: m.pgm", "image: n.pgm", 1, 8, "no-file", 'there is no file "n.pgm"'),
        ("free_thresh: 0.196", "free_thresh: 0.9", 6, 14, "bad-value", "free_thresh is greater than occupied_thresh"),
        ("free_thresh: 0.196", "free_thresh: 20", 6, 14, "bad-value", "free_thresh must be a number from 0 to 1"),
        ("negate: 0", "negate: 0\nmode: trinry", 5, 7, "bad-value", "unknown mode"),
        ("negate: 0", "negate: 2", 4, 9, "bad-value", "negate must be a number from 0 to 1"),
    ],
)
def test_each_fault_of_the_yaml_is_told_with_its_place(
    tmp_path: Path, old: str, new: str, line: int, column: int, code: str, message: str
) -> None:
    fault = faults_of(tmp_path, pgm(PIXELS), YAML.replace(old, new))[0]
    assert (fault.file, fault.line, fault.column, fault.code, fault.message) == ("m.yaml", line, column, code, message)
    assert fault.expected and fault.found


def test_unknown_keys_are_warned_of(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(YAML + "occupied_tresh: 0.7\n")
    (tmp_path / "m.pgm").write_bytes(pgm(PIXELS))
    warnings = Faults()
    load_world(tmp_path / "m.yaml", "m.yaml", warnings)
    (warning,) = warnings.in_order()
    assert (warning.severity, warning.line, warning.mend) == ("warning", 7, 'did you mean "occupied_thresh"?')


BAD_IMAGES = {
    "empty": (b"", "is empty"),
    "garbage": (b"\x00\x01nonsense" * 10, "is no image that can be read"),
    "cut off": (pgm(PIXELS)[:-1], "is cut off"),
    "cut off text": (b"P2 3 2 255 1 2 3 4 5", "is cut off"),
    "text with words": (b"P2 3 2 255 1 2 3 x 5 6", "has a pixel that is no whole number"),
    "no head": (b"P5\n3 two\n255\n", "has no PGM head"),
    "zero columns": (b"P5\n0 2\n255\n", "has no pixels"),
    "huge": (b"P5\n99999 99999\n255\n", "is too large"),
    "white 0": (b"P5\n3 2\n0\n      ", "has an impossible white value"),
    "beyond white": (b"P2 1 1 9 10", "has pixels beyond its white value"),
    "negative": (b"P2 1 1 9 -1", "has a pixel that is no whole number"),
    "long numbers": (b"P2 1 1 9 " + b"9" * 100, "has a pixel that is no whole number"),
    "cut off png": (png(np.arange(10000, dtype=np.uint8).reshape(100, 100))[:-60], "is cut off"),
    "damaged png": (png(PIXELS).replace(b"IDAT", b"IDAX"), "is "),
    "png head only": (png(PIXELS)[:30], "is "),
    "gif": (b"GIF89a" + b"\0" * 50, "is no image that can be read"),
}


@pytest.mark.parametrize("name", BAD_IMAGES)
def test_bad_images_are_told_where_the_yaml_names_them(tmp_path: Path, name: str) -> None:
    image, message = BAD_IMAGES[name]
    (fault,) = faults_of(tmp_path, image)
    assert (fault.file, fault.line, fault.column) == ("m.yaml", 1, 8)
    assert fault.message.startswith(f'image "m.pgm" {message}') and fault.expected and fault.found


def test_a_huge_png_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    for side, found in ((8100, "8100 x 8100"), (60000, "far more")):
        head = struct.pack(">4sIIBBBBB", b"IHDR", side, side, 1, 0, 0, 0, 0)
        image = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + head + struct.pack(">I", zlib.crc32(head)) + png(PIXELS)[33:]
        (fault,) = faults_of(tmp_path, image)
        assert (fault.code, fault.found) == ("too-large", found)


def test_a_bare_image_is_no_world(tmp_path: Path) -> None:
    for name, image in (("a.png", png(PIXELS)), ("b.pgm", pgm(PIXELS)), ("c", png(PIXELS))):
        (tmp_path / name).write_bytes(image)
        with pytest.raises(InputError) as caught:
            load_world(tmp_path / name, name)
        (fault,) = caught.value.faults
        assert (fault.code, fault.mend) == ("bare-image", "give the .yaml that says what the image means: image, resolution, origin")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=40)
@given(arrays(np.uint8, st.tuples(st.integers(1, 9), st.integers(1, 9))), st.booleans())
def test_cells_follow_the_formula_of_map_server(tmp_path: Path, pixels: np.ndarray, negate: bool) -> None:
    grid = grid_of(tmp_path, pgm(pixels), YAML.replace("negate: 0", f"negate: {int(negate)}"))
    for row in range(pixels.shape[0]):
        for column in range(pixels.shape[1]):
            shade = pixels[row, column] / 255
            dark = shade if negate else 1 - shade
            cell = (pixels.shape[0] - 1 - row, column)
            assert (grid.occupied[cell], grid.unknown[cell]) == ((1, 0) if dark > 0.65 else (0, 0) if dark < 0.196 else (0, 1))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=100)
@given(st.sampled_from([pgm(PIXELS), png(PIXELS), b"P2 3 2 255 1 2 3 4 5 6"]), st.data())
def test_damaged_images_are_read_or_refused(tmp_path: Path, image: bytes, data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(image)))
    damaged = image[:at] + data.draw(st.binary(max_size=4)) + image[at + data.draw(st.integers(0, 4)) :]
    try:
        grid_of(tmp_path, damaged)
    except InputError as error:
        assert error.faults
