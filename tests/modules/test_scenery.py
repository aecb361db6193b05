"""What the web console is given to draw."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from PIL import Image

from pluto_bt.files import package_root
from pluto_bt.maps.load import load_world
from pluto_bt.maps.world import OccupancyGrid, World
from pluto_bt.modules.robot_file import SHIPPED, load_robot_file
from pluto_bt.modules.scenery import PALETTE, coarse, scenery


def grid_of(rows: list[list[int]], unknown: list[list[int]] | None = None) -> OccupancyGrid:
    occupied = np.array(rows, np.uint8)
    return OccupancyGrid(occupied, np.zeros_like(occupied) if unknown is None else np.array(unknown, np.uint8), 0.5, (1.0, 2.0, 0.25))


@pytest.mark.parametrize("platform", SHIPPED)
def test_the_yard_and_every_robot_can_be_told(platform: str) -> None:
    made = scenery(load_world(package_root() / "sim" / "worlds" / "yard.xml"), load_robot_file(platform), "pluto", mode="live")
    shown = json.loads(made.json)
    ids = {shape["id"] for shape in shown["world"]["shapes"]}
    assert {"yard-wall", "house", "oak"} <= ids and "crate" not in ids, "what comes only later is for the sensors"
    assert {goal["id"] for goal in shown["world"]["goals"]} >= {"gate", "pump"} and shown["mode"] == "live"
    assert shown["robot"]["turns_on_the_spot"] == (platform != "car") and len(shown["robot"]["outline_m"]) >= 3
    assert made.pictures == {}


def test_a_grid_is_a_picture_with_the_highest_y_on_top() -> None:
    made = scenery(World("w", grid=grid_of([[0, 0, 1], [0, 0, 0]], [[0, 1, 0], [0, 0, 0]])), load_robot_file("atrv2"), "r")
    frame = json.loads(made.json)["grid"]
    assert frame == {"picture": "grid.png", "rows": 2, "columns": 3, "cell_m": 0.5, "origin": [1.0, 2.0, 0.25]}
    image = np.array(Image.open(io.BytesIO(made.pictures["grid.png"])).convert("RGBA"))
    assert image.shape == (2, 3, 4)
    free, occupied, unknown = PALETTE
    assert [tuple(pixel) for pixel in image[1]] == [free, unknown, occupied] and (image[0] == free).all()


def test_a_huge_grid_keeps_its_walls_when_it_is_made_coarser() -> None:
    rng = np.random.default_rng(1)
    occupied, unknown = (rng.random((2, 101, 57)) < 0.05).astype(np.uint8)
    small = coarse(OccupancyGrid(occupied, unknown, 0.1, (0.0, 0.0, 0.0)), 10)
    n = round(small.resolution_m / 0.1)
    assert max(small.occupied.shape) <= 10 and small.occupied.shape == (-(-101 // n), -(-57 // n))
    for i, j in np.ndindex(small.occupied.shape):
        part = np.s_[i * n : (i + 1) * n, j * n : (j + 1) * n]
        assert small.occupied[i, j] == occupied[part].max() and small.unknown[i, j] == unknown[part].min()
