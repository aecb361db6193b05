"""Control nodes of bt_xml.md, section 6, tick by tick. Notation: tests/trees/harness.py; "= " in front means tick_exactly_once."""

from __future__ import annotations

import pytest

from tests.trees.harness import Bench

SEQUENCE = [
    # body                                                            ticks
    ("<Sequence>a:S b:S</Sequence>", "aS bS → S; aS bS → S"),
    ("<Sequence>a:S b:F c:S</Sequence>", "aS bF → F; aS bF → F"),
    ("<Sequence>a:S b:RRS c:S</Sequence>", "aS bR → R; bR → R; bS cS → S"),
    ("<Sequence>a:S b:RF c:S</Sequence>", "aS bR → R; bF → F; aS bF → F"),
    ("<Sequence>a:R</Sequence>", "aR → R; halt a!; aR → R"),
    ("<Sequence>a:S b:R</Sequence>", "aS bR → R; halt b!; aS bR → R"),
    ("<Sequence>a:K b:K</Sequence>", "aK bK → K; aK bK → K"),
    ("<Sequence>a:K b:S</Sequence>", "aK bS → S"),
    ("<Sequence>a:S b:K</Sequence>", "aS bK → S"),
    ("<Sequence>a:K b:F</Sequence>", "aK bF → F"),
    ("<Sequence>a:K b:RS c:K</Sequence>", "aK bR → R; bS cK → S"),
    ("<Sequence>a:K b:RK</Sequence>", "aK bR → R; bK b! → K"),
    ("<Sequence><Sequence>a:S b:RS</Sequence>c:S</Sequence>", "aS bR → R; bS cS → S"),
    ("<Sequence><Sequence>a:K b:K</Sequence>c:S</Sequence>", "aK bK cS → S; aK bK cS → S"),
    ("<Sequence><Sequence>a:K</Sequence><Sequence>b:K</Sequence></Sequence>", "aK bK → K"),
    ("<AsyncSequence>a:S b:S c:S</AsyncSequence>", "aS bS cS → S"),
    ("<AsyncSequence>a:S b:S c:S</AsyncSequence>", "= aS → R; = bS → R; = cS → S; = aS → R"),
    ("<AsyncSequence>a:RS b:S c:S</AsyncSequence>", "= aR → R; = aS bS → R; = cS → S"),
    ("<AsyncSequence>a:S b:F c:S</AsyncSequence>", "= aS → R; = bF → F; = aS → R"),
    ("<AsyncSequence>a:K b:S c:K</AsyncSequence>", "= aK bS → R; = cK → S"),
    ("<AsyncSequence>a:S b:RS</AsyncSequence>", "aS bR → R; bS → S"),
    ("<SequenceWithMemory>a:S b:FS c:S</SequenceWithMemory>", "aS bF → F; bS cS → S; aS bS cS → S"),
    ("<SequenceWithMemory>a:S b:S c:S</SequenceWithMemory>", "= aS → R; = bS → R; = cS → S"),
    ("<SequenceWithMemory>a:S b:RS c:S</SequenceWithMemory>", "aS bR → R; halt b!; bS cS → S"),
    ("<SequenceWithMemory>a:S b:RF c:S</SequenceWithMemory>", "aS bR → R; bF → F; bF → F"),
    ("<SequenceWithMemory>a:K b:K</SequenceWithMemory>", "aK bK → K"),
    ("<SequenceWithMemory>a:K b:FS</SequenceWithMemory>", "aK bF → F; bS → S"),
]

FALLBACK = [
    ("<Fallback>a:F b:S c:S</Fallback>", "aF bS → S; aF bS → S"),
    ("<Fallback>a:F b:F</Fallback>", "aF bF → F; aF bF → F"),
    ("<Fallback>a:F b:RS</Fallback>", "aF bR → R; bS → S; aF bS → S"),
    ("<Fallback>a:F b:RF c:S</Fallback>", "aF bR → R; bF cS → S"),
    ("<Fallback>a:K b:K</Fallback>", "aK bK → K; aK bK → K"),
    ("<Fallback>a:K b:F</Fallback>", "aK bF → F"),
    ("<Fallback>a:F b:K</Fallback>", "aF bK → F"),
    ("<Fallback>a:K b:S</Fallback>", "aK bS → S"),
    ("<Fallback>a:F b:R</Fallback>", "aF bR → R; halt b!; aF bR → R"),
    ("<AsyncFallback>a:F b:F c:S</AsyncFallback>", "aF bF cS → S"),
    ("<AsyncFallback>a:F b:F c:F</AsyncFallback>", "= aF → R; = bF → R; = cF → F; = aF → R"),
    ("<AsyncFallback>a:RF b:S</AsyncFallback>", "= aR → R; = aF bS → S"),
    ("<AsyncFallback>a:F b:S c:S</AsyncFallback>", "= aF → R; = bS → S"),
    ("<AsyncFallback>a:K b:F c:S</AsyncFallback>", "= aK bF → R; = cS → S"),
]

REACTIVE = [
    ("<ReactiveSequence>a:S b:RRS</ReactiveSequence>", "aS bR → R; aS bR → R; aS bS → S"),
    ("<ReactiveSequence>a:SF b:R</ReactiveSequence>", "aS bR → R; aF b! → F; aF → F"),
    ("<ReactiveSequence>a:SR b:R</ReactiveSequence>", "aS bR → R; aR b! → R"),
    ("<ReactiveSequence>a:SK b:RS</ReactiveSequence>", "aS bR → R; aK bS → S"),
    ("<ReactiveSequence>a:K b:K</ReactiveSequence>", "aK bK → K"),
    ("<ReactiveSequence>a:S b:SR c:R</ReactiveSequence>", "aS bS cR → R; aS bR c! → R"),
    ("<ReactiveSequence>a:S b:R</ReactiveSequence>", "aS bR → R; halt b!; aS bR → R"),
    ("<ReactiveSequence>a:S <Sequence>b:S c:RS</Sequence></ReactiveSequence>", "aS bS cR → R; aS cS → S"),
    ("<ReactiveFallback>a:F b:RS</ReactiveFallback>", "aF bR → R; aF bS → S"),
    ("<ReactiveFallback>a:FS b:R</ReactiveFallback>", "aF bR → R; aS b! → S"),
    ("<ReactiveFallback>a:FR b:R c:R</ReactiveFallback>", "aF bR → R; aR b! → R"),
    ("<ReactiveFallback>a:F b:F</ReactiveFallback>", "aF bF → F"),
    ("<ReactiveFallback>a:K b:K</ReactiveFallback>", "aK bK → K"),
    ("<ReactiveFallback>a:K b:F</ReactiveFallback>", "aK bF → F"),
    ("<ReactiveFallback>a:FK b:RS</ReactiveFallback>", "aF bR → R; aK bS → S"),
]

PARALLEL = [
    ("<Parallel>a:S b:S</Parallel>", "aS bS → S"),
    ("<Parallel>a:RS b:S</Parallel>", "aR bS → R; aS → S"),
    ("<Parallel>a:R b:F c:S</Parallel>", "aR bF a! → F"),
    ("<Parallel>a:R b:S c:F d:S</Parallel>", "aR bS cF a! → F; aR bS cF a! → F"),
    ('<Parallel success_count="1">a:R b:S c:S</Parallel>', "aR bS a! → S"),
    ('<Parallel success_count="2">a:R b:S c:S d:S</Parallel>', "aR bS cS a! → S"),
    ('<Parallel success_count="-2">a:R b:S c:S</Parallel>', "aR bS cS a! → S"),
    ('<Parallel failure_count="2">a:F b:S</Parallel>', "aF → F"),
    ('<Parallel success_count="1" failure_count="2">a:F b:RS</Parallel>', "aF bR → R; bS → S"),
    ('<Parallel success_count="1" failure_count="2">a:F b:RF</Parallel>', "aF bR → R; bF → F"),
    ('<Parallel success_count="1" failure_count="-1">a:F b:F c:S</Parallel>', "aF bF cS → S"),
    ("<Parallel>a:K b:K</Parallel>", "aK bK → S"),
    ("<Parallel>a:K b:S</Parallel>", "aK bS → S"),
    ('<Parallel success_count="1">a:K b:K</Parallel>', "aK bK → K"),
    ('<Parallel success_count="2">a:S b:K</Parallel>', "aS bK → R; bK → R"),
    ('<Parallel success_count="2" failure_count="2">a:S b:R</Parallel>', "aS bR → R; halt b!; aS bR → R"),
    ("<ParallelAll>a:S b:RS</ParallelAll>", "aS bR → R; bS → S"),
    ("<ParallelAll>a:F b:RS</ParallelAll>", "aF bR → R; bS → F"),
    ('<ParallelAll max_failures="2">a:F b:S</ParallelAll>', "aF bS → S"),
    ('<ParallelAll max_failures="-1">a:F b:F</ParallelAll>', "aF bF → F"),
    ("<ParallelAll>a:K b:K</ParallelAll>", "aK bK → K"),
    ("<ParallelAll>a:K b:S</ParallelAll>", "aK bS → S"),
    ("<ParallelAll>a:K b:RS</ParallelAll>", "aK bR → R; aK bS → S"),
    ("<ParallelAll>a:R b:S</ParallelAll>", "aR bS → R; halt a!; aR bS → R"),
]

BRANCH = [
    ("<IfThenElse>a:S b:S c:S</IfThenElse>", "aS bS → S"),
    ("<IfThenElse>a:F b:S c:F</IfThenElse>", "aF cF → F"),
    ("<IfThenElse>a:F b:S</IfThenElse>", "aF → F"),
    ("<IfThenElse>a:SF b:RRS c:S</IfThenElse>", "aS bR → R; bR → R; bS → S; aF cS → S"),
    ("<IfThenElse>a:RS b:S</IfThenElse>", "aR → R; aS bS → S"),
    ("<IfThenElse>a:S b:K c:S</IfThenElse>", "aS bK → K"),
    ("<IfThenElse>a:SF b:R c:R</IfThenElse>", "aS bR → R; halt b!; aF cR → R"),
    ("<WhileDoElse>a:SSF b:R c:S</WhileDoElse>", "aS bR → R; aS bR → R; aF b! cS → S"),
    ("<WhileDoElse>a:SF b:R</WhileDoElse>", "aS bR → R; aF b! → F"),
    ("<WhileDoElse>a:FS b:S c:R</WhileDoElse>", "aF cR → R; aS c! bS → S"),
    ("<WhileDoElse>a:SRS b:RS</WhileDoElse>", "aS bR → R; aR → R; aS bS → S"),
    ("<WhileDoElse>a:S b:K c:S</WhileDoElse>", "aS bK → K"),
    ("<TryCatch>a:S b:S z:S</TryCatch>", "aS bS → S"),
    ("<TryCatch>a:S b:F z:S</TryCatch>", "aS bF zS → F; aS bF zS → F"),
    ("<TryCatch>a:RF b:S z:RS</TryCatch>", "aR → R; aF zR → R; zS → F"),
    ("<TryCatch>a:F z:K</TryCatch>", "aF zK → F"),
    ("<TryCatch>a:K b:K z:S</TryCatch>", "aK bK → K"),
    ("<TryCatch>a:K b:S z:S</TryCatch>", "aK bS → S"),
    ("<TryCatch>a:R z:S</TryCatch>", "aR → R; halt a!"),
    ('<TryCatch catch_on_halt="true">a:S b:R z:S</TryCatch>', "aS bR → R; halt b! zS; aS bR → R"),
    ('<TryCatch catch_on_halt="true">a:R z:R</TryCatch>', "aR → R; halt a! zR z!"),
    ('<TryCatch catch_on_halt="true">a:F z:R</TryCatch>', "aF zR → R; halt z!"),
]


@pytest.mark.parametrize(("body", "ticks"), SEQUENCE + FALLBACK + REACTIVE + PARALLEL + BRANCH)
def test_control_node(body: str, ticks: str) -> None:
    assert Bench(body).run(ticks) == ticks


SWITCH = [
    # value of v           body                                                            ticks
    ({"v": "1"}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:S b:S c:S</Switch2>', "aS → S"),
    ({"v": "2"}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:S b:F c:S</Switch2>', "bF → F"),
    ({"v": "x"}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:S b:F c:S</Switch2>', "cS → S"),
    ({"v": "2.0"}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:S b:S c:S</Switch2>', "bS → S"),
    ({"v": "1.00000001"}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:S b:S c:S</Switch2>', "aS → S"),
    ({"v": "1"}, '<Switch2 variable="{v}" case_1="RED" case_2="GREEN">a:S b:S c:S</Switch2>', "aS → S"),
    ({"v": "GREEN"}, '<Switch2 variable="{v}" case_1="RED" case_2="2">a:S b:S c:S</Switch2>', "bS → S"),
    ({}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:S b:S c:S</Switch2>', "cS → S"),
    ({}, '<Switch2 case_1="1" case_2="2">a:S b:S c:S</Switch2>', "cS → S"),
    ({"v": "1"}, '<Switch2 variable="{v}" case_1="1" case_2="2">a:K b:S c:S</Switch2>', "aK → K"),
    ({"v": "3"}, '<Switch3 variable="{v}" case_1="1" case_2="2" case_3="3">a:S b:S c:RS d:S</Switch3>', "cR → R; cS → S"),
]


@pytest.mark.parametrize(("board", "body", "ticks"), SWITCH)
def test_switch_chooses_by_text_then_integer_then_real(board: dict[str, str], body: str, ticks: str) -> None:
    assert Bench(body, blackboard=board, enums={"RED": 1, "GREEN": 2}).run(ticks) == ticks


def test_switch_halts_the_branch_that_was_running_when_the_choice_changes() -> None:
    bench = Bench('<Switch2 variable="{v}" case_1="1" case_2="2">a:R b:R c:S</Switch2>', blackboard={"v": "1"})
    assert bench.tick() == "aR → R"
    bench.mission.blackboard["v"] = "2"
    assert bench.tick() == "a! bR → R"
    bench.mission.blackboard["v"] = "9"
    assert bench.tick() == "b! cS → S"
