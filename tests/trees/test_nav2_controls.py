"""Nav2's controls and decorators of bt_xml.md, section 14, tick by tick. Notation: tests/trees/harness.py."""

from __future__ import annotations

import pytest

from pluto_bt.trees import TickError
from tests.trees.harness import Bench

PIPELINE = [
    # body                                                                              ticks
    ("<PipelineSequence>a:S b:S</PipelineSequence>", "aS bS → S; aS bS → S"),
    ("<PipelineSequence>a:S b:R c:S</PipelineSequence>", "aS bR → R; aS bR → R"),
    ("<PipelineSequence>a:SR b:RRS c:R</PipelineSequence>", "aS bR → R; aR bR → R; aR bS cR → R; aR bS cR → R"),
    ("<PipelineSequence>a:RS b:RS c:RS</PipelineSequence>", "aR → R; aS bR → R; aS bS cR → R; aS bS cS → S"),
    ("<PipelineSequence>a:SSF b:R</PipelineSequence>", "aS bR → R; aS bR → R; aF b! → F"),
    ("<PipelineSequence>a:SRR b:RSS c:RF</PipelineSequence>", "aS bR → R; aR bS cR → R; aR bS cF a! → F"),
    ("<PipelineSequence>a:K b:S</PipelineSequence>", "aK bS → S"),
    ("<PipelineSequence>a:K b:K</PipelineSequence>", "aK bK → K"),
    ("<PipelineSequence>a:SR b:R c:S</PipelineSequence>", "aS bR → R; halt b!; aR → R"),
    ("<PipelineSequence>a:SRR b:RSS c:S</PipelineSequence>", "aS bR → R; aR bS cS a! → S; aR → R"),
]

RECOVERY = [
    ("<RecoveryNode>a:S b:S</RecoveryNode>", "aS → S"),
    ("<RecoveryNode>a:FS b:S</RecoveryNode>", "aF bS aS → S"),
    ("<RecoveryNode>a:F b:S</RecoveryNode>", "aF bS aF → F; aF bS aF → F"),
    ("<RecoveryNode>a:F b:F</RecoveryNode>", "aF bF → F"),
    ('<RecoveryNode number_of_retries="2">a:FFS b:S</RecoveryNode>', "aF bS aF bS aS → S"),
    ('<RecoveryNode number_of_retries="0">a:F b:S</RecoveryNode>', "aF → F"),
    ("<RecoveryNode>a:RFS b:RS</RecoveryNode>", "aR → R; aF bR → R; bS aS → S"),
    ("<RecoveryNode>a:K b:S</RecoveryNode>", "aK → K"),
    ('<RecoveryNode number_of_retries="2">a:F b:SKS</RecoveryNode>', "aF bS aF bK → F; aF bS aF → F; aF bS aF bS aF → F"),
    ("<RecoveryNode>a:FR b:R</RecoveryNode>", "aF bR → R; halt b!; aR → R"),
    ("<RecoveryNode><Sequence>a:S b:F</Sequence>c:S</RecoveryNode>", "aS bF cS aS bF → F"),
]

ROUND_ROBIN = [
    ("<RoundRobin>a:S b:S c:S</RoundRobin>", "aS → S; bS → S; cS → F; aS → S"),
    ('<RoundRobin wrap_around="true">a:S b:S</RoundRobin>', "aS → S; bS → S; aS → S"),
    ("<RoundRobin>a:F b:S c:S</RoundRobin>", "aF bS → S; cS → F"),
    ('<RoundRobin wrap_around="true">a:F b:S</RoundRobin>', "aF bS → S; aF bS → S"),
    ("<RoundRobin>a:F b:F</RoundRobin>", "aF bF → F; aF bF → F"),
    ('<RoundRobin wrap_around="true">a:SF b:F</RoundRobin>', "aS → S; bF aF → F"),
    ("<RoundRobin>a:K b:S c:S</RoundRobin>", "aK bS → S"),
    ("<RoundRobin>a:K b:K</RoundRobin>", "aK bK → K"),
    ("<RoundRobin>a:SK b:K</RoundRobin>", "aS → S; bK → F; aK bK → K"),
    ("<RoundRobin>a:RS b:RF c:S</RoundRobin>", "aR → R; aS → S; bR → R; bF cS → F"),
    ("<RoundRobin>a:S b:R c:S</RoundRobin>", "aS → S; bR → R; halt b!; aS → S"),
    ("<RoundRobin>a:F b:RF c:RS</RoundRobin>", "aF bR → R; bF cR → R; cS → F"),
    ("<Sequence><RoundRobin>a:S b:S c:S</RoundRobin></Sequence>", "aS → S; bS → S; cS → F"),
]

SEQUENCES = [
    ("<NonblockingSequence>a:S b:S</NonblockingSequence>", "aS bS → S"),
    ("<NonblockingSequence>a:RS b:RRS c:S</NonblockingSequence>", "aR bR cS → R; aS bR cS → R; aS bS cS → S"),
    ("<NonblockingSequence>a:RS b:SR</NonblockingSequence>", "aR bS → R; aS bR → R"),
    ("<NonblockingSequence>a:R b:F c:S</NonblockingSequence>", "aR bF a! → F"),
    ("<NonblockingSequence>a:R b:R</NonblockingSequence>", "aR bR → R; halt a! b!; aR bR → R"),
    ("<PersistentSequence>a:S b:S</PersistentSequence>", "aS bS → S; aS bS → S"),
    ("<PersistentSequence>a:S b:RS</PersistentSequence>", "aS bR → R; bS → S"),
    ('<PersistentSequence current_child_idx="{i}">a:S b:R c:S</PersistentSequence>', "aS bR → R; halt b!; bR → R"),
    ('<PersistentSequence current_child_idx="{i}">a:S b:F c:S</PersistentSequence>', "aS bF → F; aS bF → F"),
    ('<PersistentSequence current_child_idx="{i}">a:K b:K</PersistentSequence>', "aK bK → S"),
    ('<Sequence><Script code="i:=1"/><PersistentSequence current_child_idx="{i}">a:S b:S</PersistentSequence></Sequence>', "bS → S; bS → S"),
]

TRIGGERS = [
    ("<SingleTrigger>a:S</SingleTrigger>", "aS → S; aS → S"),  # the root is reset after each end
    ("<PipelineSequence><SingleTrigger>a:S</SingleTrigger>b:R</PipelineSequence>", "aS bR → R; b! → F"),
    ("<PipelineSequence><ForceSuccess><SingleTrigger>a:S</SingleTrigger></ForceSuccess>b:R</PipelineSequence>", "aS bR → R; aS bR → R"),
    ("<ReactiveFallback><SingleTrigger>a:F</SingleTrigger>b:R</ReactiveFallback>", "aF bR → R; aF bR → R"),
    ("<SingleTrigger>a:RS</SingleTrigger>", "aR → R; aS → S"),
    ("<SingleTrigger>a:K</SingleTrigger>", "aK → K"),
    ('<SingleTrigger is_global="true">a:S</SingleTrigger>', "aS → S; → F; → F"),
    ('<SingleTrigger is_global="true">a:RS</SingleTrigger>', "aR → R; halt a!; aS → S; → F"),
]

RATES = [
    ('<RateController hz="1">a:S</RateController>', "aS → S; aS → S"),  # reset by the end
    ('<PipelineSequence><RateController hz="1">a:S</RateController>b:R</PipelineSequence>', "aS bR → R; +900; bR → R; +100; aS bR → R; bR → R"),
    ('<PipelineSequence><RateController hz="1">a:RS</RateController>b:R</PipelineSequence>', "aR → R; aS bR → R; +999; bR → R; +1; aS bR → R"),
    ('<PipelineSequence><RateController hz="2">a:SF</RateController>b:R</PipelineSequence>', "aS bR → R; +500; aF b! → F"),
    ('<PipelineSequence><RateController hz="1">a:SR</RateController>b:R</PipelineSequence>', "aS bR → R; +1000; aR bR → R; halt a! b!; aR → R"),
    ('<RateController hz="1">a:K</RateController>', "aK → K; → R; +1000; aK → K"),  # a skip in the middle of its work resets nothing
    ("<PipelineSequence><RateController>a:S</RateController>b:R</PipelineSequence>", "aS bR → R; +99; bR → R; +1; aS bR → R"),
    ('<Sequence><RateController hz="1">a:S</RateController>b:RS</Sequence>', "aS bR → R; bS → S; aS bS → S"),
    ('<ReactiveSequence><RateController hz="1">a:S</RateController>b:R</ReactiveSequence>', "aS bR → R; aS bR → R"),  # siblings are reset
]


@pytest.mark.parametrize(("body", "ticks"), PIPELINE + RECOVERY + ROUND_ROBIN + SEQUENCES + TRIGGERS + RATES)
def test_node(body: str, ticks: str) -> None:
    assert Bench(body).run(ticks) == ticks


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("<NonblockingSequence>a:S b:K</NonblockingSequence>", "child 'b' was skipped, which <NonblockingSequence> does not allow"),
        ("<RecoveryNode>a:S</RecoveryNode>", "RecoveryNode needs 2 children (the work and the recovery), it has 1"),
        ('<PersistentSequence current_child_idx="-1">a:S</PersistentSequence>', "current_child_idx is -1, below 0"),
    ],
)
def test_what_nav2_refuses_while_ticking(body: str, reason: str) -> None:
    with pytest.raises(TickError) as error:
        Bench(body).run("→ S")
    assert reason in str(error.value)
