"""The web console: one page of plain HTML, CSS and ES modules, and what serves it. aiohttp is imported in here and nowhere else.

```
 browser ⇄ WebClient ⇄ Session ⇄ Hub      live: the protocol itself in text messages of a WebSocket, limits and all
 browser ⇄ moments                         a black box: the page asks what was true at a time
```
`house.py` keeps the door for both: files, security headers, Host and Origin. The page begins at `static/main.js`.
"""
