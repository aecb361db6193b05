"""The live monitor of Groot2: the protocol of BehaviorTree.CPP 4.10's publisher, served read-only over ZeroMQ (the extra `groot`)."""
