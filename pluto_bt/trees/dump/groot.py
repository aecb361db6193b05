"""The mission as one file that Groot2 opens: the trees that are used, and models of the nodes that are not built in."""

from __future__ import annotations

from xml.sax.saxutils import escape

from pluto_bt.source.xml_reader import XmlElement
from pluto_bt.trees.dump.palette import model_lines
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.registry import NodeType


def groot(plan: Plan) -> str:
    """BehaviorTree.CPP v4 XML: includes are taken in, every attribute is kept, and the comments inside of trees."""
    trees: dict[str, XmlElement] = {}
    types: dict[str, NodeType] = {}
    _collect(plan, _tree_of(plan), trees, types)
    main = next(iter(trees))
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f'<root BTCPP_format="4" main_tree_to_execute="{attribute_text(main)}">']
    for tree_id, element in trees.items():
        lines.append(f'  <BehaviorTree ID="{attribute_text(tree_id)}">')
        _add_content(element, 2, lines)
        lines.append("  </BehaviorTree>")
    lines.append("  <TreeNodesModel>")
    for name in sorted(types):
        lines += model_lines(types[name], "    ")
    for element in trees.values():
        _add_subtree_models(element, trees, lines)
    return "\n".join([*lines, "  </TreeNodesModel>", "</root>"]) + "\n"


def _tree_of(plan: Plan) -> XmlElement:
    element = plan.element
    while element.parent is not None and element.tag != "BehaviorTree":
        element = element.parent
    return element


def _collect(plan: Plan, tree: XmlElement, trees: dict[str, XmlElement], types: dict[str, NodeType]) -> None:
    trees.setdefault(tree.get("ID", "BehaviorTree_0"), tree)
    if plan.node_type is not None and not plan.node_type.builtin:
        types[plan.node_type.name] = plan.node_type
    for child in plan.children:
        _collect(child, _tree_of(child) if plan.node_type is None else tree, trees, types)


def _add_content(element: XmlElement, level: int, lines: list[str]) -> None:
    """Children and comments in their order."""
    notes = list(element.comments)
    for i in range(len(element.children) + 1):
        while notes and notes[0].child_index == i:
            note = notes.pop(0)
            text = note.text.replace("--", "- -") + ("" if note.text[-1:] != "-" else " ")  # other parsers take "--" for the end
            lines.append(f"{'  ' * level}<?{note.text}?>" if note.is_instruction else f"{'  ' * level}<!--{text}-->")
        if i < len(element.children):
            _add_element(element.children[i], level, lines)


def _add_element(element: XmlElement, level: int, lines: list[str]) -> None:
    indent = "  " * level
    attributes = "".join(f' {name}="{attribute_text(one.value)}"' for name, one in element.attributes.items())
    if not element.children and not element.comments:
        lines.append(f"{indent}<{element.tag}{attributes}/>")
        return
    lines.append(f"{indent}<{element.tag}{attributes}>")
    _add_content(element, level + 1, lines)
    lines.append(f"{indent}</{element.tag}>")


def _add_subtree_models(tree: XmlElement, trees: dict[str, XmlElement], lines: list[str]) -> None:
    """The declared inputs of the tree, from the model in its own file."""
    for models in tree.parent.children if tree.parent is not None else ():
        if models.tag != "TreeNodesModel":
            continue
        for model in models.children:
            if model.tag == "SubTree" and model.get("ID") == tree.get("ID") and model.get("ID") in trees:
                _add_model(model, lines)


def _add_model(model: XmlElement, lines: list[str]) -> None:
    lines.append(f'    <SubTree ID="{attribute_text(model.get("ID"))}">')
    for port in model.children:
        attributes = "".join(f' {name}="{attribute_text(one.value)}"' for name, one in port.attributes.items())
        text = escape(port.text.strip())
        lines.append(f"      <{port.tag}{attributes}>{text}</{port.tag}>" if text else f"      <{port.tag}{attributes}/>")
    lines.append("    </SubTree>")


def attribute_text(value: str) -> str:
    """A value between double quotes; line feeds and tabs survive."""
    return escape(value, {'"': "&quot;", "\n": "&#10;", "\t": "&#9;", "\r": "&#13;"})
