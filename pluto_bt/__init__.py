"""pluto_bt: a behaviour-tree mission executive for wheeled robots."""

__version__ = "0.1.0"
