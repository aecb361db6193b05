"""The pytest plugin: a `scenario` fixture that runs missions in simulated worlds. It imports nothing heavy until it is used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pluto_bt.scenario import Play


@pytest.fixture
def scenario(request: pytest.FixtureRequest) -> Play:
    """Run a mission: `run = scenario("yard.xml", mission="patrol.xml", seed=3, ports={"goals": "3,0;6,2"})`.

    Files are looked for as on the command line, and beside the test file. See `pluto_bt.scenario.Run` for what can be asked of a run.
    """
    from pluto_bt.scenario import Play

    return Play(request.path.parent)
