#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Looks at a live run as COUNT open pages do, and as one reader that takes a byte a second, until it is
ended; then tells how much each was told.

pages.py PORT COUNT
"""
import re
import selectors
import signal
import socket
import sys
import time
import urllib.request

PORT, COUNT = int(sys.argv[1]), int(sys.argv[2])


def get(path):
    with urllib.request.urlopen(f"http://127.0.0.1:{PORT}/{path}", timeout=30) as answer:
        return answer.read()


def ask_events():
    s = socket.create_connection(("127.0.0.1", PORT))
    s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
    return s


class Page:
    """Loads what a browser loads, follows the events, and takes each new view."""

    def __init__(self):
        for path in ("", "live.css", "uplot.js", "live.js", "live.json"):
            get(path)
        self.stream = ask_events()
        self.events = self.views = 0
        self.sequence = b""

    def read(self):
        text = self.stream.recv(262144)
        if not text:
            raise EOFError("the stream ended")
        self.events += text.count(b"event: now")
        newest = re.findall(rb'"sequence":(\d+)', text)
        if newest and newest[-1] != self.sequence:
            self.sequence = newest[-1]
            self.views += 1
            get("view.json")


def main():
    stopped = []
    signal.signal(signal.SIGTERM, lambda *_: stopped.append(True))
    pages = [Page() for _ in range(COUNT)]
    slow = ask_events()
    chooser = selectors.DefaultSelector()
    for page in pages:
        chooser.register(page.stream, selectors.EVENT_READ, page)
    print("open", flush=True)
    trickle = time.monotonic()
    while not stopped:
        for key, _ in chooser.select(0.2):
            key.data.read()
        if time.monotonic() >= trickle:
            trickle += 1.0
            slow.recv(1)
    print(f"{COUNT} pages and a reader of a byte a second: {min(p.events for p in pages)} to "
          f"{max(p.events for p in pages)} events each, {min(p.views for p in pages)} to "
          f"{max(p.views for p in pages)} views")


main()
