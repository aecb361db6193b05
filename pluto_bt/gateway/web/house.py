"""What every console page is served with: the files of the page, and the rules at the door that keep other pages and programs out."""

from __future__ import annotations

import ipaddress
from collections.abc import Awaitable, Callable
from importlib import resources

from aiohttp import web
from aiohttp.typedefs import Middleware

from pluto_bt.gateway.access import Access, Key
from pluto_bt.gateway.sockets import common_name
from pluto_bt.gateway.wire import Scenery

TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml"}
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


def make_app(scenery: Scenery, access: Access) -> web.Application:
    """The page and its scenery; `access` guards the scenery, the page itself says nothing of the robot."""
    app = web.Application(middlewares=[_door(may_be_named=bool(access.keys))])
    app.on_response_prepare.append(_dress)
    for path, (body, kind) in page_files().items():
        app.router.add_get(f"/{path}".removesuffix("index.html"), _file(body, kind))

    async def scene(request: web.Request) -> web.Response:
        require_known(request, access)
        return web.Response(body=scenery.json, content_type="application/json", charset="utf-8")

    async def picture(request: web.Request) -> web.Response:
        require_known(request, access)
        body = scenery.pictures.get(request.match_info["name"])
        if body is None:
            raise web.HTTPNotFound
        return web.Response(body=body, content_type="image/png")

    app.router.add_get("/scenery.json", scene)
    app.router.add_get("/pictures/{name}", picture)
    return app


def page_files() -> dict[str, tuple[bytes, str]]:
    """The files of the page by name, each with its type."""
    folder = resources.files("pluto_bt.gateway.web") / "static"
    files = [entry for entry in folder.iterdir() if "." in entry.name]
    kinds = {entry.name: TYPES.get(entry.name[entry.name.rindex(".") :]) for entry in files}
    return {entry.name: (entry.read_bytes(), kind) for entry in files if (kind := kinds[entry.name]) is not None}


def _door(*, may_be_named: bool) -> Middleware:
    """Refuses what another page sends: a foreign Origin; and, where nobody shows who he is, a Host that is a name, for anybody may point his
    own name here (DNS rebinding)."""

    @web.middleware
    async def at_the_door(request: web.Request, handler: Handler) -> web.StreamResponse:
        if not may_be_named and not is_own_host(request.host):
            raise web.HTTPForbidden(text=f'Host "{request.host}" is not this robot: open the console by its address, or as localhost\n')
        origin = request.headers.get("Origin")
        is_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        if (origin is not None or is_socket) and origin != f"{request.scheme}://{request.host}":
            raise web.HTTPForbidden(text="the Origin is not this console\n")
        return await handler(request)

    return at_the_door


def is_own_host(host: str) -> bool:
    """True for `localhost` and addresses, with or without a port; names of the world can be made to mean any address."""
    name = host[: host.rindex("]") + 1].strip("[]") if host.startswith("[") and "]" in host else host.partition(":")[0]
    if name.lower() == "localhost":
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def known(request: web.Request, access: Access) -> Key | None:
    """Whose token or client certificate the request carries."""
    token = request.headers.get("Authorization", "").removeprefix("Bearer ")
    transport = request.transport
    return access.by_token(token) or (None if transport is None else access.by_certificate(common_name(transport)))


def require_known(request: web.Request, access: Access) -> None:
    """Raises: HTTPUnauthorized if people must show who they are, and this one did not."""
    if access.keys and known(request, access) is None:
        raise web.HTTPUnauthorized(text="expected a token that this gateway knows\n")


async def _dress(request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(HEADERS)
    response.headers.pop("Server", None)


def _file(body: bytes, kind: str) -> Handler:
    async def serve(request: web.Request) -> web.Response:
        return web.Response(body=body, content_type=kind, charset="utf-8")

    return serve
