"""The page in a real browser: the distribution's Chromium, driven by Playwright."""

import shutil

import numpy as np
import pytest

from tpsim import rotation

pytest.importorskip("viser", reason="viser is not installed: pip install 'tpsim[play]'")
sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: apt install it"),
]

FLAGS = [
    "--headless",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
PATIENCE = 240.0
"""Time [s] for a browser that draws without a graphics card, on a crowded machine."""


LETS_THROUGH = "[class*='Notification'] { pointer-events: none !important; }"
"""Style of messages: one says that there is no graphics card, right over the scene."""


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def page(page):
    """Seen from above, so that the plane of the arm is that of the screen."""
    camera = page.server.initial_camera
    camera.position, camera.look_at, camera.fov = (0.3, 0.199, 2.0), (0.3, 0.2, 0.0), 0.6
    # Light without shadows: shaders are computed by the processor here.
    page.server.scene.configure_default_lights(enabled=True, cast_shadow=False)
    page.server.scene.configure_environment_map(None)
    return page


@pytest.fixture(scope="module")
def tab(browser, page):
    """One tab, for all that is done in one tab."""
    tab = open_tab(browser, page)
    yield tab
    tab.close()


@pytest.fixture
def until(wait_for):
    """Wait as long as a browser without a graphics card needs on a crowded machine."""
    return lambda condition, what: wait_for(condition, what, PATIENCE)


def open_tab(browser, page):
    # Few pixels: they are computed by the processor.
    tab = browser.new_page(viewport={"width": 860, "height": 360}, device_scale_factor=0.5)
    tab.set_default_timeout(1000 * PATIENCE)
    tab.goto(f"http://127.0.0.1:{page.server.get_port()}")
    tab.get_by_text("Start again").wait_for()
    tab.locator("canvas").first.wait_for()
    tab.add_style_tag(content=LETS_THROUGH)
    return tab


def tip(page):
    return page.session.going.episode.simulation.data.site("tip").xpos.copy()


def grip(page):
    """A point of the lower link near the tip."""
    data = page.session.going.episode.simulation.data
    return 0.85 * data.site("tip").xpos + 0.15 * data.body("lower").xpos


def pixel(tab, page, point):
    """Where a point of the world is on the screen."""
    camera = list(page.server.get_clients().values())[-1].camera
    canvas = tab.locator("canvas").first.bounding_box()
    R = rotation.from_quaternion(np.asarray(camera.wxyz))
    seen = R.T @ (np.asarray(point) - camera.position)
    scale = 0.5 * canvas["height"] / np.tan(camera.fov / 2) / seen[2]
    return (
        canvas["x"] + canvas["width"] / 2 + scale * seen[0],
        canvas["y"] + canvas["height"] / 2 + scale * seen[1],
    )


def drag(tab, page, start, way, steps=8):
    """Drag with the mouse from a point of the world, and hold there."""
    tab.mouse.move(*pixel(tab, page, start))
    tab.wait_for_timeout(100)
    tab.mouse.down()
    for share in np.linspace(0, 1, steps):
        tab.mouse.move(*pixel(tab, page, start + share * np.asarray(way)))
        tab.wait_for_timeout(60)


def weightless(tab, page, until):
    tab.get_by_role("tab", name="Teach").click()
    if page.session.mode != "teach":
        tab.get_by_text("Make the arms weightless").click()
        until(lambda: page.session.mode == "teach", "weightless arms")


def test_a_hand_follows_the_mouse_by_ten_centimetres(tab, page, until):
    weightless(tab, page, until)
    before, way = tip(page), np.array([-0.06, 0.08, 0.0])
    drag(tab, page, grip(page), way)
    until(lambda: np.linalg.norm(tip(page) - before) > 0.09, "the hand to follow")
    tab.wait_for_timeout(500)
    np.testing.assert_allclose(tip(page) - before, way, atol=0.03)
    tab.mouse.up()
    until(lambda: not page.session.pulls, "the hand to let go")


def test_a_hand_follows_its_gizmo(tab, page, until):
    weightless(tab, page, until)
    before, (gizmo,) = tip(page), page._teaching._gizmos.values()
    until(lambda: np.linalg.norm(gizmo.position - tip(page)) < 1e-3, "the gizmo to be there")
    axes = rotation.from_quaternion(gizmo.wxyz)
    # The axis of the gizmo that points back along the arm: there is room.
    drag(tab, page, before + 0.13 * axes[:, 1], 0.05 * axes[:, 1])
    until(lambda: page.session.pulls, "the gizmo to be taken")
    until(lambda: axes[:, 1] @ (tip(page) - before) > 0.03, "the hand to follow")
    tab.mouse.up()
    until(lambda: not page.session.pulls, "the hand to let go")


def test_two_tabs_see_one_world_and_a_closed_one_lets_go(browser, tab, page, until, tmp_path):
    session, other = page.session, open_tab(browser, page)
    with session.lock:
        session.perform()
    page.refresh()
    for each in (tab, other):
        each.get_by_text("Drag any part to push it").wait_for()
    before = tip(page)
    drag(other, page, grip(page), [0.0, -0.12, 0.0])
    until(lambda: session.pulls, "a hand that pushes")
    until(lambda: np.linalg.norm(tip(page) - before) > 0.005, "the arm to give way")
    other.close()
    until(lambda: not session.pulls, "the push of a closed page to end")
    picture = tmp_path / "page.png"
    tab.screenshot(path=str(picture), timeout=1000 * PATIENCE)
    assert picture.stat().st_size > 10_000
    assert page.clock.failure is None


def test_two_demonstrations_by_mouse_are_learned_and_performed(tab, page, until):
    session = page.session
    for count in (1, 2):
        weightless(tab, page, until)
        tab.get_by_role("button", name="Start a demonstration").click()
        until(lambda: session.armed, "the demonstration to wait for a hand")
        drag(tab, page, grip(page), [-0.02 * count, -0.05, 0.0], steps=12)
        until(lambda: session.recording and session.time > 0.6, "half a second of it")
        tab.mouse.up()
        until(lambda: not session.pulls, "the hand to let go")
        tab.get_by_role("button", name="Stop").click()
        tab.get_by_role("button", name="Keep it").click()
        until(lambda c=count: len(page.lessons.shown["bring"]) == c, "it to be kept")
        assert (page.shelf.folder / f"demonstrations/bring/trial-00000{count - 1}.npz").is_file()
    tab.get_by_role("tab", name="Learn").click()
    tab.get_by_role("button", name="Learn from what was shown").click()
    tab.get_by_text("from 2 demonstrations (yours)").wait_for()
    assert (session.mode, session.controller) == ("perform", "learned")


def test_a_demonstration_without_a_hand_is_explained_in_the_page(tab, page, until):
    weightless(tab, page, until)
    tab.get_by_role("button", name="Start a demonstration").click()
    until(lambda: page.session.armed, "the demonstration to wait for a hand")
    tab.get_by_role("button", name="Stop").click()
    tab.get_by_text("Nothing was recorded").wait_for()


def test_a_page_loaded_anew_has_lost_nothing(tab, page, until):
    shown, models = list(page.lessons.shown["bring"]), page.session.models
    before = page.session.going.steps
    tab.reload()
    tab.add_style_tag(content=LETS_THROUGH)
    tab.get_by_role("tab", name="Teach").click()
    tab.get_by_text(f"bring: {len(shown)} shown").wait_for()
    assert page.lessons.shown["bring"] == shown
    assert page.session.models is models
    assert page.session.going.steps > before
