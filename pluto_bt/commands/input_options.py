"""The options that say what is run where."""

from __future__ import annotations

import argparse
from dataclasses import fields

from pluto_bt.inputs.reading import DEFAULT_PLATFORM, DEFAULT_WORLD, Request


def add_input_options(parser: argparse.ArgumentParser) -> None:
    """Mission, world, map, start, platform and what goes with them."""
    parser.add_argument("mission", metavar="MISSION.xml", help="a mission file, or the name of a shipped one")
    parser.add_argument("--world", metavar="W", help=f"world: our XML, a ROS map.yaml or an ARNL .map (default {DEFAULT_WORLD})")
    parser.add_argument("--map", metavar="M", help="a-priori map for localisation and planning (default: the world's own)")
    parser.add_argument("--start", metavar="X,Y,DEG", help="start pose (default: the world's)")
    parser.add_argument("--platform", metavar="P", help=f"atrv2, car, jbot, pioneer or a .toml file (default: the world's, else {DEFAULT_PLATFORM})")
    parser.add_argument("--tree", metavar="ID", help="the tree to run, if not the main one")
    parser.add_argument("--port", metavar="NAME=VALUE", action="append", default=[], help="an input of the main tree; may be repeated")
    parser.add_argument("--seed", metavar="N", help="seed of all randomness (default: the world's, else 0)")
    parser.add_argument("--set", metavar="PARAM=VALUE", action="append", default=[], help="a parameter of the platform file; may be repeated")
    parser.add_argument("--params", metavar="FILE.toml", help='parameters laid over the platform file; <params op="save"/> writes it')
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used; may be repeated")


def request_of(args: argparse.Namespace) -> Request:
    """The request that a parsed command line makes."""
    return Request(**{field.name: getattr(args, field.name) for field in fields(Request)})
