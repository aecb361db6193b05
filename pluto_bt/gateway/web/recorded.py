"""The console on a black box: the same page, which asks what was true at a time."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable

from aiohttp import web

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.web.doorkeeper import Doorkeeper
from pluto_bt.gateway.web.house import make_app
from pluto_bt.gateway.wire import Scenery

MOST_S = 1e9


class RecordedSite:
    """The console of one recording; `moment` gives what was known at a second of the run, in the words of the protocol."""

    def __init__(self, scenery: Scenery, moment: Callable[[float], bytes]) -> None:
        self._moment = moment
        app = make_app(scenery, Access())
        app.router.add_get("/moment", self._answer)
        self._keeper = Doorkeeper(app)

    def serve(self, listener: socket.socket) -> None:
        """Until somebody interrupts."""
        listener.setblocking(False)
        asyncio.run(self._keeper.listen(listener))

    async def _answer(self, request: web.Request) -> web.Response:
        try:
            t_s = float(request.query.get("at", ""))
        except ValueError:
            t_s = -1.0
        if not 0.0 <= t_s <= MOST_S:
            raise web.HTTPBadRequest(text="expected at=SECONDS of the run, a number from 0\n")
        return web.Response(body=self._moment(t_s), content_type="text/plain", charset="utf-8")
