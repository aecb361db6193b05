"""Broken missions: name → (text, the faults as "line:column code")."""

from __future__ import annotations

OK = "<AlwaysSuccess/>"


def tree(body: str, root: str = 'BTCPP_format="4" main_tree_to_execute="A"', more: str = "", tree_id: str = "A") -> str:
    """A mission with one tree, whose body stands in line 3 from column 5 on, and `more` in line 5."""
    return f'<root {root}>\n  <BehaviorTree ID="{tree_id}">\n    {body}\n  </BehaviorTree>\n{more}</root>\n'


def other(body: str = OK) -> str:
    """A second tree."""
    return f'<BehaviorTree ID="B">{body}</BehaviorTree>'


def tens(i: int) -> str:
    """A tree that holds the next one ten times."""
    inside = f"<SubTree ID='T{i + 1}'/>" * 10
    return f'<BehaviorTree ID="T{i}"><Sequence>{inside}</Sequence></BehaviorTree>'


BOMB = '<?xml version="1.0"?>\n<!DOCTYPE a [\n<!ENTITY b "b">\n<!ENTITY c "&b;&b;&b;">\n]>\n<root>&c;</root>'

NOT_XML = {
    "empty": ("", "1:1 no-root"),
    "blank": ("  \n", "1:1 no-root"),
    "prose": ("go to the kitchen", "1:1 xml-syntax"),
    "toml": ("a = 3\n", "1:1 xml-syntax"),
    "NUL": (tree('<Say text="a\0b"/>'), "3:17 xml-syntax"),
    "document type": ("<!DOCTYPE root>\n" + tree(OK), "1:1 doctype"),
    "entity bomb": (BOMB, "2:1 doctype"),
    "attribute twice": (tree('<Say text="a" text="b"/>'), "3:19 duplicate-attribute"),
    "never closed": ('<root BTCPP_format="4"><BehaviorTree ID="A">', "1:24 unclosed-tag"),
    "wrong end tag": (tree(f"<Sequence>{OK}</Sequnce>"), "3:31 mismatched-tag"),
    "value without quotes": (tree("<Say text=a/>"), "3:15 missing-quote"),
    "no value": (tree("<Say text/>"), "3:10 xml-syntax"),
    "quote never closed": (tree('<Say text="a/>'), "3:15 missing-quote"),
    "second root": (tree(OK) + "<root/>", "6:1 xml-syntax"),
    "text after": (tree(OK) + "junk", "6:1 xml-syntax"),
    "comment never closed": (tree("<!-- never"), "3:5 unclosed"),
    "too deep": (tree("<Inverter>\n" * 300), "257:1 too-deep"),
    "other root": ("<mission/>", "1:1 bad-root"),
}

TREES = {
    "no tree": ('<root BTCPP_format="4"/>', "1:1 no-tree"),
    "main tree unknown": (tree(OK, 'BTCPP_format="4" main_tree_to_execute="Z"'), "1:46 unknown-tree"),
    "which is the main tree": (tree(OK, 'BTCPP_format="4"', other()), "1:1 no-main-tree"),
    "empty tree": (tree(""), "2:3 child-count"),
    "two children": (tree(OK + OK), "2:3 child-count"),
    "no ID": (f'<root BTCPP_format="4"><BehaviorTree>{OK}</BehaviorTree><TreeNodesModel/></root>', "1:24 missing-id"),
    "empty ID": (tree(OK, 'BTCPP_format="4"', tree_id=""), "2:21 bad-id"),
    "ID Root": (tree(OK, 'BTCPP_format="4"', tree_id="Root"), "2:21 bad-id"),
    "ID of a node": (tree(OK, 'BTCPP_format="4"', tree_id="Sequence"), "2:21 id-is-node"),
    "ID with a slash": (tree(OK, 'BTCPP_format="4"', tree_id="a/b"), "2:21 bad-id"),
    "two models": (tree(OK, more="<TreeNodesModel/><TreeNodesModel/>"), "5:18 second-model"),
    "model without ID": (tree(OK, more="<TreeNodesModel><Action/></TreeNodesModel>"), "5:17 missing-id"),
    "port without name": (tree(OK, more='<TreeNodesModel><Action ID="x"><input_port/></Action></TreeNodesModel>'), "5:32 missing-name"),
    "tree in itself": (tree('<SubTree ID="A"/>'), "3:18 recursion"),
    "circle of trees": (tree('<SubTree ID="B"/>', more=other('<SubTree ID="A"/>')), "5:35 recursion"),
    "unknown tree": (tree('<SubTree ID="B"/>'), "3:18 unknown-tree"),
    "SubTree without ID": (tree("<SubTree/>"), "3:5 missing-id"),
    "SubTree with a child": (tree(f'<SubTree ID="B">{OK}</SubTree>', more=other()), "3:21 child-count"),
    "one path twice": (tree('<Sequence><SubTree ID="B" name="x"/><SubTree ID="B" name="x"/></Sequence>', more=other()), "3:63 duplicate-path"),
    "too many by expansion": (
        tree('<SubTree ID="T0"/>', more="".join(tens(i) for i in range(6)) + f'<BehaviorTree ID="T6">{OK}</BehaviorTree>'),
        "5:1349 too-many-nodes"),
}  # fmt: skip

INCLUDES = {
    "missing": (tree(OK, more='<include path="nope.xml"/>'), "5:16 no-file"),
    "a folder": (tree(OK, more='<include path="."/>'), "5:16 no-file"),
    "no path": (tree(OK, more="<include/>"), "5:1 missing-path"),
    "itself": (tree(OK, more='<include path="m.xml"/>'), "5:16 include-cycle"),
    "ROS package": (tree(OK, more='<include ros_pkg="p" path="a.xml"/>'), "5:10 ros-package"),
    "a name too long": (tree(OK, more=f'<include path="{"a" * 5000}"/>'), "5:16 no-file"),
    "empty path": (tree(OK, more='<include path=""/>'), "5:16 no-file"),
}

NODES = {
    "unknown node": (tree("<Foo/>"), "3:5 unknown-node"),
    "wrong case": (tree('<sleep msec="1"/>'), "3:5 unknown-node"),
    "unknown explicit node": (tree('<Action ID="Foo"/>'), "3:17 unknown-node"),
    "explicit without ID": (tree('<Action msec="10"/>'), "3:5 missing-id"),
    "compact with ID": (tree('<Sleep ID="x" msec="10"/>'), "3:12 id-in-compact-form"),
    "explicit in ReactiveSequence": (tree('<ReactiveSequence><Action ID="AlwaysSuccess"/></ReactiveSequence>'), "3:23 explicit-form"),
    "unknown port": (tree('<Sleep msec="1" msecs="1"/>'), "3:21 unknown-port"),
    "missing port": (tree("<GoTo/>"), "3:5 missing-port"),
    "decorator alone": (tree("<Inverter/>"), "3:5 child-count"),
    "decorator of two": (tree(f"<Inverter>{OK}{OK}</Inverter>"), "3:5 child-count"),
    "empty Sequence": (tree("<Sequence/>"), "3:5 child-count"),
    "leaf with a child": (tree(f"<AlwaysSuccess>{OK}</AlwaysSuccess>"), "3:20 child-count"),
    "TryCatch of one": (tree(f"<TryCatch>{OK}</TryCatch>"), "3:5 child-count"),
    "Switch2 of one": (tree(f'<Switch2 variable="x" case_1="1" case_2="2">{OK}</Switch2>'), "3:5 child-count"),
    "IfThenElse of one": (tree(f"<IfThenElse>{OK}</IfThenElse>"), "3:5 child-count"),
    "threshold too high": (tree(f'<Parallel success_count="5">{OK}</Parallel>'), "3:30 threshold"),
    "SubTree input missing": (
        tree('<SubTree ID="B"/>', more=other() + '<TreeNodesModel><SubTree ID="B"><input_port name="g"/></SubTree></TreeNodesModel>'),
        "3:5 missing-port"),
    "two types on one key": (
        tree(f'<Sequence><Script code="x:=1"/><Repeat num_cycles="{{x}}"><RunOnce then_skip="{{x}}">{OK}</RunOnce></Repeat></Sequence>'),
        "3:81 type-clash"),
    "two @": (tree('<Sleep msec="{@b@c}"/>'), "3:18 bad-key"),
}  # fmt: skip

VALUES = {
    "leading blank": (tree('<Sleep msec=" 10"/>'), "3:18 bad-literal"),
    "plus sign": (tree('<Sleep msec="+10"/>'), "3:18 bad-literal"),
    "negative": (tree('<Sleep msec="-10"/>'), "3:18 bad-literal"),
    "word": (tree('<Sleep msec="abc"/>'), "3:18 bad-literal"),
    "nothing": (tree('<Sleep msec=""/>'), "3:18 bad-literal"),
    "beyond int": (tree(f'<Repeat num_cycles="99999999999999">{OK}</Repeat>'), "3:25 bad-literal"),
    "bool": (tree(f'<RunOnce then_skip="yes">{OK}</RunOnce>'), "3:25 bad-literal"),
    "status": (tree(f'<Precondition if="true" else="foo">{OK}</Precondition>'), "3:35 bad-literal"),
    "hole in a list": (tree(f'<LoopInt queue="1;;2" value="{{v}}">{OK}</LoopInt>'), "3:21 bad-literal"),
    "no point": (tree('<GoTo goal="1;x"/>'), "3:17 bad-literal"),
    "NaN in a point": (tree('<GoTo goal="nan;1"/>'), "3:17 bad-literal"),
    "endless goal": (tree('<GoTo goal="inf;2"/>'), "3:17 out-of-range"),
    "goal beyond a double": (tree('<GoTo goal="1e400;2"/>'), "3:17 bad-literal"),
    "endless speed": (tree('<DriveVelocity speed_mps="1e999" turn_rate_dps="0"/>'), "3:31 bad-literal"),
    "tolerance below 0": (tree('<GoTo goal="1;2" tolerance_m="-1"/>'), "3:35 out-of-range"),
    "unknown word": (tree('<GoTo goal="1;2" avoid="sonr"/>'), "3:29 out-of-range"),
    "NaN": (tree('<MakeTurn angle_deg="nan"/>'), "3:26 bad-literal"),
    "megabytes": (tree(f'<GoTo goal="{"1;" * 100_000}"/>'), "3:17 too-long"),
}

SCRIPTS = {
    "blank": (tree('<Script code=" "/>'), "3:19 script-syntax"),
    "no operand": (tree('<Script code="a := "/>'), "3:24 script-syntax"),
    "no number": (tree('<Script code="1."/>'), "3:19 script-syntax"),
    "open text": (tree("<Script code=\"a := 'x\"/>"), "3:24 script-syntax"),
    "condition": (tree('<AlwaysSuccess _skipIf="a &lt;"/>'), "3:35 script-syntax"),
    "second line": (tree('<Script code="a := 1;\n  b := )"/>'), "4:8 script-syntax"),
    "brackets": (tree(f'<Script code="{"(" * 3000}1{")" * 3000}"/>'), "3:70 script-syntax"),
    "signs": (tree(f'<Script code="{"-" * 50_000}1"/>'), "3:70 script-syntax"),
}

COLUMNS = {
    "line ends of Windows": (tree('<Say text="x"/><Foo/>').replace("\n", "\r\n"), "2:3 child-count 3:20 unknown-node"),
    "tabs count as one": (tree("\t\t<Foo/>"), "3:7 unknown-node"),
    "umlauts count as one": (tree('<Sequence name="Küche"><Foo/></Sequence>'), "3:28 unknown-node"),
    "byte-order mark": ("\ufeff" + tree("<Foo/>"), "3:5 unknown-node"),
    "attribute on a later line": (tree('<Sleep\n      msec="x"/>'), "4:13 bad-literal"),
    "all at once": (tree('<Sequence><Foo/><Sleep msec="x"/>\n<GoTo gaol="1;2" goal="1"/></Sequence>'),
                    "3:15 unknown-node 3:34 bad-literal 4:7 unknown-port 4:24 bad-literal"),
}  # fmt: skip

MISSIONS = {f"{group}: {name}": case for group, cases in (
    ("xml", NOT_XML), ("trees", TREES), ("include", INCLUDES), ("nodes", NODES), ("values", VALUES), ("scripts", SCRIPTS), ("columns", COLUMNS),
) for name, case in cases.items()}  # fmt: skip

SOUND = {
    "raw && and <": tree('<Script code="a := 1 && 2 < 3"/>'),
    "raw entity": tree('<Say text="salt &amp; pepper & vinegar &foo;"/>'),
    "UTF-16": tree('<Say text="Küche"/>').encode("utf-16"),
    "line ends of Windows": tree(OK).replace("\n", "\r\n"),
    "byte-order mark": "\ufeff" + tree(OK),
    "comments everywhere": "<!-- a -->\n" + tree(f"<!-- b -->{OK}<!-- c -->") + "<!-- d -->",
    "unknown condition is ignored": tree('<AlwaysSuccess _skipif="x"/>'),
}
