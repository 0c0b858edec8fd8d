#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the picture of the live page that the README shows: a simulated laden car, replayed.

Usage: picture.py DAMPLINE OUT.png [WIDTH [dark]]
"""
import base64
import os
import pathlib
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
from browser import Browser  # noqa: E402
from server import Server, simulate  # noqa: E402

CONFIGURATION = """[car]
moving_mass_kg = 37200.0
suspension_stiffness_npm = 5.26e6
[record]
vehicle = "31 80 4567 123-4"
truck = "A"
"""
HEIGHT, SPEED, SEEN_S = 1070, 20, 9.0


class Address:
    def __init__(self, url):
        self.url = url

    def as_uri(self):
        return self.url


def main(dampline, out, width="880", theme="light"):
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        dampline, out = os.path.abspath(dampline), os.path.abspath(out)
        os.chdir(folder)  # the page names the record as it was given
        simulate(dampline, ".", duration=400)
        pathlib.Path("car.toml").write_text(CONFIGURATION)
        with Server(dampline, "run.log", "--config", "car.toml", "--speed", str(SPEED),
                    "--publish-every", "0.5") as server:
            browser.devtools("Emulation.setScrollbarsHidden", hidden=True)
            browser.open(Address(server.url), int(width), dark=theme == "dark")
            time.sleep(SEEN_S)
            shot = browser.devtools("Page.captureScreenshot", format="png", captureBeyondViewport=True,
                                    clip={"x": 0, "y": 0, "width": int(width), "height": HEIGHT, "scale": 1})
        os.chdir("/")
    pathlib.Path(out).write_bytes(base64.b64decode(shot["data"]))


if __name__ == "__main__":
    main(*sys.argv[1:])
