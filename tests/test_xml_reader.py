"""The position-keeping XML reader: what it accepts, where it says things are, how it explains what it refuses."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.source import Fault, Faults, Place
from pluto_bt.source.xml_reader import XmlElement, read_xml, read_xml_file


def good(text: str) -> XmlElement:
    faults = Faults()
    root = read_xml(text, "m.xml", faults)
    assert root is not None, [fault.as_text() for fault in faults.in_order()]
    assert not faults
    return root


def faults_of(text: str, **limits: int) -> tuple[Fault, ...]:
    faults = Faults()
    read_xml(text, "m.xml", faults, **limits)
    return faults.in_order()


def spot(place: Place) -> tuple[int, int]:
    return place.line, place.column


# --- what is read ---


def test_elements_attributes_and_places() -> None:
    root = good('<?xml version="1.0"?>\n<root a="1">\n\t<GoTo  name="to the gate"\n     goal = \'4;2\'/>\n</root>\n')
    goto = root.children[0]
    assert (root.tag, goto.tag, goto.parent) == ("root", "GoTo", root)
    assert (root.get("a"), goto.get("goal"), goto.get("absent", "x")) == ("1", "4;2", "x")
    assert spot(root.place) == (2, 1)
    assert spot(goto.place) == (3, 2)
    assert goto.attributes["name"].place == Place("m.xml", 3, 9, '\t<GoTo  name="to the gate"')
    assert spot(goto.attributes["goal"].place) == (4, 6)
    assert spot(goto.attributes["goal"].value_place) == (4, 14)


@pytest.mark.parametrize(
    ("value", "read"),
    [
        ("a<b && c>2 & d", "a<b && c>2 & d"),
        ("&lt;&gt;&amp;&quot;&apos;", "<>&\"'"),
        ("&#65;&#x42;&#x1F600;", "AB\U0001f600"),
        ("&foo; &amp", "&foo; &amp"),
        ("&#0;&#xD800;&#1114112;&#xZZ;&#99999999999;", "&#0;&#xD800;&#1114112;&#xZZ;&#99999999999;"),
        ("one\n\ttwo\r\nthree\rfour", "one\n\ttwo\nthree\nfour"),
        ("Straße 'π'", "Straße 'π'"),
        ("", ""),
    ],
)
def test_attribute_values_are_read_as_tinyxml2_does(value: str, read: str) -> None:
    assert good(f'<a v="{value}"/>').get("v") == read


def test_text_of_an_element_is_joined_and_every_character_keeps_its_place() -> None:
    root = good("<wall>\n 0,0 <!-- not\nme --> 1,&#49; <x>inner</x><![CDATA[<2,2>]]></wall>")
    assert root.text == "\n 0,0  1,1 <2,2>"
    assert spot(root.text_place) == (2, 2)
    assert spot(root.place_at(root.text.index("1,1") + 2)) == (3, 10)
    assert spot(root.place_at(root.text.index("<2,2>"))) == (3, 37)
    assert good("<a>  </a>").text_place == good("<a>  </a>").place


def test_comments_are_kept_with_their_position_among_the_children() -> None:
    root = good("<!-- head --><a><b/><!-- between --><c/></a><!-- foot -->")
    assert [(comment.text, comment.child_index, comment.place.column) for comment in root.comments] == [(" between ", 1, 21)]


def test_columns_count_characters_whatever_the_line_ends() -> None:
    for end in ("\n", "\r\n", "\r"):
        root = good(f"<ä>{end}\U0001f600 <b c='1'/>{end}</ä>")
        assert spot(root.children[0].attributes["c"].place) == (2, 6)


@pytest.mark.parametrize("text", ['\ufeff<a b="1"c="2"/>', "<a><?what ever?></a >", "<a:b.c-d _e=''></a:b.c-d>", "\n\n<!-- x --><a/>\n"])
def test_other_lenient_things(text: str) -> None:
    good(text)


# --- what is refused ---

FAULTS = [
    ("", 1, 1, "no-root", "the file is empty"),
    ("  \n<!-- nothing -->", 1, 1, "no-root", "there is no root element"),
    ("<a>\n <b>\n</a>", 3, 1, "mismatched-tag", "</a> does not close <b>, which was opened in line 2, column 2"),
    ("<Sequence>\n</Sequense>", 2, 1, "mismatched-tag", "</Sequense> does not close <Sequence>, which was opened in line 1, column 1"),
    ("<a>\n <b>", 2, 2, "unclosed-tag", "<b> is never closed"),
    ("</a>", 1, 1, "mismatched-tag", "</a> closes nothing"),
    ("<a></a", 1, 4, "xml-syntax", "this end tag is not complete"),
    ("<a>\n<b c='1' d='2'\n c='3'/></a>", 3, 2, "duplicate-attribute", 'attribute "c" stands twice in <b>'),
    ("<a b=1/>", 1, 6, "missing-quote", 'the value of attribute "b" has no quotes'),
    ('<a b="1/>', 1, 6, "missing-quote", 'the value of attribute "b" is never closed'),
    ('<a b="1 c="2"/>', 1, 12, "xml-syntax", "this is no attribute of <a>"),
    ("<a b/>", 1, 4, "xml-syntax", 'attribute "b" has no value'),
    ("<a b='1'", 1, 1, "unclosed-tag", "the tag <a has no >"),
    ("<a>\n<b <c/></a>", 2, 1, "unclosed-tag", "the tag <b has no >"),
    ("<a>1 < 2</a>", 1, 6, "xml-syntax", "no tag begins here"),
    ("<a/><b/>", 1, 5, "xml-syntax", "a second root element <b>"),
    ("<a/> junk", 1, 6, "xml-syntax", "text after the root element"),
    ("junk\n<a/>", 1, 1, "xml-syntax", "text before the root element"),
    ("<a/><![CDATA[junk]]>", 1, 14, "xml-syntax", "text after the root element"),
    ("<a><!-- </a>", 1, 4, "unclosed", "a comment is never closed"),
    ("<a><![CDATA[ </a>", 1, 4, "unclosed", "a CDATA section is never closed"),
    ("<?xml <a/>", 1, 1, "unclosed", "a processing instruction is never closed"),
    ('<!DOCTYPE r [<!ENTITY l "lol">]>\n<r>&l;</r>', 1, 1, "doctype", "document types and entity declarations are refused"),
    ("<a/>\n\0", 2, 1, "xml-syntax", "this is not a text file"),
]


@pytest.mark.parametrize(("text", "line", "column", "code", "message"), FAULTS)
def test_each_fault_is_told_with_its_place(text: str, line: int, column: int, code: str, message: str) -> None:
    (fault,) = faults_of(text)
    assert (fault.line, fault.column, fault.code, fault.message) == (line, column, code, message)
    assert fault.expected and fault.found


def test_a_report_in_full() -> None:
    (fault,) = faults_of('<root>\n  <GoTo name="gate goal="4;2"/>\n</root>')
    assert fault.as_text() == (
        "m.xml:2:26: error: this is no attribute of <GoTo>\n"
        '        <GoTo name="gate goal="4;2"/>\n'
        "                               ^\n"
        '      expected  an attribute name="value", > or />\n'
        '      found     4;2"/\n'
        '      mend      is the closing quote of attribute "name" in line 2 missing?'
    )


def test_mends() -> None:
    assert faults_of("<Sequence></Sequense>")[0].mend == 'did you mean "Sequence"?'
    assert faults_of("<a><b></a>")[0].mend == "close <b> of line 1, column 4 first, or write it as <b …/>"


def test_reading_goes_on_after_a_duplicate_attribute() -> None:
    assert [fault.code for fault in faults_of("<a b='' b=''>\n<c d='' d=''/>\n</x>")] == ["duplicate-attribute"] * 2 + ["mismatched-tag"]


def test_limits_end_the_reading_with_one_fault() -> None:
    assert [fault.code for fault in faults_of("<a>" + "<b/>" * 100, max_elements=50)] == ["too-many-nodes"]
    assert [fault.code for fault in faults_of("<a>" * 257)] == ["too-deep"]
    assert good("<a>" * 256 + "</a>" * 256).tag == "a"
    assert [fault.code for fault in faults_of("<a>" + "<!---->" * 100, max_elements=9)] == ["too-many-nodes"]
    assert [fault.code for fault in faults_of("<a/>", max_bytes=3)] == ["too-large"]


HOSTILE = {
    "spaces in a tag": "<a " + " " * (1 << 20),
    "one long name": "<" + "a" * (1 << 20),
    "one long attribute name": "<a " + "b" * (1 << 20),
    "ampersands": "<a>" + "&" * (1 << 20),
    "half entities": '<a b="' + "&#1" * (1 << 18) + '">',
    "entities": "<a>" + "&lt;" * (1 << 16),
    "open brackets": "<" * (1 << 20),
    "unclosed comments": "<a>" + "<!--" * (1 << 18),
    "comments": "<a>" + "<!---->" * (1 << 16),
    "attributes": "<a " + "".join(f"b{i}='' " for i in range(30_000)),
    "deep": "<a>" * (1 << 16),
    "lines": "\n" * (1 << 20) + "<a><b></a>",
    "text runs": "<a>" + "x<b>y</b>" * 3_000,
    "declarations": "<a>" + "<?x?>" * (1 << 16),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_texts_end_in_one_short_fault(name: str) -> None:
    (fault,) = faults_of(HOSTILE[name], max_elements=2000)
    assert len(fault.as_text()) < 3000


# --- properties ---

NAMES = st.from_regex(r"[A-Za-z_][A-Za-z0-9_.:\-]{0,8}", fullmatch=True)
TEXTS = st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\0\r"), max_size=20)
TREES = st.recursive(
    st.tuples(NAMES, st.dictionaries(NAMES, TEXTS, max_size=3), st.just([])),
    lambda below: st.tuples(NAMES, st.dictionaries(NAMES, TEXTS, max_size=3), st.lists(below, max_size=3)),
    max_leaves=8,
)


def written(tree: tuple[str, dict[str, str], list[object]], text: str) -> str:
    tag, attributes, children = tree
    inside = "".join(written(child, text) for child in children)  # type: ignore[arg-type]
    head = "".join(f" {name}={quoteattr(value, {chr(10): chr(10)})}" for name, value in attributes.items())
    return f"<{tag}{head}>{escape(text)}{inside}</{tag}>"


def plain(element: XmlElement) -> tuple[str, dict[str, str], list[object]]:
    return element.tag, {name: attribute.value for name, attribute in element.attributes.items()}, [plain(child) for child in element.children]


@settings(deadline=None)
@given(TREES, TEXTS)
def test_what_is_written_is_read_back_and_stands_where_its_place_says(tree: tuple[str, dict[str, str], list[object]], text: str) -> None:
    source = written(tree, text)
    root = good(source)
    assert plain(root) == tree
    assert root.text == text
    todo = [root]
    while todo:
        element = todo.pop()
        todo += element.children
        assert element.source.text.startswith("<" + element.tag, element.start)
        assert element.place.text[element.place.column - 1 :].startswith("<" + element.tag)
        for attribute in element.attributes.values():
            assert attribute.place.text[attribute.place.column - 1 :].startswith(attribute.name + "=")


@settings(deadline=None)
@given(st.text(alphabet="<>/='\"&;!-[]? ab\n\0CDAT#x1", max_size=60))
def test_any_text_gives_a_tree_or_a_fault(text: str) -> None:
    faults = Faults()
    root = read_xml(text, "", faults)
    assert root is not None or faults.has_errors


# --- files ---


def read_bytes_of(path: Path, data: bytes) -> tuple[XmlElement | None, Faults]:
    path.write_bytes(data)
    faults = Faults()
    return read_xml_file(path, "shown.xml", faults), faults


@pytest.mark.parametrize(
    "data",
    [
        "<a b='ü'/>".encode(),
        b"\xef\xbb\xbf<a b='\xc3\xbc'/>",
        b"<?xml version='1.0' encoding='ISO-8859-1'?><a b='\xfc'/>",
        b"<?xml version='1.0' encoding=\"latin-1\"?><a b='\xfc'/>",
        "<?xml version='1.0' encoding='utf-16'?><a b='ü'/>".encode("utf-16"),
        b"\xfe\xff" + "<a b='ü'/>".encode("utf-16-be"),
    ],
)
def test_encodings(tmp_path: Path, data: bytes) -> None:
    root, faults = read_bytes_of(tmp_path / "a.xml", data)
    assert root is not None and root.get("b") == "ü" and not faults


@pytest.mark.parametrize(
    ("data", "line", "column", "message"),
    [
        (b"<a>\r\n\xc3\xbc\xfc</a>", 2, 2, "the file is not utf-8 text"),
        (b"<?xml version='1.0' encoding='klingon'?><a/>", 1, 1, "unknown encoding"),
        (b"<?xml version='1.0' encoding='zip'?><a/>", 1, 1, "unknown encoding"),
        (b"<?xml version='1.0' encoding='ascii'?>\n<a b='\xfc'/>", 2, 7, "the file is not ascii text"),
        (b"\xff\xfe<\x00a", 1, 2, "the file is not utf-16-le text"),
    ],
)
def test_bytes_that_are_no_text(tmp_path: Path, data: bytes, line: int, column: int, message: str) -> None:
    root, faults = read_bytes_of(tmp_path / "a.xml", data)
    (fault,) = faults.in_order()
    assert root is None
    assert (fault.file, fault.line, fault.column, fault.message) == ("shown.xml", line, column, message)


@settings(deadline=None)
@given(st.binary(max_size=200))
def test_random_bytes_are_a_fault_or_a_tree(data: bytes) -> None:
    from pluto_bt.source.text import decode

    faults = Faults()
    text = decode(data, "x", faults)
    assert (text is None) == faults.has_errors
    if text is not None:
        read_xml(text, "x", faults)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "patrol.xml").write_text("<a/>")
    (tmp_path / "big.xml").write_bytes(b" " * 101)
    faults = Faults()
    for name in ("patrl.xml", "", "big.xml", "a\0b"):
        assert read_xml_file(tmp_path / name, name or "folder", faults, max_bytes=100) is None
    found = {fault.file: (fault.code, fault.message, fault.mend) for fault in faults.in_order()}
    assert found["patrl.xml"] == ("no-file", 'there is no file "patrl.xml"', 'did you mean "patrol.xml"?')
    assert found["folder"][:2] == ("no-file", '"folder" is a folder')
    assert found["big.xml"][0] == "too-large"
    assert found["a\0b"][0] == "no-file"
