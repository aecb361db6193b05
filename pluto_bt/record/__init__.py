"""The black box of a run as a file: what stands in it, how it is written and read. MCAP with JSON messages, so Foxglove and every MCAP tool opens it.

Knows the blackboard's messages, but nothing of trees or robots; `pluto_bt.modules.recorder` fills it, `pluto_bt.replay` plays it.
"""
