"""Clock, components, the two schedulers, supervision, typed parameters and the trace. Knows nothing of what the components do."""

from pluto_bt.runtime.clock import Clock, VirtualClock
from pluto_bt.runtime.component import Component

__all__ = ["Clock", "Component", "VirtualClock"]
