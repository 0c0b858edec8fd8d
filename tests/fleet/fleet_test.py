#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The fleet page and its metrics on the fleet of bench/fleet.py, smaller: what was planted is found, in
SQLite and in PostgreSQL alike; the page in Chromium; a server that goes and comes back.

Usage: fleet_test.py DAMPLINE. Prints "[  SKIPPED ] why" and ends with 0 where NumPy is missing.
"""
import csv
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.parse

TOP = pathlib.Path(__file__).resolve().parent.parent.parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOP / "bench"), str(TOP / "tests/report")]
try:
    import numpy  # noqa: F401
    import fleet as synthetic
except ImportError as missing:
    print(f"[  SKIPPED ] {missing}")
    sys.exit(0)
from browser import Browser, Missing  # noqa: E402

DAMPLINE = sys.argv[1]
CARS, DAYS = 80, 200
VIEWS = ("truck", "trend", "norm", "outlier")


class Address:
    def __init__(self, url):
        self.url = url

    def as_uri(self):
        return self.url


def table(database, view):
    return subprocess.run([DAMPLINE, "fleet", "--db", database, "--csv", view], check=True, stdout=subprocess.PIPE,
                          text=True).stdout


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


class FleetTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = pathlib.Path(cls.folder.name) / "fleet.sqlite"
        cls.fleet = synthetic.Fleet(CARS, DAYS)
        synthetic.fill_sqlite(DAMPLINE, cls.fleet, cls.file)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def planted(self, name):
        return self.fleet.name(self.fleet.planted[name][0])

    def test_finds_what_was_planted_and_nothing_else(self):
        hits, false = synthetic.judge(self.fleet, synthetic.outliers(DAMPLINE, self.file))
        self.assertEqual(hits, {name: (1, 1) for name in hits})
        self.assertEqual(false, 0)

    def test_calculates_as_the_views_do(self):
        told = json.loads(subprocess.run([DAMPLINE, "fleet", "--db", self.file, "--json"], check=True,
                                         stdout=subprocess.PIPE).stdout)
        for name, keys in (("norm", ("load", "quantity")), ("outlier", ("vehicle", "load", "quantity"))):
            views = {tuple(row[k] for k in keys): row for row in rows(table(self.file, name))}
            self.assertEqual(len(views), len(told[name + "s"]))
            for one in told[name + "s"]:
                view = views[tuple(one[k] for k in keys)]
                for number in ("median", "scatter", "deviations", "value", "std"):
                    if number in one:
                        self.assertAlmostEqual(one[number] / float(view[number]), 1.0, delta=1e-12)
        self.assertEqual((told["cars"], told["trucks_silent"], told["trucks_faulty"]), (CARS, 1, 1))
        self.assertEqual((told["trucks_with_alarms"], told["alarms"]), (1, {"coulomb_below": 1, "drift": 1}))

    def test_the_thresholds_stand_in_the_views(self):
        views = (TOP / "app/fleet/views.sql").read_text()
        constants = (TOP / "app/fleet/trend.hpp").read_text()
        self.assertIn("kOutlierDeviations = 4.5;", constants)
        self.assertIn("> 4.5 * sqrt", views)
        self.assertIn("kLeastTrucks = 20;", constants)
        self.assertIn("trucks >= 20", views)

    def test_serves_pages_tables_and_metrics(self):
        with synthetic.Served(DAMPLINE, self.file) as server:
            page = server.get("")
            self.assertIn(self.planted("trend"), page)
            car = server.get("car?vehicle=" + urllib.parse.quote(self.planted("stiffness")))
            self.assertIn("Outside of its fleet", car)
            self.assertIn(self.planted("alarmed"), page)
            alarmed = server.get("car?vehicle=" + urllib.parse.quote(self.planted("alarmed")))
            self.assertIn("coulomb below, drift", alarmed)
            self.assertEqual(server.get("trend.csv"), table(self.file, "trend"))
            history = rows(server.get("segment.csv?vehicle=" + urllib.parse.quote(self.planted("silent"))))
            self.assertEqual(len(history), DAYS - 19)
            self.assertIn("80 of 80", server.get("cars"))
            for path in ("segment.csv", "body.csv", "state.csv", "nothing", "car?vehicle=none", "car?vehicle='--"):
                with self.assertRaises(urllib.error.HTTPError) as refused:
                    server.get(path)
                self.assertEqual(refused.exception.code, 404)
            metrics = server.get("metrics")
        self.assertEqual(server.code, 0)
        self.assertIn("dampline_fleet_cars 80\n", metrics)
        self.assertIn('dampline_fleet_alarms{alarm="drift"} 1\n', metrics)
        self.assertIn(f'dampline_fleet_outlier_deviations{{vehicle="{self.planted("change")}"', metrics)
        if shutil.which("promtool"):
            done = subprocess.run(["promtool", "check", "metrics"], input=metrics.encode(), capture_output=True)
            self.assertEqual((done.returncode, done.stdout + done.stderr), (0, b""))

    def test_deployment_files_are_right(self):
        folder = TOP / "app/service/fleet"
        try:
            import yaml
        except ImportError:
            self.skipTest("no yaml")
        compose = yaml.safe_load((folder / "compose.yaml").read_text())
        for name, service in compose["services"].items():
            for volume in service.get("volumes", []):
                source = volume.split(":")[0]
                if source == "./spool" or source.startswith("./secrets"):
                    continue  # whoever runs it makes these
                if source.startswith("."):
                    self.assertTrue((folder / source).exists(), (name, source))
                else:
                    self.assertIn(source, compose["volumes"])
            self.assertLessEqual(set(service.get("secrets", [])), set(compose["secrets"]))
            if service["image"] == "dampline":  # flags that the program has
                verb, *words = service["command"]
                said = subprocess.run([DAMPLINE, verb, "--help"], capture_output=True, text=True).stdout
                for flag in (word for word in words if word.startswith("--")):
                    self.assertIn(flag + " ", said)
        rules = yaml.safe_load((folder / "fleet.rules.yml").read_text())
        metrics = (TOP / "app/fleet/page/metrics.cpp").read_text()
        for rule in rules["groups"][0]["rules"]:
            for metric in re.findall(r"dampline_(\w+)", rule["expr"]):
                self.assertIn(f'"{metric}"', metrics)
        if shutil.which("promtool"):
            for what in (["config", "--syntax-only", "prometheus.yml"], ["rules", "fleet.rules.yml"]):
                subprocess.run(["promtool", "check", *what], cwd=folder, check=True, stdout=subprocess.DEVNULL)

    def test_an_address_for_others_needs_a_token(self):
        done = subprocess.run([DAMPLINE, "fleet", "--db", self.file, "--serve", "0.0.0.0:0"], capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--serve-token-file", done.stderr)

    def test_writes_pages_and_tables(self):
        out = pathlib.Path(self.folder.name) / "out"
        subprocess.run([DAMPLINE, "fleet", "--db", self.file, "--out", out], check=True)
        for view in VIEWS:
            self.assertEqual((out / f"{view}.csv").read_text(), table(self.file, view))
        subprocess.run([DAMPLINE, "fleet", "--db", self.file, "--out", out, "--vehicle", self.planted("level")], check=True)
        self.assertEqual(len(rows((out / "segment.csv").read_text())), DAYS)
        again = subprocess.run([DAMPLINE, "fleet", "--db", self.file, "--out", out], capture_output=True, text=True)
        self.assertEqual((again.returncode, "--force" in again.stderr), (2, True))
        for page in ("fleet.html", "car.html"):
            self.assertNotIn("http://", (out / page).read_text().replace("http://www.w3.org", ""))

    def test_fits_a_desk_and_a_phone_and_asks_nobody_else(self):
        try:
            browser = Browser()
        except Missing as missing:
            self.skipTest(str(missing))
        with browser, synthetic.Served(DAMPLINE, self.file) as server:
            for path in ("", "cars", "car?vehicle=" + urllib.parse.quote(self.planted("trend"))):
                for width in (1200, 390):
                    browser.open(Address(server.url + path), width)
                    self.assertLessEqual(browser.evaluate("document.documentElement.scrollWidth"), width)
                    asked = browser.evaluate("performance.getEntriesByType('resource').map(e => e.name)")
                    self.assertEqual([a for a in asked if not a.startswith(server.url)], [])
            self.assertEqual(browser.evaluate("document.querySelectorAll('.panel.replaced canvas').length"), 4)
            browser.open(Address(server.url), 1200)
            browser.evaluate("document.querySelector('td a').click()")
            self.assertIn("/car?vehicle=", browser.evaluate("location.href"))

    def test_is_the_same_from_a_server_that_goes_and_comes_back(self):
        if not synthetic.SERVER.exists():
            self.skipTest("postgresql-15 is not installed")
        with tempfile.TemporaryDirectory() as folder:
            environment = dict(os.environ, DAMPLINE_PG_FSYNC="off")
            done = subprocess.run([synthetic.START, folder, __file__, DAMPLINE, "inside", folder], env=environment,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            for view in VIEWS:
                ours, theirs = rows(table(self.file, view)), rows((pathlib.Path(folder) / view).read_text())
                self.assertEqual(len(ours), len(theirs))
                for one, other in zip(ours, theirs):
                    for key, text in one.items():
                        if text != other[key]:  # sums in another order
                            self.assertAlmostEqual(float(text) / float(other[key]), 1.0, delta=1e-12)


def inside(folder):
    """Of the last test, beside a server of PostgreSQL."""
    write, read = os.environ["DAMPLINE_DB"], os.environ["DAMPLINE_DB_READ"]
    synthetic.fill_postgresql(DAMPLINE, synthetic.Fleet(CARS, DAYS), write)
    for view in VIEWS:
        (pathlib.Path(folder) / view).write_text(table(read, view))
    with synthetic.Served(DAMPLINE, read) as server:
        assert "80 cars" in server.get("")
        control = ["/usr/lib/postgresql/15/bin/pg_ctl", "-D", os.environ["DAMPLINE_PG_DATA"], "-m", "immediate", "-w"]
        if os.geteuid() == 0:
            control[:0] = ["setpriv", "--reuid", "postgres", "--regid", "postgres", "--init-groups"]
        quiet = dict(cwd="/", stdout=subprocess.DEVNULL, check=True)
        subprocess.run([*control, "stop"], **quiet)
        try:
            server.get("cars")
            raise AssertionError("answers without its database")
        except urllib.error.HTTPError as error:
            assert error.code == 503, error.code
        options = f"-c listen_addresses= -c unix_socket_directories={pathlib.Path(os.environ['DAMPLINE_PG_DATA']).parent}"
        subprocess.run([*control, "-l", "/dev/null", "-o", options, "start"], **quiet)
        assert "80 of 80" in server.get("cars")


if __name__ == "__main__":
    if sys.argv[2:3] == ["inside"]:
        inside(sys.argv[3])
    else:
        unittest.main(argv=sys.argv[:1], verbosity=2)
