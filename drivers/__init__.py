"""Devices: the records they deliver, their codecs and their drivers. Knows nothing of the rest of the project."""
