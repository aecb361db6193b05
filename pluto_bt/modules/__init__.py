"""Adapters, one a file: each joins a driver, a skill or an estimator to its topics and inboxes. `pluto_bt.system.MODULES` lists them."""
