"""The web console in a real browser, in front of a robot that does what the test tells it."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.files import package_root
from pluto_bt.gateway.link import Console
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.port import RunState
from pluto_bt.maps.load import load_world
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.modules.scenery import scenery

from .browsers import ACROSS, PHONE, Screen, chromium
from .conftest import Running, whole

EVIL = '<img src=x onerror="document.title=\'taken\'"><script>document.title="taken"</script>'
POSE = m.Pose(0.0, (4.0, 3.0, 0.0, 0.5, 0.0, 0.0), (0.04, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.001))


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as one:
        yield one


@pytest.fixture(scope="module")
def gateway() -> Iterator[Running]:
    world = load_world(package_root() / "sim" / "worlds" / "yard.xml")
    one = Running(Console(Address("127.0.0.1", 0), scenery(world, load_robot_file("atrv2"), "pluto", mode="live")))
    one.pump()
    yield one
    one.end()


@pytest.fixture
def running(gateway: Running) -> Running:
    """The gateway's process is the same for all tests here, the robot behind it is new."""
    gateway.renew()
    gateway.robot.write("Localization/Pose", POSE)
    return gateway


@pytest.fixture
def open_console(browser: Any, running: Running) -> Iterator[Callable[..., Screen]]:
    screens: list[Screen] = []

    def open_one(path: str = "/", **how: Any) -> Screen:
        screen = Screen(browser, running.url + path, **how)
        screens.append(screen)
        screen.waits_for("#link", "ms")
        return screen

    yield open_one
    for screen in screens:
        screen.close()
    running.wait_until_nobody_is_there()


UPPERMOST = """(button) => {
  const { left, top, width, height } = button.getBoundingClientRect();
  return document.elementFromPoint(left + width / 2, top + height / 2) === button;
}"""


def node(path: str, kind: str, name: str, depth: int, status: str = "IDLE", feedback: str = "") -> m.NodeState:
    return m.NodeState(path, kind, name, depth, status, feedback, 0.0)


@pytest.mark.parametrize("size", [(1440, 900), PHONE], ids=["desk", "phone"])
def test_it_loads_without_a_complaint_and_shows_where_the_robot_is(
    open_console: Callable[..., Screen], running: Running, size: tuple[int, int]
) -> None:
    screen = open_console(size=size)
    screen.waits_for("#pose-x", "4.00")
    running.robot.write("Localization/Pose", m.Pose(0.0, (5.25, 3.0, 0.0, 0.5, 0.0, 0.0)))
    screen.waits_for("#pose-x", "5.25")
    assert screen.text("#robot") == "pluto" and "yard" in screen.text("#place")
    box = screen.page.locator("#stop").bounding_box()
    assert box["y"] + box["height"] <= size[1] and box["width"] >= 200 and box["height"] >= 60, "STOP is always in sight, and large"
    assert screen.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert screen.complaints == []


@pytest.mark.parametrize("size", [(1280, 800), PHONE, ACROSS], ids=["desk", "phone", "phone across"])
def test_nothing_lies_over_what_one_needs(open_console: Callable[..., Screen], running: Running, size: tuple[int, int]) -> None:
    holder = open_console("/?name=Anna")
    holder.click("#lease-take")
    holder.waits_for("#lease-chip", "yours")
    screen = open_console(size=size)
    running.robot.says("late", "warning")
    screen.page.wait_for_selector("#events-count")
    screen.click("#tab-drive")
    screen.click("#drive-arm")
    screen.waits_for("#toast", "held by console Anna")
    screen.page.evaluate("() => { for (let i = 0; i < 10000; i++) clearTimeout(i); }")  # it stays as long as this test looks
    assert screen.page.locator("#drive-arm").evaluate(UPPERMOST), "the toast does not lie over what was just pressed"
    tabs, last = (screen.page.locator(name).bounding_box() for name in (".tabs", "#tab-signals"))
    assert last["x"] + last["width"] <= tabs["x"] + tabs["width"] + 1, "every tab is in sight"
    who = [screen.text(name) for name in ("#lease-chip", "#lease-who") if screen.page.is_visible(name)]
    assert who == ["console Anna"], "who drives is told once, on any screen"
    gauges, lease = (screen.page.locator(name).bounding_box() for name in (".gauges", ".lease"))
    assert gauges["x"] + gauges["width"] <= lease["x"] or lease["y"] + lease["height"] <= gauges["y"], "no button lies on a gauge"
    screen.click("#toast")
    assert screen.page.is_hidden("#toast")


@pytest.mark.parametrize("size", [PHONE, ACROSS], ids=["phone", "phone across"])
@pytest.mark.parametrize("place", [(8.05, 3.04), (3.0, 12.0)], ids=["below", "above"])
def test_the_sheet_of_a_goal_does_not_cover_it(open_console: Callable[..., Screen], size: tuple[int, int], place: tuple[float, float]) -> None:
    screen = open_console(size=size)
    screen.taps(*place)
    screen.waits_for("#goal-place", "0")
    box, map_box = (screen.page.locator(name).bounding_box() for name in ("#goal-sheet", "#map"))
    _, y = screen.page.evaluate("([x, y]) => window.pluto.map.view.toScreen(x, y)", list(place))
    assert not box["y"] <= map_box["y"] + y <= box["y"] + box["height"]


@pytest.mark.parametrize("how", ["click", "space", "space in a button"])
def test_stop_says_when_zero_was_commanded(open_console: Callable[..., Screen], running: Running, how: str) -> None:
    robot = running.robot
    robot.write("ATRV2/Drive/Command", m.ActuatorState(0.0, 0, velocity=(0.4, 0.0)))
    robot.write("ATRV2/Drive/Raw", m.ActuatorState(0.0, 0, velocity=(0.4, 0.0)))
    screen = open_console()
    screen.waits_for("#speed", "0.40")
    if how == "click":
        screen.click("#stop")
    else:
        screen.page.locator("#lease-take" if how == "space in a button" else "#map").focus()
        screen.page.keyboard.press("Space")
    screen.waits_for("#stop-note", "sent")
    robot.write("ATRV2/Drive/Command", m.ActuatorState(0.0, 0))
    screen.waits_for("#stop-note", "zero commanded")
    robot.write("ATRV2/Drive/Raw", m.ActuatorState(0.0, 0))
    screen.waits_for("#stop-note", "standing")
    assert robot.did == [("stop", "console")], "once, without a lease, and the button was not pressed by the space bar"


def test_the_stop_button_takes_its_word_back_when_the_robot_drives_again(open_console: Callable[..., Screen], running: Running) -> None:
    robot = running.robot
    screen = open_console()
    screen.click("#stop")
    screen.waits_for("#stop-note", "heard")
    assert "zero" not in screen.text("#stop-note"), "nobody has told what the base was commanded"
    for moving in ("Command", "Raw"):
        robot.write("ATRV2/Drive/Command", m.ActuatorState(0.0, 0))
        robot.write("ATRV2/Drive/Raw", m.ActuatorState(0.0, 0))
        screen.waits_for("#stop-note", "standing")
        robot.write(f"ATRV2/Drive/{moving}", m.ActuatorState(0.0, 0, velocity=(0.45, 0.0)))
        screen.waits_for("#stop-note", "space bar")
        screen.click("#stop")


def test_a_space_in_a_text_is_a_space(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console()
    screen.click("#tab-params")
    screen.page.locator("#params-filter").press_sequentially("a b")
    assert screen.page.input_value("#params-filter") == "a b"
    assert "stop" not in [entry[0] for entry in running.robot.did]


def test_a_tap_on_the_map_and_a_second_one_to_be_sure_send_the_robot(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console()
    screen.waits_for("#pose-x", "4.00")
    screen.taps(8.05, 3.04)
    screen.waits_for("#goal-place", "pump")
    assert running.robot.did == [], "a tap alone moves nothing"
    screen.click("#goal-goto")
    screen.waits_for("#errand-text", "Go to 8.00, 3.00")
    assert running.robot.did == [("run", "GoTo", {"goal": "8.000;3.000"}, 0.0)]
    assert screen.text("#lease-chip") == "yours"
    running.robot.runs["r1"] = RunState("failed", "stuck", "a wall is near")
    screen.waits_for("#toast", "failed (stuck)", "a wall is near")


def test_a_goal_while_a_mission_runs_pauses_it_and_says_so_before(open_console: Callable[..., Screen], running: Running) -> None:
    running.robot.mission_now = m.MissionState(0.0, "patrol", 1, "running")
    running.robot.write("mission/state", running.robot.mission_now)
    screen = open_console()
    screen.waits_for("#mission-chip", "running")
    screen.taps(6.0, 3.5)
    screen.waits_for("#goal-note", "pauses the mission", "takes the lease")
    screen.click("#goal-cancel")
    assert running.robot.did == [] and screen.page.is_hidden("#goal-sheet")


def test_the_tree_follows_what_runs_and_can_be_folded(open_console: Callable[..., Screen], running: Running) -> None:
    rows = (node("0", "Sequence", "patrol", 1, "RUNNING"), node("0/0", "GoTo", "go", 2, "RUNNING", "2.5 m to go"), node("0/1", "Say", "Say", 2))
    running.robot.write("tree", m.TreeState(0.0, 7, rows))
    screen = open_console()
    screen.waits_for("#tree", "go", "2.5 m to go", "running")
    done = (rows[0], node("0/0", "GoTo", "go", 2, "FAILURE", "stuck"), rows[2])
    running.robot.write("tree", m.TreeState(0.0, 8, done))
    screen.waits_for("#tree li:nth-child(2)", "✕", "failure", "stuck")
    screen.click("#tree li:first-child .fold")
    assert screen.page.locator("#tree li").count() == 1
    screen.click("#tree li:first-child .fold")
    assert screen.page.locator("#tree li").count() == 3


def test_the_nodes_of_a_paused_mission_do_not_run(open_console: Callable[..., Screen], running: Running) -> None:
    robot = running.robot
    robot.write("tree", m.TreeState(1.0, 7, (node("0", "GoTo", "go", 1, "RUNNING"),)))
    robot.write("mission/state", m.MissionState(1.0, "patrol", 1, "paused", "operator-stop"))
    screen = open_console()
    screen.waits_for("#tree", "go", "paused")
    robot.write("tree", m.TreeState(2.0, 1, (node("0", "MoveTo", "errand", 1, "RUNNING"),)))
    screen.waits_for("#tree", "errand", "running")


def test_a_large_tree_shows_the_running_branch(open_console: Callable[..., Screen], running: Running) -> None:
    branches = [[node(f"0/{i}", "Sequence", f"part {i}", 2, "RUNNING" if i == 150 else "IDLE"),
                 node(f"0/{i}/0", "GoTo", f"leaf {i}", 3, "RUNNING" if i == 150 else "IDLE")] for i in range(300)]  # fmt: skip
    running.robot.write("tree", m.TreeState(0.0, 1, (node("0", "Parallel", "all", 1, "RUNNING"), *(one for branch in branches for one in branch))))
    screen = open_console()
    screen.waits_for("#tree", "leaf 150")
    assert screen.page.locator("#tree li").count() == 302


def test_names_that_are_html_stay_words(open_console: Callable[..., Screen], running: Running) -> None:
    robot = running.robot
    robot.mission_now = m.MissionState(0.0, EVIL, 1, "paused", EVIL, EVIL)
    robot.write("mission/state", robot.mission_now)
    robot.write("tree", m.TreeState(0.0, 1, (node(EVIL, EVIL, EVIL, 1, "RUNNING", EVIL),)))
    robot.write("modules", m.ModulesState(0.0, (m.ModuleState(EVIL, "g", EVIL, 1, 1, 0, 0.0, EVIL),)))
    robot.says(EVIL, "error")
    screen = open_console()
    screen.waits_for("#tree", EVIL)
    for tab, panel in (("mission", "#mission-step"), ("events", "#events"), ("modules", "#modules")):
        screen.click(f"#tab-{tab}")
        screen.waits_for(panel, EVIL)
    assert screen.page.evaluate("document.querySelectorAll('main img, main script').length") == 0
    assert "taken" not in screen.page.title() and screen.complaints == []


def test_two_browsers_and_one_lease(open_console: Callable[..., Screen], running: Running) -> None:
    anna, ben = open_console("/?name=Anna"), open_console("/?name=Ben")
    anna.click("#lease-take")
    anna.waits_for("#lease-chip", "yours")
    ben.waits_for("#lease-chip", "console Anna")
    ben.waits_for("#lease-take", "Take over")
    ben.taps(6.0, 3.5)
    ben.waits_for("#goal-note", "console Anna holds the lease")
    assert ben.page.is_disabled("#goal-goto")
    ben.click("#tab-drive")
    ben.click("#drive-arm")
    ben.waits_for("#toast", "held by console Anna. Take over takes it away")
    assert running.robot.did == []
    ben.click("#lease-take")
    ben.waits_for("#lease-chip", "yours")
    assert ben.page.is_enabled("#goal-goto")
    anna.waits_for("#toast", "console Ben took the lease")
    ben.close()
    anna.waits_for("#lease-chip", "free")
    assert running.robot.did[-1] == ("stop", "the lease of console Ben ended with his connection")


def test_driving_begins_with_the_velocity_in_force_and_letting_go_is_zero(open_console: Callable[..., Screen], running: Running) -> None:
    running.robot.write("drive/status", m.FVectorState(0.0, (0.3, 0.0)))
    screen = open_console()
    screen.click("#tab-drive")
    screen.waits_for("#real-v", "0.30")
    screen.page.keyboard.down("ArrowUp")
    assert running.robot.did == [], "nobody drives before he has taken the wheel"
    screen.page.keyboard.up("ArrowUp")
    screen.click("#drive-arm")
    screen.waits_for("#drive-arm", "Let go")
    screen.page.keyboard.down("ArrowUp")
    screen.page.wait_for_function("() => parseFloat(document.querySelector('#told-v').textContent) >= 0.44")
    screen.page.keyboard.up("ArrowUp")
    screen.waits_for("#told-v", "0.00")
    screen.until(lambda: running.robot.did[-1] == ("command", "motion", 30, (0.0, 0.0)))
    speeds = [entry[3][0] for entry in running.robot.did if entry[0] == "command"]  # type: ignore[index]
    assert speeds[0] == pytest.approx(0.3 + 0.12 * 0.45, abs=0.02), "it goes on from what the robot does"
    assert speeds[:-1] == sorted(speeds[:-1]) and max(speeds) <= 0.45, "half of what the robot can is the limit"


def test_the_emergency_stop_holds_until_it_is_released(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console("/?name=Anna")
    screen.click("#estop")
    screen.waits_for("#estop-note", "latched")  # a state: this robot tells of it in no event
    screen.waits_for("#causes", "console Anna pressed E-STOP")
    other = open_console()
    other.waits_for("#estop-note", "latched")
    screen.click("#release")
    for one in (screen, other):
        one.page.wait_for_selector("#release", state="hidden")
    assert [entry[0] for entry in running.robot.did] == ["estop", "release"]


def test_the_verdict_goes_with_the_wheels(open_console: Callable[..., Screen], running: Running) -> None:
    """Asked anew as soon as they do something else, not at the next turn."""
    robot = running.robot
    robot.write("ATRV2/Drive/Raw", m.ActuatorState(0.0, 0, velocity=(0.4, 0.0)))
    screen = open_console()
    screen.waits_for("#verdict", "Moving")
    screen.page.evaluate("() => { for (let i = 0; i < 10000; i++) clearInterval(i); }")

    def is_told() -> bool:
        robot.write("ATRV2/Drive/Raw", m.ActuatorState(0.0, 0))
        return screen.text("#verdict") == "Standing"

    screen.until(is_told)


def test_without_a_link_it_says_so_and_comes_back(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console()
    screen.waits_for("#pose-x", "4.00")
    assert running.link.pid is not None
    os.kill(running.link.pid, signal.SIGKILL)
    screen.waits_for("#no-link", "No link", "old")
    screen.waits_for("#verdict", "Unknown")
    screen.waits_for("#link", "ms")
    screen.page.wait_for_selector("#no-link", state="hidden")


def test_a_connection_on_which_nobody_says_hello_is_given_up(browser: Any, running: Running) -> None:
    """Something between the page and the robot takes the first connection, and never says a word."""
    tried: list[Any] = []

    def meet(socket: Any) -> None:
        tried.append(socket)
        if len(tried) > 1:
            socket.connect_to_server()

    context = browser.new_context()
    page = context.new_page()
    page.route_web_socket("**/socket", meet)
    page.goto(running.url)
    page.wait_for_function("() => document.querySelector('#link').textContent.includes('ms')", timeout=60_000)
    assert len(tried) == 2
    context.close()
    running.wait_until_nobody_is_there()


def test_a_link_that_falls_silent_says_so_before_it_is_given_up(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console()
    screen.waits_for("#verdict", "Standing")
    pid, goes_on = running.link.pid, threading.Event()
    assert pid is not None
    running.on_step = lambda: goes_on.wait() and None  # the whole computer stands still: else the gateway would be replaced
    os.kill(pid, signal.SIGSTOP)
    try:
        screen.waits_for("#link", "silent")
        screen.waits_for("#verdict", "Unknown")
        screen.waits_for("#no-link", "No link")
    finally:
        os.kill(pid, signal.SIGCONT)
        goes_on.set()
    screen.waits_for("#link", "ms")
    screen.waits_for("#verdict", "Standing")


def test_a_robot_that_hangs_is_told_though_the_link_stands(browser: Any) -> None:
    world = load_world(package_root() / "sim" / "worlds" / "yard.xml")
    one = Running(Console(Address("127.0.0.1", 0), scenery(world, load_robot_file("atrv2"), "pluto", mode="live")))
    hangs = threading.Event()
    one.on_step = lambda: hangs.wait() and None
    one.pump()
    try:
        screen = Screen(browser, one.url)
        screen.waits_for("#link", "ms")
        screen.waits_for("#causes", "The robot has not answered for")
        assert screen.text("#verdict") == "Unknown"
        screen.close()
    finally:
        hangs.set()
        one.end()


def test_a_robot_that_ends_says_so_before(browser: Any) -> None:
    world = load_world(package_root() / "sim" / "worlds" / "yard.xml")
    one = Running(Console(Address("127.0.0.1", 0), scenery(world, load_robot_file("atrv2"), "pluto", mode="live")))
    one.pump()
    screen = Screen(browser, one.url)
    screen.waits_for("#link", "ms")
    one.end()
    screen.waits_for("#no-link", "No link", "the robot's software ends")
    screen.close()


def test_what_is_too_old_is_told_with_its_age(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console()
    screen.waits_for("#pose-age", "old")
    assert "old" in screen.page.get_attribute(".readout", "class")
    screen.click("#tab-signals")
    screen.waits_for("#signals", "Localization/Pose", "old")


def test_why_is_told_with_what_would_help(open_console: Callable[..., Screen]) -> None:
    screen = open_console()
    screen.waits_for("#verdict", "Standing")
    screen.waits_for("#causes li:first-child", "sensor", "front panel pressed", "back off")


def test_modules_are_started_and_stopped(open_console: Callable[..., Screen], running: Running) -> None:
    running.robot.write("modules", m.ModulesState(0.0, (m.ModuleState("slam", "estimation", "running", 10, 0, 0, 1.5),)))
    screen = open_console()
    screen.click("#tab-modules")
    screen.waits_for("#modules", "slam", "running", "1.5 ms")
    screen.click("#modules button")
    screen.waits_for("#toast", "slam: stop ordered")
    running.robot.write("modules", m.ModulesState(0.0, (m.ModuleState("slam", "estimation", "stopped", 10, 0, 0, 1.5),)))
    screen.waits_for("#modules", "stopped")
    screen.click("#modules button")
    screen.waits_for("#toast", "slam: start ordered")
    assert running.robot.did == [("module", "slam", "stop"), ("module", "slam", "start")]


def test_a_mission_is_paused_aborted_and_another_one_started(open_console: Callable[..., Screen], running: Running) -> None:
    running.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "running"))
    screen = open_console()
    screen.click("#tab-mission")
    screen.click("[data-op=pause]")
    running.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "paused", "operator-stop"))
    screen.waits_for("#mission-state", "paused", "operator-stop")
    screen.click("[data-op=abort]")
    running.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "aborted"))
    screen.waits_for("#mission-state", "aborted")
    assert screen.page.is_disabled("[data-op=resume]")
    screen.page.select_option("#mission-choice", "trip2")
    screen.click("#mission-start")
    screen.until(lambda: len(running.robot.did) == 4)
    assert [entry[1:3] for entry in running.robot.did] == [("pause", ""), ("abort", ""), ("load", "trip2"), ("start", "")]


VISITS = """<root BTCPP_format="4" main_tree_to_execute="A"><BehaviorTree ID="A"><SubTree ID="B"/></BehaviorTree><BehaviorTree ID="B"/>
<TreeNodesModel><SubTree ID="B"><input_port name="other"/></SubTree><SubTree ID="A"><input_port name="speed_mps" type="double"
default="0.5">how fast</input_port> <input_port name="goals" type="points">where to, %s</input_port></SubTree></TreeNodesModel></root>"""


def test_a_mission_is_given_what_it_asks_for(open_console: Callable[..., Screen], running: Running) -> None:
    running.robot.documents["patrol"] = VISITS % EVIL.replace("&", "&amp;").replace("<", "&lt;")
    screen = open_console()
    screen.click("#tab-mission")
    screen.waits_for("#mission-choice", "trip2")
    assert screen.page.input_value("#mission-choice") == "" and screen.page.is_disabled("#mission-start"), "nothing is chosen by itself"
    screen.page.select_option("#mission-choice", "patrol")
    screen.waits_for("#mission-note", "goals must be given")
    names = screen.page.locator("#mission-inputs b").all_inner_texts()
    assert names == ["goals", "speed_mps"] and screen.page.is_disabled("#mission-start")
    assert EVIL in screen.text("#mission-inputs") and "speed_mps m/s" in screen.text("#mission-inputs")
    screen.page.fill("#mission-inputs input >> nth=0", "1,2;3,<4")
    screen.click("#mission-start")
    screen.until(lambda: len(running.robot.did) == 2)
    assert running.robot.did == [("mission", "load", "patrol", "", {"goals": "1,2;3,<4"}), ("mission", "start", "", "")]
    screen.page.select_option("#mission-choice", "trip2")
    screen.page.wait_for_selector("#mission-inputs", state="hidden")
    assert screen.complaints == []


def test_a_mission_that_goes_on_is_replaced_only_by_a_second_click(open_console: Callable[..., Screen], running: Running) -> None:
    running.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "running"))
    screen = open_console()
    screen.waits_for("#mission-chip", "running")
    screen.click("#tab-mission")
    screen.page.select_option("#mission-choice", "trip2")
    screen.click("#mission-start")
    screen.waits_for("#mission-start", "End patrol, start trip2")
    assert running.robot.did == []
    screen.click("#mission-start")
    screen.until(lambda: len(running.robot.did) == 3)
    assert [entry[1:3] for entry in running.robot.did] == [("load", "trip2"), ("pause", ""), ("start", "")]


def test_a_mission_that_goes_on_needs_no_lease(open_console: Callable[..., Screen], running: Running) -> None:
    """Who sent the robot somewhere holds the lease; left open it would stop the mission when he closes the page."""
    running.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "paused", "operator-stop"))
    screen = open_console()
    screen.click("#lease-take")
    screen.waits_for("#lease-chip", "yours")
    screen.click("#tab-mission")
    screen.click("[data-op=resume]")
    screen.waits_for("#lease-chip", "free")
    screen.close()
    running.wait_until_nobody_is_there()
    assert [entry[:2] for entry in running.robot.did] == [("mission", "resume")]


def test_with_people_known_by_tokens_the_page_asks_for_one(browser: Any) -> None:
    world = load_world(package_root() / "sim" / "worlds" / "yard.xml")
    one = Running(Console(Address("127.0.0.1", 0), scenery(world, load_robot_file("atrv2"), "pluto", mode="live")), whole("sesame"))
    one.pump()
    screen = Screen(browser, one.url)
    try:
        screen.click("#stop")
        screen.waits_for("#stop-note", "heard")
        assert [entry[0] for entry in one.robot.did] == ["stop"], "a stop is heard from anyone, before he has shown who he is"
        screen.page.fill("#token", "sesam")
        screen.page.keyboard.press("Enter")
        screen.waits_for("#token-note", "knows nobody with that token")
        screen.page.fill("#token", "sesame")
        screen.page.keyboard.press("Enter")
        screen.waits_for("#link", "ms")
        screen.click("#stop")
        screen.waits_for("#stop-note", "heard")
    finally:
        screen.close()
        one.end()


def test_parameters_are_set_all_or_none_and_go_back_unless_kept(open_console: Callable[..., Screen], running: Running) -> None:
    screen = open_console()
    screen.click("#tab-params")
    screen.waits_for("#params", "margin_m", "m · >= 0", "usually 0.08")
    field = screen.page.locator("#params input")
    assert field.input_value() == "0.1"
    field.fill("0.2")
    screen.waits_for("#params-note", "1 to set")
    screen.click("#params-set")
    screen.waits_for("#params-left", "goes back in")
    screen.waits_for("#toast", "Set for 30 s")  # not what was refused before
    screen.click("#params-keep")
    screen.waits_for("#toast", "Parameters kept")
    changes = [entry[1:] for entry in running.robot.did if entry[0] == "params" and entry[1] != "get"]
    assert changes == [("set", {"avoid.margin_m": "0.2"}, 30.0), ("set", {}, 0.0)]
    assert screen.complaints == []
