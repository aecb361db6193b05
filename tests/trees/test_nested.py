"""Nodes inside one another, tick by tick, worked out by hand from bt_xml.md, sections 5 to 8. Notation: tests/trees/harness.py."""

from __future__ import annotations

import pytest

from tests.trees.harness import Bench

NESTED = [
    # body                                                                                              ticks
    # a reactive parent halts and restarts what has memory
    ("<ReactiveSequence>a:SSF <Sequence>b:S c:RRS</Sequence></ReactiveSequence>", "aS bS cR → R; aS cR → R; aF c! → F"),
    ("<ReactiveFallback>a:FFS <Sequence>b:S c:R</Sequence></ReactiveFallback>", "aF bS cR → R; aF cR → R; aS c! → S; aS → S"),
    ("<ReactiveSequence>a:SSFS <SequenceWithMemory>b:S c:R</SequenceWithMemory></ReactiveSequence>", "aS bS aS cR → R; aF c! → F; aS cR → R"),
    ("<ReactiveFallback><Inverter>a:SSF</Inverter>b:R</ReactiveFallback>", "aS bR → R; aS bR → R; aF b! → S"),
    ("<ReactiveSequence><ReactiveFallback>a:FS b:R</ReactiveFallback>c:R</ReactiveSequence>", "aF bR → R; aS b! cR → R"),
    ("<ReactiveSequence>a:S <ReactiveSequence>b:SF c:R</ReactiveSequence></ReactiveSequence>", "aS bS cR → R; aS bF c! → F"),
    # memory of sequences and fallbacks in one another
    ("<Fallback><Sequence>a:S b:RF</Sequence>c:RS</Fallback>", "aS bR → R; bF cR → R; cS → S"),
    ("<Sequence><Fallback>a:F b:RS</Fallback>c:RF</Sequence>", "aF bR → R; bS cR → R; cF → F; aF bS cF → F"),
    ("<Fallback><Sequence>a:F b:S</Sequence><Sequence>c:S d:F</Sequence>e:S</Fallback>", "aF cS dF eS → S"),
    ("<Sequence>a:S <Fallback>b:K c:K</Fallback>d:S</Sequence>", "aS bK cK dS → S"),
    ("<Fallback><Sequence>a:K b:K</Sequence>c:S</Fallback>", "aK bK cS → S"),
    ("<Fallback><Sequence>a:K b:K</Sequence>c:K</Fallback>", "aK bK cK → K"),
    ("<SequenceWithMemory><Fallback>a:F b:S</Fallback>c:FS</SequenceWithMemory>", "aF bS cF → F; cS → S"),
    # retries and repeats around what is not finished at once
    ('<RetryUntilSuccessful num_attempts="2"><Sequence>a:S b:FS</Sequence></RetryUntilSuccessful>', "aS bF aS bS → S"),
    ('<RetryUntilSuccessful num_attempts="2"><Sequence>a:S b:RFS</Sequence></RetryUntilSuccessful>', "aS bR → R; bF aS bS → S"),
    ('<RetryUntilSuccessful num_attempts="2"><SequenceWithMemory>a:S b:FS</SequenceWithMemory></RetryUntilSuccessful>', "aS bF bS → S"),
    ('<Repeat num_cycles="2"><Fallback>a:F b:S</Fallback></Repeat>', "aF bS aF bS → S"),
    ('<Repeat num_cycles="2"><Repeat num_cycles="2">a:S</Repeat></Repeat>', "aS aS aS aS → S"),
    ('<Repeat num_cycles="2"><Repeat num_cycles="2">a:S</Repeat></Repeat>', "= aS → R; = aS aS → R; = aS → S"),
    ('<Repeat num_cycles="3"><RetryUntilSuccessful num_attempts="2">a:FSFFS</RetryUntilSuccessful></Repeat>', "aF aS aF aF → F"),
    ('<Sequence>a:S <Repeat num_cycles="2">b:RS</Repeat>c:S</Sequence>', "aS bR → R; bS bS cS → S"),
    ('<ReactiveSequence>a:SF <Repeat num_cycles="5">b:SR</Repeat></ReactiveSequence>', "= aS bS → R; = aF → F"),
    ('<Fallback><RetryUntilSuccessful num_attempts="2">a:F</RetryUntilSuccessful>b:S</Fallback>', "= aF → R; = aF bS → S"),
    ('<Inverter><RetryUntilSuccessful num_attempts="2">a:F</RetryUntilSuccessful></Inverter>', "aF aF → S"),
    ("<ForceFailure><KeepRunningUntilFailure>a:SF</KeepRunningUntilFailure></ForceFailure>", "aS → R; aF → F"),
    ('<Sequence><RunOnce>a:S</RunOnce>b:S</Sequence>', "aS bS → S; bS → S; bS → S"),
    ('<Fallback><RunOnce then_skip="false">a:F</RunOnce>b:S</Fallback>', "aF bS → S; bS → S"),
    ('<RunOnce><Sequence>a:K b:K</Sequence></RunOnce>', "aK bK → K; aK bK → K"),
    # parallel nodes
    ("<Parallel><Sequence>a:S b:R</Sequence>c:RF</Parallel>", "aS bR cR → R; bR cF b! → F"),
    ('<Parallel success_count="1"><Sequence>a:S b:RRS</Sequence>c:R</Parallel>', "aS bR cR → R; bR cR → R; bS c! → S"),
    ("<Parallel>a:RRS b:RS c:S</Parallel>", "aR bR cS → R; aR bS → R; aS → S"),
    ("<ParallelAll>a:RF b:RRS <Sequence>c:S d:RS</Sequence></ParallelAll>", "aR bR cS dR → R; aF bR dS → R; bS → F"),
    ('<Parallel failure_count="2" success_count="1">a:F b:RF c:RRS</Parallel>', "aF bR cR → R; bF c! → F"),
    ("<ReactiveSequence>a:SF <Parallel>b:R c:S d:R</Parallel></ReactiveSequence>", "aS bR cS dR → R; aF b! d! → F"),
    # branches
    ("<IfThenElse><Sequence>a:S b:RS</Sequence>c:S d:S</IfThenElse>", "aS bR → R; bS cS → S"),
    ("<IfThenElse>a:S <IfThenElse>b:F c:S d:RS</IfThenElse></IfThenElse>", "aS bF dR → R; dS → S"),
    ("<WhileDoElse>a:SSF <Sequence>b:S c:R</Sequence>d:S</WhileDoElse>", "aS bS cR → R; aS cR → R; aF c! dS → S"),
    ("<WhileDoElse>a:FS b:R <Sequence>c:S d:R</Sequence></WhileDoElse>", "aF cS dR → R; aS d! bR → R"),
    ("<Fallback><IfThenElse>a:F b:S</IfThenElse>c:S</Fallback>", "aF cS → S"),
    ("<Sequence><TryCatch>a:S b:F z:S</TryCatch>c:S</Sequence>", "aS bF zS → F"),
    ("<TryCatch><Fallback>a:F b:S</Fallback>c:RF z:F</TryCatch>", "aF bS cR → R; cF zF → F"),
    ('<TryCatch catch_on_halt="true"><Sequence>a:S b:R</Sequence><Sequence>y:S z:S</Sequence></TryCatch>', "aS bR → R; halt b! yS zS"),
    # timers
    ('<Timeout msec="100"><RetryUntilSuccessful num_attempts="-1">a:FR</RetryUntilSuccessful></Timeout>', "aF aR → R; +100 a!; → F"),
    ('<Fallback><Timeout msec="50">a:R</Timeout>b:S</Fallback>', "aR → R; +50 a!; bS → S"),
    ('<Sequence><Delay delay_msec="30">a:S</Delay><Delay delay_msec="20">b:S</Delay></Sequence>', "→ R; +30; aS → R; +20; bS → S"),
    ('<Parallel><Sleep msec="30"/><Sleep msec="60"/>a:S</Parallel>', "aS → R; +30; → R; +30; → S"),
    ('<Repeat num_cycles="2"><Sleep msec="40"/></Repeat>', "→ R; +40; → R; +40; → S"),
    ('<ReactiveSequence>a:SSF <Sleep msec="50"/></ReactiveSequence>', "aS → R; +20; aS → R; +40; aF → F"),
    ('<Timeout msec="100"><Timeout msec="50">a:R</Timeout></Timeout>', "aR → R; +50 a!; → F; aR → R"),
]

CONDITIONS = [
    # body; the root entry n is 1
    ('<Sequence><Script code="n := 2"/>a:S(_skipIf="n == 2")b:S</Sequence>', "bS → S"),
    ('<Fallback>a:F(_onFailure="n = 5")b:S(_failureIf="n == 1")</Fallback>', "aF bS → S"),
    ('<Fallback>a:S(_failureIf="true")b:S</Fallback>', "bS → S"),
    ('<ReactiveSequence>a:S <Sequence _while="n == 1">b:RS <Script code="n = 2"/> c:R</Sequence></ReactiveSequence>',
     "aS bR → R; aS bS cR → R; aS c! → S"),
    ('<Sequence _post="n += 10">a:S b:F(_onFailure="n += 1")</Sequence>', "aS bF → F"),
    ('<Repeat num_cycles="3"><Sequence>a:S(_onSuccess="n += 1" _failureIf="n > 2")</Sequence></Repeat>', "aS aS → F"),
    ('<Sequence><Sequence _skipIf="n == 1">a:S</Sequence><Fallback _successIf="n == 1">b:F</Fallback>c:S</Sequence>', "cS → S"),
    ('<KeepRunningUntilFailure><Sequence>a:S(_onSuccess="n += 1")<ScriptCondition code="n &lt; 3"/></Sequence></KeepRunningUntilFailure>',
     "aS → R; aS → F"),
    ('<Parallel success_count="1">a:R(_onHalted="n = 7")b:S</Parallel>', "aR bS a! → S"),
    ('<IfThenElse><ScriptCondition code="n == 1"/><Script code="n = 2" _post="n += 1"/>a:S</IfThenElse>', "→ S; aS → S"),
]


@pytest.mark.parametrize(("body", "ticks"), NESTED)
def test_nested(body: str, ticks: str) -> None:
    assert Bench(body).run(ticks) == ticks


@pytest.mark.parametrize(("body", "ticks"), CONDITIONS)
def test_conditions_of_nested_nodes(body: str, ticks: str) -> None:
    assert Bench(body, blackboard={"n": 1}).run(ticks) == ticks
