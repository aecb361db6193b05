"""The command line as a process: streams that are closed, full or in an old locale, folders of the user's own, what is imported when."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pluto_bt.commands import extras
from pluto_bt.files import package_root
from pluto_bt.source import Faults

OLD_LOCALE = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


def shell(line: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a line of shell in which `pluto` is ours."""
    places = os.pathsep.join([str(package_root()), os.environ.get("PYTHONPATH", "")])
    function = f'pluto() {{ "{sys.executable}" -m pluto_bt "$@"; }}; '
    return subprocess.run(["bash", "-c", function + line], cwd=folder, env=os.environ | {"PYTHONPATH": places} | environment,
                          capture_output=True, text=True, errors="replace", timeout=60, check=False)  # fmt: skip


def test_output_into_head_ends_quietly(tmp_path: Path) -> None:
    done = shell("pluto nodes | head -1; echo ${PIPESTATUS[0]}", tmp_path)
    assert done.stdout.splitlines()[-1] in ("141", "0"), "0 if all fitted into the pipe before head ended"
    assert done.stderr == ""


@pytest.mark.parametrize("command", ["nodes >&-", "tree patrol.xml >&-", "check patrol.xml 2>&-", ">&-"])
def test_closed_streams_are_no_trouble(command: str, tmp_path: Path) -> None:
    done = shell(f"pluto {command}", tmp_path)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
def test_a_full_disk_is_said_so(tmp_path: Path) -> None:
    done = shell("pluto nodes > /dev/full", tmp_path)
    assert (done.returncode, done.stderr) == (2, "pluto: error: [Errno 28] No space left on device\n")


@pytest.mark.parametrize("command", ["tree patrol.xml", "tree patrol.xml --format unicode", "nodes", "check nosuch.xml"])
def test_an_old_locale_is_no_trouble(command: str, tmp_path: Path) -> None:
    done = shell(f"pluto {command}", tmp_path, **OLD_LOCALE)
    assert (done.returncode, "Traceback" in done.stderr) == (2 if "nosuch" in command else 0, False)
    assert (done.stdout + done.stderr).isascii()


@pytest.mark.parametrize("package", ["sim", "drivers"])
def test_a_users_own_folder_that_hides_a_package_is_named(package: str, tmp_path: Path) -> None:
    (tmp_path / package).mkdir()
    (tmp_path / package / "__init__.py").write_text("")
    done = shell("pluto run t01_say_hello.xml --json", tmp_path)
    assert done.returncode == 2
    (fault,) = json.loads(done.stdout)["faults"]
    assert (fault["code"], fault["found"]) == ("shadowed-package", str(tmp_path / package / "__init__.py"))


def test_help_imports_nothing_heavy_and_a_refusal_no_compiler(tmp_path: Path) -> None:
    script = "import sys; from pluto_bt.cli import main; code = main(sys.argv[1:]); print(code, *sorted(sys.modules), file=sys.stderr)"
    heavy = ("numba", "scipy", "matplotlib", "filterpy")
    for words, code, never in (("--help", "0", ("argparse", "numpy", "msgspec", *heavy)), ("run nosuch.xml", "2", heavy)):
        done = shell(f"{sys.executable} -c '{script}' {words}", tmp_path)
        found = done.stderr.splitlines()[-1].split()
        assert found[0] == code
        assert not set(never) & set(found)


def test_an_option_whose_libraries_are_not_there_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda module: None if module in ("zmq", "asyncssh", "prompt_toolkit") else module)
    faults = Faults()
    assert extras.need("record", "--record run.mcap", faults)
    assert not extras.need("groot", "--groot", faults)
    assert not extras.need("shell", "--ssh", faults)
    said = [(fault.file, fault.code, fault.message, fault.mend) for fault in faults.in_order()]
    assert said == [
        ("--groot", "not-installed", "the library pyzmq is not installed", "pip install 'pluto_bt[groot]'"),
        ("--ssh", "not-installed", "the libraries asyncssh and prompt_toolkit are not installed", "pip install 'pluto_bt[shell]'"),
    ]
