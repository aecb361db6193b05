"""The robot's door: the TCP/XML protocol, its server in a process of its own, the client and the shell.

```
 clients ⇄ Framer ⇄ Connection ⇄ Session ⇄ Hub      the gateway process: bytes, XML, subscriptions, slow readers
 clients ◄ Burst ◄ Outlets ◄ Lane ◄ Channels ◄ Hub      values that are the same for all, past all queues
                                           ⇅ wire    one Unix socket, msgpack frames, latest values only
                              GatewayLink ⇄ Desk ⇄ RobotPort      the executive's process: lease, runs, outcomes, stop
```
On the other side of the line `Client` and `AsyncClient` are shells around `Dialogue`, and `proxies` stand on `Client`.

Start reading at `Session.receive` (what a client's bytes lead to) and `Desk.step` (what the executive makes of it). Nothing is
imported here, so that the shell and `pluto --help` start at once.
"""
