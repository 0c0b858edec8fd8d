#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The report page as people meet it: on a desk, on a phone, dark, on paper, without scripts, with a
keyboard and by a screen reader's rules.

Usage: browser_test.py REPORT_PAGES DAMPLINE FOLDER CASE... Prints "[  SKIPPED ] why" and ends with 0
where a program that the case needs is missing.
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from browser import Browser, Missing, need

REPORT_PAGES, DAMPLINE, FOLDER = sys.argv[1:4]
CASES = sys.argv[4:]
FIXTURE = None
DESK, PHONE = 1440, 390
LEAST_LETTERS_PX = 12

# What is wrong with the layout, a line each: words that end at the edge or beyond it, words that are
# broken, and letters that are too small. What is folded away or hidden has no boxes.
LAYOUT = """(() => {
  const wrong = [], width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width) wrong.push("the page is wider than the screen");
  const walker = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const at = node.parentElement;
    if (at.closest("script, style, title, desc, pre") || !at.checkVisibility()) continue;
    const drawn = at.closest("svg");
    const scale = drawn ? at.getScreenCTM().b ? Math.abs(at.getScreenCTM().b) : at.getScreenCTM().a : 1;
    const letters = parseFloat(getComputedStyle(at).fontSize) * scale;
    const hidden = at.closest("thead") && getComputedStyle(at.closest("thead")).position === "absolute";
    if (hidden) continue;
    for (const found of node.data.matchAll(/\\S+/g)) {
      const range = document.createRange();
      range.setStart(node, found.index);
      range.setEnd(node, found.index + found[0].length);
      const boxes = [...range.getClientRects()].filter(b => b.width > 0);
      if (!boxes.length) continue;
      if (letters < LEAST) wrong.push(`${letters.toFixed(1)} px: ${found[0]}`);
      const long = at.closest(".long") || found[0].length > 20 || /[-\\/]/.test(found[0]);
      if (!drawn && !long && new Set(boxes.map(b => b.top)).size > 1) wrong.push("broken: " + found[0]);
      if (boxes.some(b => b.left < -0.5 || b.right > width + 0.5)) wrong.push("cut: " + found[0]);
    }
  }
  return wrong.slice(0, 20);
})()""".replace("LEAST", str(LEAST_LETTERS_PX))


class Case(unittest.TestCase):
    def setUp(self):
        self.folder, self.browser = FIXTURE
        self.pages = [self.folder / name for name in ("truck.html", "live.html", "gap/report.html")]
        self.hostile = self.folder / "hostile.html"


def setUpModule():
    """One browser, and pages of results with everything in them beside one that was identified."""
    global FIXTURE
    folder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(folder.cleanup)
    subprocess.run([REPORT_PAGES, folder.name], check=True)
    run = lambda *words: subprocess.run([DAMPLINE, *words], cwd=folder.name, check=True,
                                        stdout=subprocess.DEVNULL)
    run("simulate", "--effect", "backlash:gap_m=0.0003", "--duration", "60", "--out", "gap.log",
        "--dbc", "sensors.dbc", "--config-out", "car.toml", "--quiet")
    run("explain", "gap.log", "--config", "car.toml", "--out", "gap", "--quiet")
    FIXTURE = pathlib.Path(folder.name), unittest.enterModuleContext(Browser())


class Layout(Case):
    def test_nothing_is_cut_broken_or_too_small(self):
        for page in [*self.pages, self.hostile]:
            for width in (DESK, PHONE):
                with self.subTest(page=page.name, width=width):
                    self.browser.open(page, width)
                    self.assertEqual(self.browser.evaluate(LAYOUT), [])

    def test_a_wide_table_becomes_rows_on_a_phone(self):
        rows = """(() => { const r = [...document.querySelectorAll("table.wide tbody tr")][0];
                   return new Set([...r.children].filter(c => c.textContent).map(c => c.getBoundingClientRect().left)).size })()"""
        self.browser.open(self.pages[0], PHONE)
        self.assertEqual(self.browser.evaluate(rows), 1)
        self.browser.open(self.pages[0], DESK)
        self.assertGreater(self.browser.evaluate(rows), 2)

    def test_a_dark_screen_is_dark(self):
        for dark, most, least in ((True, 60, 0), (False, 255, 200)):
            self.browser.open(self.pages[0], DESK, dark)
            shade = self.browser.evaluate("getComputedStyle(document.body).backgroundColor")
            for part in re.findall(r"\d+", shade)[:3]:
                self.assertTrue(least <= int(part) <= most, shade)


class ScriptsOff(Case):
    def test_the_drawings_stand_and_can_be_read(self):
        for page in self.pages:
            for width in (DESK, PHONE):
                with self.subTest(page=page.name, width=width):
                    self.browser.open(page, width, scripts=False)
                    shown = self.browser.evaluate(
                        "[...document.querySelectorAll('.plot')].filter(p => p.checkVisibility()).length")
                    self.assertEqual(shown, self.browser.evaluate("document.querySelectorAll('.panel').length"))
                    self.assertEqual(self.browser.evaluate("document.querySelectorAll('.live').length"), 0)
                    self.assertFalse(self.browser.evaluate("document.querySelector('.only-live').checkVisibility()"))
                    self.assertEqual(self.browser.evaluate(LAYOUT), [])


class Paper(Case):
    def test_no_word_is_broken_and_no_heading_stands_alone(self):
        need("pdftotext")
        for page in self.pages:
            with self.subTest(page=page.name):
                self.browser.open(page, DESK)
                (self.folder / "page.pdf").write_bytes(self.browser.print())
                text = subprocess.run(["pdftotext", "-layout", "page.pdf", "-"], cwd=self.folder,
                                      check=True, capture_output=True, text=True).stdout
                words = set(re.findall(r"[a-z]{3,}", text))
                wanted = self.browser.evaluate(
                    "[...document.querySelectorAll('h1, h2, h3, p, li, dt, dd, th, td, figcaption, summary, .plot text')]"
                    ".filter(e => !e.closest('details > :not(summary), .only-live, .live, .long'))"
                    ".map(e => e.innerText ?? e.textContent).join(' ')")
                self.assertEqual(set(re.findall(r"(?<![\w])[a-z]{3,}(?![\w])", wanted)) - words, set())
                headings = self.browser.evaluate("[...document.querySelectorAll('h2, h3')].map(h => h.textContent)")
                sheets = [s for s in text.split("\f") if s.strip()]
                self.assertGreater(len(sheets), 3)
                last = [s.strip().splitlines()[-1].strip() for s in sheets]
                self.assertEqual([line for line in last if line in headings], [])


class Names(Case):
    def test_every_plot_has_a_name_and_every_id_stands_once(self):
        for page in [*self.pages, self.hostile]:
            for scripts in (True, False):
                with self.subTest(page=page.name, scripts=scripts):
                    self.browser.open(page, DESK, scripts=scripts)
                    ids = self.browser.evaluate("[...document.querySelectorAll('[id]')].map(e => e.id)")
                    self.assertEqual(len(ids), len(set(ids)))
                    shown = "[...document.querySelectorAll('[role=img], .live')].filter(e => e.checkVisibility())"
                    plots = self.browser.evaluate("document.querySelectorAll('.panel').length")
                    self.assertEqual(self.browser.evaluate(shown + ".length"), plots)
                    for name, text in self.browser.evaluate(
                            shown + ".map(e => [e.getAttribute('aria-label'), document.getElementById("
                            "e.getAttribute('aria-describedby')).textContent])"):
                        self.assertGreater(len(name), 10)
                        self.assertGreater(len(text), 30)


class Plots(Case):
    PLOT = "document.querySelectorAll('.panel')[0]"

    def range_of(self, axis):
        return self.browser.run(f"const s = {self.PLOT}.plot.scales.{axis}; return [s.min, s.max]")

    def test_every_drawing_is_replaced_and_drawn(self):
        inked = """return [...document.querySelectorAll('.panel')].map(p => {
          const c = p.querySelector('canvas');
          if (!c || !p.plot || p.querySelector('.plot').checkVisibility()) return 0;
          const colours = new Set(), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
          for (let i = 0; i < d.length; i += 4) if (d[i + 3] > 60) colours.add((d[i] >> 5) + ',' + (d[i + 1] >> 5) + ',' + (d[i + 2] >> 5));
          return colours.size; })"""
        for page in [*self.pages, self.hostile]:
            for width, dark in ((DESK, False), (PHONE, True)):
                with self.subTest(page=page.name, width=width):
                    self.browser.open(page, width, dark)
                    self.browser.run_async("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
                    for colours in self.browser.run(inked):
                        self.assertGreaterEqual(colours, 2)

    def test_dragging_enlarges_and_a_double_click_shows_all(self):
        self.browser.open(self.pages[0], DESK)
        x, y = self.range_of("x"), self.range_of("y")
        self.browser.drag(self.PLOT + ".plot.over", (0.25, 0.2), (0.5, 0.6))
        for name, share, whole in (("x", 0.25, x), ("y", 0.4, y)):
            low, high = self.range_of(name)
            self.assertAlmostEqual((high - low) / (whole[1] - whole[0]), share, delta=0.02)
        self.browser.double_click(self.PLOT + ".plot.over")
        self.browser.run_async("requestAnimationFrame(arguments[0])")
        self.assertEqual((self.range_of("x"), self.range_of("y")), (x, y))

    def test_keys_read_values_and_enlarge(self):
        self.browser.open(self.pages[0], DESK)
        x = self.range_of("x")
        self.browser.run(self.PLOT + ".querySelector('.live').focus()")
        self.browser.press(*["Right"] * 12)
        legend = self.browser.run(self.PLOT + ".querySelectorAll('.u-series').length && "
                                  "0; return [..." + self.PLOT + ".querySelectorAll('.u-series')].map("
                                  "r => [r.querySelector('.u-label').textContent, r.querySelector('.u-value').textContent])")
        values = dict(legend)
        self.assertGreater(float(values["relative velocity v (mm/s)"]), 10.0)
        self.assertAlmostEqual(float(values["damping force"]), 8.3, delta=0.15)  # kN, of the fake result
        self.browser.press("+")
        low, high = self.range_of("x")
        self.assertAlmostEqual((x[1] - x[0]) / (high - low), 1.5, delta=0.01)
        self.browser.press("0")
        self.assertEqual(self.range_of("x"), x)

    def test_logarithmic_axes_have_round_numbers(self):
        self.browser.open(self.pages[1], DESK)
        axes = self.browser.run(
            "return [...document.querySelectorAll('.panel')].flatMap(p => p.plot.axes.map(a => [p.plot, a]))"
            ".filter(([u, a]) => u.scales[a.scale].distr === 3)"
            ".map(([u, a]) => [u.scales[a.scale].min, u.scales[a.scale].max, a._splits, a._values])")
        self.assertGreaterEqual(len(axes), 3)  # samples, lateness, frames
        digits = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
        for low, high, places, texts in axes:
            self.assertGreaterEqual(len(places), 2)
            for place, text in zip(places, texts):
                self.assertTrue(low <= place <= high)
                power = re.fullmatch("10([⁰-⁹¹²³⁻]+)", text)
                self.assertAlmostEqual(float("1e" + power.group(1).translate(digits)) if power else float(text), place)
                self.assertIn(f"{place:e}"[0], "125")

    def test_two_fingers_enlarge(self):
        self.browser.open(self.pages[0], PHONE)
        x = self.range_of("x")
        box = self.browser.run(f"const e = {self.PLOT}.plot.over; e.scrollIntoView({{block: 'center'}});"
                               "const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]")
        fingers = lambda apart: [{"x": box[0] - apart, "y": box[1], "id": 0}, {"x": box[0] + apart, "y": box[1], "id": 1}]
        self.browser.devtools("Input.dispatchTouchEvent", type="touchStart", touchPoints=fingers(30))
        for apart in (40, 50, 60):
            self.browser.devtools("Input.dispatchTouchEvent", type="touchMove", touchPoints=fingers(apart))
        self.browser.devtools("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        low, high = self.range_of("x")
        self.assertAlmostEqual((x[1] - x[0]) / (high - low), 2.0, delta=0.2)


class Policy(Case):
    def test_names_are_text_and_nothing_else_runs_or_is_fetched(self):
        for page in [*self.pages, self.hostile]:
            with self.subTest(page=page.name):
                self.browser.open(page, DESK)
                self.assertIsNone(self.browser.run("return window.pwned"))
                self.assertEqual(self.browser.run("return performance.getEntriesByType('resource').length"), 0)
                # Even a script that stood in the page would not run.
                self.browser.run("const s = document.createElement('script'); s.text = 'window.pwned = 2';"
                                 "document.body.append(s)")
                self.browser.run("const d = document.createElement('div'); d.innerHTML = "
                                 "'<b onclick=\"window.pwned = 3\">b</b>'; document.body.append(d); d.firstChild.click()")
                self.assertIsNone(self.browser.run("return window.pwned"))


class Axe(Case):
    VERSION = "4.14.1"

    def axe(self):
        script = pathlib.Path(FOLDER, "node_modules/axe-core/axe.min.js")
        if not script.exists():
            got = subprocess.run([need("npm"), "install", "--no-audit", "--no-fund", "--ignore-scripts",
                                  "--prefix", FOLDER, f"axe-core@{self.VERSION}"],
                                 capture_output=True, text=True, timeout=120)
            if got.returncode != 0 or not script.exists():
                raise Missing(f"npm could not get axe-core {self.VERSION}")
        return script.read_text()

    def test_axe_finds_nothing(self):
        axe = self.axe()
        _, live, gap = self.pages
        for pages, width, dark, scripts in (([*self.pages, self.hostile], DESK, False, True),
                                            ([live, gap], PHONE, True, True), ([live], PHONE, False, False)):
            for page in pages:
                with self.subTest(page=page.name, width=width, dark=dark, scripts=scripts):
                    self.browser.open(page, width, dark, scripts)
                    if not scripts:  # as the page was drawn without them
                        self.browser.devtools("Emulation.setScriptExecutionDisabled", value=False)
                    self.browser.run(axe + "; window.axe = axe")
                    found = self.browser.run_async(
                        "axe.run(document, {resultTypes: ['violations']}).then(r => arguments[0]("
                        "r.violations.map(v => v.id + ': ' + v.nodes.map(n => n.target + ' ' + n.failureSummary)"
                        ".slice(0, 3).join('; '))))")
                    self.assertEqual(found, [])


if __name__ == "__main__":
    suite = unittest.TestSuite(unittest.defaultTestLoader.loadTestsFromTestCase(globals()[case])
                               for case in CASES)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    missing = [text for _, text in result.errors if "browser.Missing" in text]
    if missing and len(missing) == len(result.errors) and not result.failures:
        print("[  SKIPPED ] " + missing[0].strip().splitlines()[-1].split(": ", 1)[-1])
        sys.exit(0)
    sys.exit(0 if result.wasSuccessful() else 1)
