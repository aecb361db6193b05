"""The shared blackboard: messages, codes, THE table of topics, the store and the inboxes of the command chain."""

from pluto_bt.blackboard.inbox import Inbox, Letter
from pluto_bt.blackboard.store import Blackboard, Publisher, Sample, Snapshot, TopicError
from pluto_bt.blackboard.topics import TOPICS, Topic

__all__ = ["TOPICS", "Blackboard", "Inbox", "Letter", "Publisher", "Sample", "Snapshot", "Topic", "TopicError"]
