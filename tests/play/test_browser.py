"""The page in a real browser: the distribution's Chromium, driven by Playwright."""

import shutil

import pytest

pytest.importorskip("viser", reason="viser is not installed: pip install 'tpsim[play]'")
sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: apt install it")

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
PATIENCE = 120.0
"""Time [s] for a browser that draws without a graphics card, on a crowded machine."""


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
