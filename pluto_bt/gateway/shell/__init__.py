"""The shell: what a person says to a running robot, in words. A client of the gateway and nothing more.

`table.ROWS` is the one table of commands; help, completion, usage errors and the docs come from it. `obey` does one line; `console` asks for
lines at a terminal, `script` takes them from a pipe, and `pluto_bt.gateway.ssh` serves both to who comes by ssh.
"""
