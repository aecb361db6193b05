"""The `<script>` of a world: what happens at a time, or when the robot enters a place."""

from __future__ import annotations

from pluto_bt.maps import fault_table
from pluto_bt.maps.fields import Fields
from pluto_bt.maps.script import Action, At, Carry, FaultAction, Put, Remove, SetTopic, When
from pluto_bt.maps.world_ids import Ids
from pluto_bt.source import Faults, XmlElement, did_you_mean

MAX_TIME_S = 1e9
ACTIONS = ("remove", "place", "fault", "set")


def read_script(element: XmlElement, ids: Ids, faults: Faults, enough_faults: int) -> list[At | When]:
    """The entries of one `<script>`; every id in it must be known to `ids` by now. Ends once there are `enough_faults`."""
    fields = Fields(element, faults)
    entries: list[At | When] = []
    for child in element.children:
        if len(faults) >= enough_faults:
            break
        entry = Fields(child, faults)
        if child.tag == "at":
            t_s = entry.number("t", None, 0.0, MAX_TIME_S)
            entries.append(At(t_s, _actions(entry, ids, faults), child.place))
        elif child.tag == "when":
            inside = entry.text("inside")
            if inside:
                ids.check(("region",), inside, child.attributes["inside"].value_place, "area or terrain")
            entries.append(When(inside, entry.flag("once"), _actions(entry, ids, faults), child.place))
        else:
            continue
        entry.done(ACTIONS)
    fields.done(("at", "when"))
    return entries


def _actions(entry: Fields, ids: Ids, faults: Faults) -> tuple[Action, ...]:
    if not entry.element.children:
        what = f"<{entry.element.tag}> does nothing"
        entry.fault(entry.place, "no-action", what, expected=f"one of: {', '.join(f'<{tag}>' for tag in ACTIONS)}", found="nothing inside")
    actions: list[Action] = []
    for child in entry.element.children:
        fields = Fields(child, faults)
        if child.tag == "remove":
            actions.append(Remove(_target(fields, ids), child.place))
        elif child.tag == "place":
            actions.append(_put(fields, ids))
        elif child.tag == "fault":
            actions.append(_fault(fields))
        elif child.tag == "set":
            actions.append(SetTopic(fields.text("topic"), fields.text("value"), child.place))
        else:
            continue
        fields.done()
    return tuple(actions)


def _target(fields: Fields, ids: Ids) -> str:
    name = fields.text("id")
    if name:
        ids.check(("obstacle",), name, fields.element.attributes["id"].value_place, "wall, shape or actor")
    return name


def _put(fields: Fields, ids: Ids) -> Put | Carry:
    if ids.is_robot(fields.text("id")):
        return Carry(fields.number("x"), fields.number("y"), fields.angle_rad("theta_deg") if fields.has("theta_deg") else None, fields.place)
    name = _target(fields, ids)
    if fields.has("x") or fields.has("y"):
        return Put(name, fields.number("x"), fields.number("y"), fields.place)
    return Put(name, None, None, fields.place)


def _fault(fields: Fields) -> FaultAction:
    device, kind = fields.text("device"), fields.text("kind")
    for_s = fields.number("for", 0.0, 0.0, MAX_TIME_S)
    row = _row(fields, device, kind)
    if row is None:
        for name in fault_table.ATTRIBUTES:
            fields.has(name)  # nothing can be said of them
        return FaultAction(device, kind, for_s, place=fields.place)
    for name in fault_table.ATTRIBUTES:
        if name in row.needs and not fields.has(name):
            fields.text(name)
        elif name not in (*row.needs, *row.takes) and fields.has(name):
            can = ", ".join(("for", *row.needs, *row.takes))
            what = f'fault "{kind}" of {device} has no attribute "{name}"'
            fields.fault(fields.element.attributes[name].place, "unknown-attribute", what, expected=f"one of: {can}", found=name)
    rate_high = 1.0 if kind == "drop" else 1e6
    return FaultAction(
        device, kind, for_s, place=fields.place,
        value=_value(fields, kind) if fields.has("value") else None,
        rate=fields.number("rate", None, 0.0, rate_high, above=kind == "slow") if fields.has("rate") else None,
        delay_s=fields.number("delay", None, 0.0, MAX_TIME_S) if fields.has("delay") else None,
        beams=_beams(fields) if fields.has("beams") else None,
    )  # fmt: skip


def _value(fields: Fields, kind: str) -> float:
    if kind == "slip":
        return fields.number("value", None, 0.0, 1.0)
    return fields.number("value", None, 0.0) if kind == "noise" else fields.number("value")


def _row(fields: Fields, device: str, kind: str) -> fault_table.FaultRow | None:
    """The row of the table, or None and a fault if the device or the kind is unknown or they do not go together."""
    if not device or not kind:
        return None
    attributes = fields.element.attributes
    base, colon, name = device.partition(":")
    written = [f"{known}:NAME" if known in fault_table.NAMED else known for known in fault_table.DEVICES]
    if base not in fault_table.DEVICES or (base in fault_table.NAMED) != bool(colon and name):
        expected = f"one of: {', '.join(written)}"
        mend = did_you_mean(base, fault_table.DEVICES) if base not in fault_table.DEVICES else "write module:NAME or leaf:NAME"
        fields.fault(attributes["device"].value_place, "unknown-device", f'unknown device "{device}"', expected=expected, found=device, mend=mend)
        return None
    row = fault_table.ROWS.get((base, kind))
    if row is None:
        kinds = fault_table.kinds_of(base)
        what = f'a fault "{kind}" makes no sense for {device}' if kind in fault_table.KINDS else f'unknown kind of fault "{kind}"'
        mend = did_you_mean(kind, kinds)
        fields.fault(attributes["kind"].value_place, "unknown-fault-kind", what, expected=f"one of: {', '.join(kinds)}", found=kind, mend=mend)
    return row


def _beams(fields: Fields) -> tuple[int, int] | None:
    """`first-last` or one number, counted from 0."""
    text = fields.text("beams")
    first, dash, last = text.partition("-")
    numbers = [first.strip(), (last if dash else first).strip()]
    if all(number.isascii() and number.isdigit() and len(number) <= 5 for number in numbers) and int(numbers[0]) <= int(numbers[1]):
        return int(numbers[0]), int(numbers[1])
    if text:
        place = fields.element.attributes["beams"].value_place
        fields.fault(place, "bad-value", "these are no beams", expected="first-last, counted from 0, for example 0-180", found=text)
    return None
