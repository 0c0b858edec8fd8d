#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A fleet of synthetic cars in a database, and how fast `dampline fleet` shows it.

Usage: fleet.py DAMPLINE [--cars 10000] [--days 365] [--bodies FILE]

Rows as `dampline collect` writes them, one truck a car and one segment a day, laden or empty; most
trucks wear slowly, some are planted: another level, a fast trend, a step ten days ago, a broken
spring, silence, faults of the data, alarms. In SQLite, and in PostgreSQL where that is installed. States
themselves are left out, unless --bodies names one, which all rows then hold.
"""
import argparse
import csv
import io
import json
import os
import pathlib
import re
import signal
import sqlite3
import subprocess
import tempfile
import time
import urllib.parse
import urllib.request

import numpy

HERE = pathlib.Path(__file__).resolve().parent
START = HERE.parent / "app/service/fleet/start"
SERVER = pathlib.Path("/usr/lib/postgresql/15/bin/initdb")
DAY_NS = 86_400_000_000_000
FIRST_NS = 1_735_689_600_000_000_000  # 2025-01-01, 0 h UTC
LOADS = {"laden": (37200.0, 8350.0, 5.26e6), "empty": (9300.0, 2940.0, 2.6e6)}
PLANTED = ("level", "trend", "change", "stiffness", "silent", "faulty", "alarmed")
COLUMNS = ("vehicle truck start_ns record seq end_ns load moving_mass_kg basis rate_hz coulomb_n coulomb_std_n "
           "stiffness_npm stiffness_std_npm trust light checksum hours usable alarms body").split()


class Fleet:
    """Cars and what was planted in which; rows day by day, as they come."""

    def __init__(self, cars, days, seed=1, body=b""):
        self.cars, self.days, self.body = cars, days, body
        self.random = numpy.random.default_rng(seed)
        each = max(1, cars // 500)
        chosen = self.random.permutation(cars)[:each * len(PLANTED)].reshape(len(PLANTED), each)
        self.planted = {name: sorted(map(int, rows)) for name, rows in zip(PLANTED, chosen)}
        normal = self.random.standard_normal
        self.level = 1 + 0.03 * normal(cars)
        self.wear = -0.01 + 0.005 * normal(cars)  # a year
        self.stiffness = 1 + 0.02 * normal(cars)
        self.step = numpy.zeros(cars)
        sign = numpy.where(self.random.random(cars) < 0.5, -1.0, 1.0)
        self.level[self.planted["level"]] += (0.35 * sign)[self.planted["level"]]
        self.wear[self.planted["trend"]] = -0.30
        self.step[self.planted["change"]] = -0.15
        self.stiffness[self.planted["stiffness"]] = 0.75

    @staticmethod
    def name(car):
        return f"31 80 {4000 + car // 1000:04d} {car % 1000:03d}-{car % 10}"

    def rows(self):
        silent, faulty, alarmed = (set(self.planted[name]) for name in PLANTED[4:])
        for day in range(self.days):
            years = (day - self.days) / 365.25
            scatter = 1 + 0.01 * self.random.standard_normal((2, self.cars))
            loads = numpy.where(self.random.random(self.cars) < 0.6, "laden", "empty")
            late = day > self.days - 11
            for car in range(self.cars):
                if car in silent and day > self.days - 20:
                    continue
                load = str(loads[car])
                mass, level, spring = LOADS[load]
                factor = self.level[car] + self.wear[car] * years + (self.step[car] if late else 0.0)
                start = FIRST_NS + day * DAY_NS + (car % 86_400) * 1_000_000_000 // 2
                coulomb = float(level * factor * scatter[0, car])
                stiffness = float(spring * self.stiffness[car] * scatter[1, car])
                bad = car in faulty and day > self.days - 4
                alarms = "coulomb_below, drift" if car in alarmed and day > self.days - 4 else ""
                yield (self.name(car), "A", start, 0, 1_080_000, start + 3_600_000_000_000, load, mass,
                       "00000000deadbeef", 300.0, coulomb, 0.004 * level, stiffness, 0.006 * spring,
                       "data_faulty" if bad else "trusted", 1, 1, 1.0, 0 if bad else 1, alarms, self.body)


def fill_sqlite(dampline, fleet, file):
    """Tables by the program itself, rows at once."""
    make_tables(dampline, file)
    with sqlite3.connect(file) as connection:
        connection.execute("pragma synchronous = off")
        connection.executemany(
            f"insert into state ({','.join(COLUMNS)}) values ({','.join('?' * len(COLUMNS))})", fleet.rows())
    renew(dampline, file)


def fill_postgresql(dampline, fleet, address):
    make_tables(dampline, address)
    copy = subprocess.Popen(
        ["psql", "-q", "-v", "ON_ERROR_STOP=1", address, "-c",
         f"copy state ({','.join(COLUMNS)}) from stdin with (format csv, force_not_null (load, alarms))"],
        stdin=subprocess.PIPE, text=True)
    writer = csv.writer(copy.stdin, lineterminator="\n")
    body = "\\x" + fleet.body.hex()
    writer.writerows((*row[:-1], body) for row in fleet.rows())
    copy.stdin.close()
    if copy.wait() != 0:
        raise RuntimeError("copy failed")
    subprocess.run(["psql", "-q", address, "-c", "analyze state"], check=True)
    renew(dampline, address)


def make_tables(dampline, database):
    with tempfile.TemporaryDirectory() as empty:
        subprocess.run([dampline, "collect", empty, "--db", database, "--quiet"], check=True)


def renew(dampline, database):
    subprocess.run([dampline, "fleet", "--db", database, "--renew", "--csv", "norm"], check=True,
                   stdout=subprocess.DEVNULL)


class Served:
    """`dampline fleet --serve` on a port of its own."""

    def __init__(self, dampline, database, address="127.0.0.1:0", *more):
        self.child = subprocess.Popen([dampline, "fleet", "--db", database, "--serve", address, *more],
                                      stderr=subprocess.PIPE, text=True)
        line = self.child.stderr.readline()
        found = re.search(r"serving (http://.*:(\d+)/)", line)
        if not found:
            raise RuntimeError(line)
        self.url, self.port = found.group(1), int(found.group(2))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.child.send_signal(signal.SIGTERM)
        self.code = self.child.wait(timeout=60)
        self.child.stderr.close()

    def get(self, path):
        with urllib.request.urlopen(self.url + path, timeout=60) as answer:
            return answer.read().decode()


def outliers(dampline, database):
    """Names by quantity, as the program finds them."""
    table = subprocess.run([dampline, "fleet", "--db", database, "--csv", "outlier"], check=True,
                           stdout=subprocess.PIPE, text=True).stdout
    found = {}
    for row in csv.DictReader(io.StringIO(table)):
        found.setdefault(row["quantity"], set()).add(row["vehicle"])
    return found


def judge(fleet, found):
    """For each planted kind: how many of it were found; and cars named that nothing was planted in."""
    named = {quantity: {fleet.name(car) for car in fleet.planted[quantity]} for quantity in PLANTED[:4]}
    hits = {quantity: (len(named[quantity] & found.get(quantity, set())), len(named[quantity])) for quantity in named}
    false = set().union(*found.values(), set()) - set().union(*named.values())
    return hits, len(false)


def measure(dampline, fleet, database, size):
    rows = []
    with Served(dampline, database) as server:
        car = "car?vehicle=" + urllib.parse.quote(fleet.name(fleet.planted["trend"][0]))
        for name, path in (("fleet page, first", ""), ("fleet page, again", ""), ("one car", car), ("list of cars", "cars"),
                           ("metrics", "metrics"), ("trend.csv", "trend.csv")):
            if name.endswith("again"):
                time.sleep(6)  # what is fresh is not read again
            begin = time.perf_counter()
            text = server.get(path)
            rows.append((name, time.perf_counter() - begin, len(text)))
        total = json.loads(server.get("fleet.json"))
    hits, false = judge(fleet, outliers(dampline, database))
    return rows, total, hits, false, size()


def report(kind, filled_s, fleet, rows, total, hits, false, size):
    print(f"\n{kind}: {total['cars']} cars, {total['segments']} segments, filled in {filled_s:.0f} s with `fleet --renew`; "
          f"{size / 1e6:.0f} MB on disk, {size / total['segments']:.0f} bytes a segment"
          + (f" with a state of {len(fleet.body)} bytes" if fleet.body else " without states") + ".\n")
    if not fleet.body:
        print(f"With a light state of 5.2 KB in each row {(size + 5.2e3 * total['segments']) / 1e9:.0f} GB, with a full one "
              f"of 190 KB {(size + 190e3 * total['segments']) / 1e12:.2f} TB.\n")
    print("| answer | s | kB |\n|--|--|--|")
    for name, seconds, characters in rows:
        print(f"| {name} | {seconds:.3f} | {characters / 1e3:.0f} |")
    text = ", ".join(f"{quantity} {found} of {planted}" for quantity, (found, planted) in hits.items())
    print(f"\nPlanted outliers found: {text}; other cars named: {false}; silent {total['trucks_silent']} of "
          f"{len(fleet.planted['silent'])}, faulty {total['trucks_faulty']} of {len(fleet.planted['faulty'])}, with "
          f"alarms {total['trucks_with_alarms']} of {len(fleet.planted['alarmed'])}.")


def folder_bytes(folder):
    return sum(f.stat().st_size for f in pathlib.Path(folder).rglob("*") if f.is_file())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("dampline", type=os.path.abspath)
    parser.add_argument("--cars", type=int, default=10_000)
    parser.add_argument("--days", type=int, default=365)
    parser.add_argument("--bodies", type=pathlib.Path)
    parser.add_argument("--inside", help=argparse.SUPPRESS)  # of `start`
    options = parser.parse_args()
    fleet = Fleet(options.cars, options.days, body=options.bodies.read_bytes() if options.bodies else b"")
    begin = time.perf_counter()
    if options.inside:
        address, reader = os.environ["DAMPLINE_DB"], os.environ["DAMPLINE_DB_READ"]
        fill_postgresql(options.dampline, fleet, address)
        filled_s = time.perf_counter() - begin

        def size():
            answer = subprocess.run(["psql", "-At", address, "-c", "select pg_database_size('dampline')"], check=True,
                                    stdout=subprocess.PIPE, text=True)
            return int(answer.stdout)

        report("PostgreSQL", filled_s, fleet, *measure(options.dampline, fleet, reader, size))
        return
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "fleet.sqlite"
        fill_sqlite(options.dampline, fleet, file)
        report("SQLite", time.perf_counter() - begin, fleet,
               *measure(options.dampline, fleet, file, lambda: folder_bytes(folder)))
    if not SERVER.exists():
        print("\nPostgreSQL: not installed.")
        return
    with tempfile.TemporaryDirectory() as folder:
        bodies = ["--bodies", options.bodies.resolve()] if options.bodies else []
        subprocess.run([START, folder, __file__, options.dampline, "--cars", str(options.cars), "--days",
                        str(options.days), *bodies, "--inside", "yes"], check=True)


if __name__ == "__main__":
    main()
