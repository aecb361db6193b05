"""WouldRetryHelp: is it worth trying again?"""

from __future__ import annotations

from py_trees.common import Status
from py_trees.ports import NoDataAvailable

from pluto_bt.behaviours.leaf import NO_PORTS, Leaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.reasons import may_pass, sentence


class WouldRetryHelp(Leaf):
    """SUCCESS if what a leaf failed with may pass: who stood in the way walks on, a bumper is free again, there is another way. FAILURE if the same
    attempt would end the same: a sensor that says nothing although it was waited for, a position that is lost, a goal that cannot be."""

    KIND = "Condition"
    INPUT_PORTS = {"reason": Port(str, True, "the reason of the leaf that failed, docs/reasons.md; one that is not in the list may pass")}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """Answers at once. Where no leaf has given a reason nobody knows, so it is worth a try."""
        try:
            word = str(self.get_input("reason"))
        except NoDataAvailable:
            word = ""
        if may_pass(word):
            self.feedback_message = f"{word or 'no reason given'}: another try may help"
            return Status.SUCCESS
        self.feedback_message = f"{word}: {sentence(word)}; another try would end the same"
        return Status.FAILURE
