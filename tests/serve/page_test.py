#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The live page in Chromium: it shows live.json, on a desk and on a phone, asks nobody else, counts
until the first estimate and comes back after its server has been away.

Usage: page_test.py DAMPLINE. Prints "[  SKIPPED ] why" and ends with 0 where Chromium is missing.
"""
import json
import pathlib
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
from browser import Browser, Missing, need  # noqa: E402
from server import Server, simulate  # noqa: E402

DAMPLINE = sys.argv[1]
DESK, PHONE = 1440, 390


class Address:
    def __init__(self, url):
        self.url = url

    def as_uri(self):
        return self.url


def text_of(browser, selector):
    return browser.evaluate(f"document.querySelector({json.dumps(selector)}).textContent")


def wait_for(condition, seconds=40):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError("it did not come")


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.record = simulate(DAMPLINE, cls.folder.name, "--fault", "stuck:channel=wheelset1,start_s=50,end_s=55")
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()
        cls.folder.cleanup()

    def ended(self):
        return wait_for(lambda: text_of(self.browser, "#state") == "ended" and
                        self.browser.evaluate("document.querySelectorAll('#answer .value').length > 1"))

    def test_shows_live_json_and_asks_nobody_else(self):
        with Server(DAMPLINE, self.record, "--speed", "0") as server:
            self.browser.open(Address(server.url), DESK)
            self.ended()
            live = json.loads(server.get("live.json")[2])
            wait_for(lambda: text_of(self.browser, "#headline") == live["headline"])
            shown = self.browser.evaluate(
                "[...document.querySelectorAll('#answer .value[data-name]')].map(e => ({...e.dataset}))")
            self.assertEqual([(p["name"], float(p["value"]), float(p["std"]), p["unit"]) for p in shown],
                             [(p["name"], p["value"], p["std"], p["unit"]) for p in live["parameters"]])
            self.assertEqual(self.browser.evaluate("document.querySelector('#answer').dataset.trust"), live["trust"])
            told = live["explanation"]
            self.assertEqual(self.browser.evaluate("document.querySelector('#explanation').dataset.verdict"),
                             told["verdict"])
            if told["left_over_floor"] is not None:
                self.assertIn(f"left: {told['left_over_floor']:.3g} times", text_of(self.browser, "#explanation"))
            for key in ("frames", "frames_processed", "frames_missing"):
                digits = "".join(c for c in text_of(self.browser, f"[data-count={key}]") if c.isdigit())
                self.assertEqual(int(digits), live["counts"][key])
            self.assertIn("stuck", text_of(self.browser, "#lanes"))
            plots = self.browser.evaluate("document.querySelectorAll('.live-plot .uplot canvas').length")
            self.assertEqual(plots, 7)
            drawn = self.browser.evaluate("""[...document.querySelectorAll('.plane canvas')].map(c =>
                c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some(v => v))""")
            self.assertEqual(drawn, [True] * 3)
            asked = self.browser.evaluate("performance.getEntriesByType('resource').map(e => e.name)")
            self.assertTrue(asked)
            self.assertEqual([a for a in asked if not a.startswith(server.url)], [])

    def test_fits_a_phone_and_works_by_keyboard(self):
        with Server(DAMPLINE, self.record, "--speed", "0") as server:
            self.browser.open(Address(server.url), PHONE)
            self.ended()
            self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), PHONE)
            self.assertEqual(self.browser.evaluate("""(() => {
                const plot = document.querySelector('#plot-level');
                plot.focus();
                return document.activeElement === plot; })()"""), True)
            self.browser.press("Left")
            self.browser.press("Left")
            read = wait_for(lambda: text_of(self.browser, "#plot-level .named .u-value"))
            self.assertTrue(7 < float(read) < 10, read)

    def test_counts_until_the_first_estimate(self):
        with Server(DAMPLINE, self.record, "--speed", "4") as server:
            self.browser.open(Address(server.url), DESK)
            seen = set()
            wait_for(lambda: seen.add(text_of(self.browser, "#collected")) or len(seen) > 6)
            counts = sorted(int(t.split()[1]) for t in seen if t.startswith("collecting: "))
            self.assertGreaterEqual(len(counts), 5)
            self.assertLess(counts[-1], 37)
            self.assertTrue(all(t.endswith(" of 36 s") for t in seen if t))
            wait_for(lambda: self.browser.evaluate("document.querySelector('#collecting').hidden"))
            self.assertTrue(wait_for(lambda: "Coulomb" in text_of(self.browser, "#headline")))

    def test_comes_back(self):
        with Server(DAMPLINE, self.record, "--speed", "0") as server:
            self.browser.open(Address(server.url), DESK)
            self.ended()
            address = f"127.0.0.1:{server.port}"
        wait_for(lambda: text_of(self.browser, "#state") == "lost")
        self.assertIn("lost", text_of(self.browser, "#link"))
        with Server(DAMPLINE, self.record, "--speed", "1", address=address):
            wait_for(lambda: text_of(self.browser, "#state") == "identifying")
            self.assertEqual(text_of(self.browser, "#link"), "")


if __name__ == "__main__":
    try:
        need("chromium"), need("chromedriver")
    except Missing as missing:
        print(f"[  SKIPPED ] {missing}")
        sys.exit(0)
    unittest.main(argv=sys.argv[:1], verbosity=2)
