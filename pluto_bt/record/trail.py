"""Since when things are as they are, and what was wrong a moment ago: what `why` needs besides the situation itself."""

from __future__ import annotations

from dataclasses import dataclass, field

from pluto_bt.record.entries import Link, Situation

NO_TROUBLE = ("stopped", "stuck", "marker-stale")  # the last is a warning: the car drives on
BEGIN_NS = 1_000_000_000  # who complains while the first readings come, and no longer, has had no trouble
AGAIN_NS = 3_000_000_000  # the same complaint so soon again is the same trouble: what tries again every second goes quiet meanwhile


@dataclass(frozen=True)
class Trouble:
    """What a link complained of: since when, and until when (None = still)."""

    link: Link
    since_ns: int
    until_ns: int | None = None


@dataclass
class Trail:
    """The situation with its past.

    Attributes:
        since_ns: `link/drive`, `stale/sick/scan`, `module/avoid`, `hold`, `mission`, `moves`, `ended` -> when it became as it is.
        troubles: motion, avoidance, drive, filter, localisation -> its last complaint; a stop is none, and that goto is stuck comes of one.
    """

    situation: Situation = field(default_factory=Situation)
    since_ns: dict[str, int] = field(default_factory=dict)
    troubles: dict[str, Trouble] = field(default_factory=dict)

    def take(self, new: Situation, t_ns: int) -> None:
        """It is `new` from `t_ns` on."""
        old, self.situation = self.situation, new
        if new is old or new == old:
            return
        for kind, before, after in (("link", old.links, new.links), ("stale", old.stale, new.stale), ("module", old.modules, new.modules)):
            for name in {**before, **after}:
                if (name in before) != (name in after) or (kind != "stale" and _said(before.get(name)) != _said(after.get(name))):
                    self.since_ns[f"{kind}/{name}"] = t_ns
        for name in ("hold", "mission", "moves", "ended"):
            if getattr(old, name) != getattr(new, name):
                self.since_ns[name] = t_ns
        for name, link in new.links.items():
            self._note(name, link, t_ns)

    def _note(self, name: str, link: Link, t_ns: int) -> None:
        last = self.troubles.get(name)
        is_trouble = bool(link.reason) and link.reason not in NO_TROUBLE
        if last is not None and last.until_ns is None:
            if is_trouble and link.reason == last.link.reason:
                return
            last = Trouble(last.link, last.since_ns, t_ns) if t_ns > BEGIN_NS else None
        if is_trouble:
            is_again = last is not None and last.link.reason == link.reason and t_ns - (last.until_ns or 0) <= AGAIN_NS
            last = Trouble(link, last.since_ns if last is not None and is_again else t_ns)
        if last is None:
            self.troubles.pop(name, None)
        else:
            self.troubles[name] = last


def _said(value: object) -> object:
    """What counts as a change: the words, not the figures in the text."""
    return (value.element, value.reason) if isinstance(value, Link) else value
