"""Where files are looked for: as given, then among the shipped missions and worlds by name."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path

from pluto_bt.source import Faults, Place, nearest_word

SHIPPED = {"mission": ("missions", (".xml",)), "world": ("sim/worlds", (".xml", ".yaml", ".map"))}


def package_root() -> Path:
    """The folder that holds pluto_bt, sim, drivers, estimation and missions side by side."""
    return Path(__file__).resolve().parents[1]


def find_file(kind: str, name: str, faults: Faults, beside: Path | None = None) -> Path | None:
    """The path of a mission or world, or None with a fault that names the near misses. `beside`: a folder that is tried too."""
    candidates = [Path(name)] + ([beside / name] if beside is not None else [])
    folder, endings = SHIPPED[kind]
    shipped = package_root() / folder
    bare = name.removeprefix(f"{folder}/")
    if "/" not in bare:
        candidates += [shipped / bare] + [shipped / f"{bare}{ending}" for ending in endings]
    for candidate in candidates:
        if os.path.isfile(candidate):  # unlike Path.is_file, False for whatever cannot be a name
            return candidate
    found = "a folder" if os.path.isdir(name) else "no ordinary file" if os.path.lexists(name) else name or "nothing"
    other = next((word for word in SHIPPED if word != kind and Path(name).name in shipped_names(word)), "")
    found = f"a shipped {other}" if other and not os.path.lexists(name) else found
    known = shipped_names(kind)
    faults.error(Place(name or f'{kind} ""'), "no-such-file", f"no such {kind} file", expected=f"a path, or a shipped {kind}: {', '.join(known)}",
                 found=found, mend=nearest_file(name, known))  # fmt: skip
    return None


def nearest_file(name: str, known: list[str]) -> str:
    """'did you mean "yard.xml"?', by the names without their endings, which would make every file a little like every other."""
    stems = {Path(one).stem: one for one in reversed(known)}
    near = nearest_word(Path(name).stem, stems)
    return f'did you mean "{stems[near]}"?' if near else ""


def find_shipped(name: str) -> Path | None:
    """A shipped mission or world of that name, with or without its ending; None if there is none."""
    found = (find_file(kind, name, Faults()) for kind in SHIPPED)
    return next((path for path in found if path is not None), None)


def shipped_names(*kinds: str) -> list[str]:
    """The names of all shipped files of some kinds (of every kind, if none is given), in order."""
    rows = [SHIPPED[kind] for kind in kinds or SHIPPED]
    return [name for folder, endings in rows for name in sorted(path.name for path in (package_root() / folder).iterdir() if path.suffix in endings)]


def refuse_shadowed_packages() -> None:
    """Raises InputError if a user's own folder `sim`, `drivers`, … hides the one that belongs to pluto_bt."""
    faults = Faults()
    for package in ("sim", "drivers", "estimation", "missions"):
        spec = find_spec(package)
        where = Path(spec.origin).resolve().parents[1] if spec is not None and spec.origin else None
        if where != package_root():
            found = "nothing" if spec is None else str(spec.origin or ", ".join(spec.submodule_search_locations or ()))
            what, mend = f'the package "{package}" of pluto_bt is hidden', "start pluto from another folder, or rename that one"
            faults.error(Place("pluto"), "shadowed-package", what, expected=str(package_root() / package), found=found, mend=mend)
    faults.raise_errors()
