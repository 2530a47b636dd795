#!/usr/bin/python3
"""Opens the pages of impinge-report in a headless Chromium as a reader does: plays, scrubs, colours, zooms, on a phone.

Usage: page_test.py BIN_DIRECTORY [unittest options]. Needs chromium-driver and python3-selenium (jobs/install.sh --tools).
page_test.py BIN_DIRECTORY --pictures FOLDER DIR... saves the pages of the runs DIR as pictures instead."""

import base64
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import Select, WebDriverWait

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
PHONE = (390, 844)
SECONDS = 5  # in which a page is drawn
CASES = {
    "plane": ("input/dam-break/dam-break.toml", "particles.spacing=0.03", "time.end=0.2"),
    "space": ("input/hydrostatic-3d.toml", "output.interval=0.01", "time.end=0.05"),
}


def browser(width, height, is_phone=False):
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                 f"--window-size={width},{height}"):
        options.add_argument(word)
    if is_phone:
        metrics = {"width": width, "height": height, "pixelRatio": 2, "touch": True}
        options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def write_page(directory):
    done = subprocess.run([BIN / "impinge-report", directory], capture_output=True, text=True, timeout=300, check=True)
    return pathlib.Path(done.stdout.split()[1]).resolve()


def picture(driver, path):
    """The whole page as a picture."""
    width, height = driver.execute_script("return [innerWidth, document.documentElement.scrollHeight]")
    area = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
    shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": area})
    pathlib.Path(path).write_bytes(base64.b64decode(shot["data"]))


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.pages = {}
        for name, (case, *settings) in CASES.items():
            directory = pathlib.Path(temporary.name) / name
            words = [word for setting in (*settings, f"output.directory={directory}") for word in ("--set", setting)]
            subprocess.run([BIN / "impinge", ROOT / case, *words], capture_output=True, timeout=300, check=True)
            cls.pages[name] = write_page(directory)

    def open(self, name, size=(1280, 800), is_phone=False):
        self.driver = browser(*size, is_phone)
        self.addCleanup(self.driver.quit)
        begin = time.monotonic()
        self.driver.get(f"file://{self.pages[name]}")
        self.image()
        self.assertLess(time.monotonic() - begin, SECONDS)

    def tearDown(self):
        self.assertEqual(self.driver.get_log("browser"), [])
        self.assertEqual(self.script("return performance.getEntriesByType('resource').filter(e => !e.name.startsWith('data:')).length"), 0)

    def script(self, text):
        return self.driver.execute_script(text)

    def image(self):
        return self.script("return renderer.domElement.toDataURL()")

    def find(self, name):
        return self.driver.find_element(By.ID, name)

    def coloured(self):
        """The share of the picture that is neither white nor grey."""
        return self.script("""
            const canvas = document.createElement("canvas"), from = renderer.domElement;
            canvas.width = from.width; canvas.height = from.height;
            const context = canvas.getContext("2d");
            context.drawImage(from, 0, 0);
            const data = context.getImageData(0, 0, from.width, from.height).data;
            let count = 0;
            for (let k = 0; k < data.length; k += 4)
              count += Math.max(data[k], data[k + 1], data[k + 2]) - Math.min(data[k], data[k + 1], data[k + 2]) > 30;
            return count / (from.width * from.height);""")

    def test_plays_and_scrubs(self):
        for name in CASES:
            with self.subTest(name):
                self.open(name)
                self.assertGreater(self.coloured(), 0.05)
                count = self.script("return run.times.length")
                self.assertEqual(self.script("return current"), count - 1)
                self.script("element('scrub').value = 1; element('scrub').dispatchEvent(new Event('input'))")
                first = self.image()
                self.assertEqual(self.find("clock").text, self.script("return `t = ${run.times[1].toFixed(3)} s, step ${run.steps[1]}`"))
                self.find("play").click()
                WebDriverWait(self.driver, 10).until(lambda driver: driver.execute_script("return current") >= 3)
                self.find("play").click()
                self.assertNotEqual(self.image(), first)
                stopped = self.script("return current")
                time.sleep(0.3)
                self.assertEqual(self.script("return current"), stopped)

    def test_colours(self):
        self.open("plane")
        seen = {}
        for name, legend in (("pressure", "Pa"), ("speed", "m/s"), ("rank", "0")):
            Select(self.find("colour")).select_by_value(name)
            self.assertIn(legend, self.find("scale").text)
            seen[name] = self.image()
        self.assertEqual(len(set(seen.values())), 3)
        self.find("walls").click()
        self.assertNotEqual(self.image(), seen["rank"])

    def test_moves_and_zooms_the_flow(self):
        for name in CASES:
            with self.subTest(name):
                self.open(name)
                canvas, start = self.driver.find_element(By.CSS_SELECTOR, "#view canvas"), self.image()
                ActionChains(self.driver).drag_and_drop_by_offset(canvas, 60, 40).perform()
                moved = self.image()
                self.assertNotEqual(moved, start)
                near = "return camera.isPerspectiveCamera ? 1 / camera.position.distanceTo(controls.target) : camera.zoom"
                before = self.script(near)
                ActionChains(self.driver).move_to_element(canvas).click().perform()
                self.script("renderer.domElement.dispatchEvent(new WheelEvent('wheel', {deltaY: -100, cancelable: true}))")
                self.assertGreater(self.script(near), before)
                self.find("reset").click()
                self.assertEqual(self.image(), start)

    def test_tells_the_value_at_the_pointer(self):
        self.open("plane")
        canvas = self.driver.find_element(By.CSS_SELECTOR, "#view canvas")
        ActionChains(self.driver).move_to_element_with_offset(canvas, -canvas.size["width"] // 4, canvas.size["height"] // 2 - 60).perform()
        self.assertRegex(self.find("value").text, r"^x = 0\.\d+, y = 0\.\d+ m: \d+(\.\d+)? Pa$")

    def test_zooms_the_curves(self):
        self.open("plane")
        plots = self.driver.find_elements(By.CSS_SELECTOR, ".plot")
        self.assertEqual(len(plots), self.script("return run.charts.length"))
        whole = self.script("return overTime.map(chart => chart.graph.xAxisRange())")
        self.script("document.querySelector('.plot').scrollIntoView({block: 'center'})")
        ActionChains(self.driver).move_to_element_with_offset(plots[0], -50, 0).click_and_hold().move_by_offset(120, 0).release().perform()
        for before, after in zip(whole, self.script("return overTime.map(chart => chart.graph.xAxisRange())")):
            self.assertLess(after[1] - after[0], 0.5 * (before[1] - before[0]))
        ActionChains(self.driver).move_to_element(plots[0]).perform()
        self.assertRegex(self.driver.find_element(By.CSS_SELECTOR, ".legend").text, r"\d")
        ActionChains(self.driver).move_to_element(plots[0]).double_click().perform()
        self.assertEqual(self.script("return overTime[0].graph.xAxisRange()"), whole[0])
        ActionChains(self.driver).move_to_element_with_offset(plots[0], -100, 0).click().perform()
        self.assertLess(self.script("return current"), self.script("return run.times.length - 1"))

    def test_fits_a_phone(self):
        for name in CASES:
            with self.subTest(name):
                self.open(name, PHONE, is_phone=True)
                self.assertLessEqual(self.script("return document.documentElement.scrollWidth"), PHONE[0])
                self.assertGreater(self.coloured(), 0.05)
                for item in ("play", "scrub", "colour", "reset"):
                    self.assertGreaterEqual(self.find(item).size["height"], 28)
                small = "return [...document.querySelectorAll('body *')].filter(e => e.offsetParent && parseFloat(getComputedStyle(e).fontSize) < 11.5).length"
                self.assertEqual(self.script(small), 0)


def save_pictures(folder, *directories):
    for size, is_phone, ending in (((1280, 800), False, ""), (PHONE, True, "_phone")):
        driver = browser(*size, is_phone)
        for directory in directories:
            page = write_page(directory)
            driver.get(f"file://{page}")
            driver.execute_script("show(Math.floor(0.7 * run.times.length))")
            picture(driver, pathlib.Path(folder) / f"{page.stem}{ending}.png")
        driver.quit()


if __name__ == "__main__":
    if sys.argv[1:2] == ["--pictures"]:
        save_pictures(*sys.argv[2:])
    else:
        unittest.main()
