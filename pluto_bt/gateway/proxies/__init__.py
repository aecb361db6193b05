"""The manual's proxies: thin typed classes over the gateway, one for each thing that one talks to.

```python
with LocProxy(interfaces=9) as loc:
    print(loc.get_pose(3).pose)
```
Sources: Pluto Software Documentation, section 5 and the sections of the modules.
"""

from pluto_bt.gateway.proxies.chain import AvoidProxy, DriveProxy, FollowProxy, MotionProxy
from pluto_bt.gateway.proxies.limbs import ArmProxy, WristProxy
from pluto_bt.gateway.proxies.navigation import LocProxy, PoseProxy, SlamProxy
from pluto_bt.gateway.proxies.proxy import Proxy
from pluto_bt.gateway.proxies.sensors import (
    BaseProxy,
    BumperProxy,
    CompassProxy,
    DmuProxy,
    GasProxy,
    GpsProxy,
    ImuProxy,
    MarkerProxy,
    SickProxy,
    SonarProxy,
    SpeedProxy,
    WeatherProxy,
)

PROXIES: tuple[type[Proxy], ...] = (
    LocProxy, PoseProxy, SlamProxy, DriveProxy, AvoidProxy, MotionProxy, FollowProxy, WristProxy, ArmProxy, BaseProxy, SonarProxy, BumperProxy,
    SickProxy, DmuProxy, ImuProxy, CompassProxy, GpsProxy, MarkerProxy, SpeedProxy, WeatherProxy, GasProxy,
)  # fmt: skip

__all__ = [
    "PROXIES", "ArmProxy", "AvoidProxy", "BaseProxy", "BumperProxy", "CompassProxy", "DmuProxy", "DriveProxy", "FollowProxy", "GasProxy", "GpsProxy",
    "ImuProxy", "LocProxy", "MarkerProxy", "MotionProxy", "PoseProxy", "Proxy", "SickProxy", "SlamProxy", "SonarProxy", "SpeedProxy", "WeatherProxy",
    "WristProxy",
]  # fmt: skip
