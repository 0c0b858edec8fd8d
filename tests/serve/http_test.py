#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What `dampline replay --serve` answers: to readers, to a crowd of them, to those who read slowly and
to those who speak no HTTP.

Usage: http_test.py DAMPLINE
"""
import http.client
import json
import pathlib
import random
import selectors
import shutil
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest

from server import Server, simulate

DAMPLINE = sys.argv[1]
SEED = 23
READERS, SLOW = 200, 50
MALFORMED = 3000


def setUpModule():
    global FOLDER, RECORD
    FOLDER = tempfile.TemporaryDirectory()
    RECORD = simulate(DAMPLINE, FOLDER.name, "--friction-scale", "0.5")


def tearDownModule():
    FOLDER.cleanup()


def wait_for(condition, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError("it did not come")


def ask_events(port):
    s = socket.create_connection(("127.0.0.1", port))
    s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
    return s


def ended(server, **how):
    live = json.loads(server.get("live.json", **how)[2])
    return live if live.get("live", {}).get("state") == "ended" else None


class Documents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server(DAMPLINE, RECORD, "--speed", "0")
        cls.live = wait_for(lambda: ended(cls.server))

    @classmethod
    def tearDownClass(cls):
        cls.server.__exit__()

    def test_are_there_with_their_types_and_the_headers_that_keep_them_to_themselves(self):
        for path, kind in (("", "text/html"), ("live.js", "text/javascript"), ("uplot.js", "text/javascript"),
                           ("live.css", "text/css"), ("live.json", "application/json"),
                           ("view.json", "application/json"), ("metrics", "text/plain; version=0.0.4"),
                           ("healthz", "text/plain")):
            status, headers, body = self.server.get(path)
            self.assertEqual(status, 200, path)
            self.assertTrue(headers["Content-Type"].startswith(kind), path)
            self.assertTrue(body, path)
            self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertIsNone(headers["Access-Control-Allow-Origin"])

    def test_are_the_result_of_identify(self):
        out = pathlib.Path(FOLDER.name) / "identified"
        subprocess.run([DAMPLINE, "identify", RECORD, "--out", out, "--no-report", "--quiet"], check=True)
        self.assertEqual(json.loads((out / "parameters.json").read_text())["parameters"], self.live["parameters"])

    def test_metrics_are_live_json(self):
        text = self.server.get("metrics")[2].decode()
        for p in self.live["parameters"]:
            line = f'dampline_parameter{{name="{p["name"]}",unit="{p["unit"]}"}} '
            found = [float(l[len(line):]) for l in text.splitlines() if l.startswith(line)]
            self.assertEqual(found, [p["value"]])

    def test_metrics_pass_promtool(self):
        if not shutil.which("promtool"):
            self.skipTest("promtool is not installed")
        text = self.server.get("metrics")[2]
        done = subprocess.run(["promtool", "check", "metrics"], input=text, capture_output=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, b"", b""))

    def test_other_paths_and_methods_are_refused(self):
        for path in ("nothing", "../etc/passwd", "%2e%2e/etc/passwd", "live.json/", "LIVE.JSON"):
            self.assertEqual(self.server.get(path)[0], 404, path)
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "BREW"):
            status, headers, _ = self.server.get("live.json", method)
            self.assertEqual((status, headers["Allow"]), (405, "GET, HEAD"), method)
        status, headers, body = self.server.get("live.json", "HEAD")
        self.assertEqual((status, body), (200, b""))
        self.assertGreater(int(headers["Content-Length"]), 1000)

    def test_a_foreign_host_is_refused(self):
        self.assertEqual(self.server.get("live.json", Host="example.org")[0], 421)
        self.assertEqual(self.server.get("live.json", Host="localhost:1")[0], 200)

    def test_everything_a_page_loads_is_small(self):
        total = sum(len(self.server.get(p)[2]) for p in ("", "live.js", "uplot.js", "live.css"))
        self.assertLess(total, 150_000)


class Token(unittest.TestCase):
    def test_is_asked_for(self):
        token = "correct.horse-battery_staple"
        file = pathlib.Path(FOLDER.name) / "token"
        file.write_text(token + "\n")
        with Server(DAMPLINE, RECORD, "--serve-token-file", file, address="0.0.0.0:0") as server:
            for path in ("", "live.json", "metrics", "events", "healthz", "nothing", "?token=", "?token=" + token[:-1],
                         "?token=" + token + "x"):
                status, headers, _ = server.get(path)
                self.assertEqual((status, headers["WWW-Authenticate"]), (401, "Bearer"), path)
            self.assertEqual(server.get("live.json", Authorization="Bearer " + token[:-1] + "x")[0], 401)
            self.assertEqual(server.get("live.json", Authorization=token)[0], 401)
            self.assertEqual(server.get("live.json", Authorization="Bearer " + token, Host="truck.example")[0], 200)
            status, headers, _ = server.get("?token=" + token)
            self.assertEqual(status, 200)
            cookie = headers["Set-Cookie"]
            self.assertIn("HttpOnly", cookie)
            self.assertEqual(server.get("live.json", Cookie=cookie.split(";")[0])[0], 200)

    def test_without_one_another_address_is_refused(self):
        done = subprocess.run([DAMPLINE, "replay", RECORD, "--serve", "0.0.0.0:0"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("token_file", done.stderr)


class ClientCertificate(unittest.TestCase):
    """Certificates as openssl makes them: an authority, a server, a reader, and those who are none."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(FOLDER.name) / "tls"
        cls.folder.mkdir()
        cls.make("authority", "basicConstraints=critical,CA:TRUE")
        cls.make("stranger", "basicConstraints=critical,CA:TRUE")
        cls.make("server", "subjectAltName=IP:127.0.0.1\nextendedKeyUsage=serverAuth", "authority")
        cls.make("reader", "extendedKeyUsage=clientAuth", "authority")
        cls.make("expired", "extendedKeyUsage=clientAuth", "authority", days="-1")
        cls.make("foreign", "extendedKeyUsage=clientAuth", "stranger")
        cls.config = cls.folder / "car.toml"  # its files lie beside it
        cls.config.write_text('[serve]\ncert_file = "server.pem"\nkey_file = "server.key"\n'
                              'client_ca_file = "authority.pem"\n')

    @classmethod
    def make(cls, name, extensions, by=None, days="30"):
        path = cls.folder / name
        run = lambda *words: subprocess.run(["openssl", *words], check=True, capture_output=True)
        (cls.folder / "extensions").write_text(extensions + "\n")
        run("req", "-new", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", f"/CN={name}",
            "-keyout", f"{path}.key", "-out", f"{path}.csr")
        signer = ["-signkey", f"{path}.key"] if by is None else [
            "-CA", cls.folder / f"{by}.pem", "-CAkey", cls.folder / f"{by}.key", "-CAcreateserial"]
        run("x509", "-req", "-in", f"{path}.csr", "-days", days, "-extfile", cls.folder / "extensions",
            "-out", f"{path}.pem", *signer)

    def tls(self, who=None):
        context = ssl.create_default_context(cafile=self.folder / "authority.pem")
        if who:
            context.load_cert_chain(self.folder / f"{who}.pem", self.folder / f"{who}.key")
        return context

    def answer(self, server, who=None, path="live.json", **headers):
        """Status; 0: the server broke the connection."""
        try:
            return server.get(path, tls=self.tls(who), Host="truck.example", **headers)[0]
        except (OSError, http.client.HTTPException):
            return 0

    def test_opens_another_address_to_its_readers_alone(self):
        with Server(DAMPLINE, RECORD, "--speed", "0", "--config", self.config, address="0.0.0.0:0") as server:
            self.assertTrue(server.url.startswith("https://"))
            for path in ("", "live.json", "view.json", "metrics", "healthz"):
                self.assertEqual(self.answer(server, "reader", path), 200, path)
                for who in (None, "foreign", "expired", "server"):
                    self.assertIn(self.answer(server, who, path), (0, 403), (who, path))
            self.assertEqual(self.answer(server), 403)  # told why, where TLS itself lets one ask
            with ssl.create_default_context(cafile=self.folder / "authority.pem").wrap_socket(
                    socket.create_connection(("127.0.0.1", server.port)), server_hostname="127.0.0.1") as s:
                s.sendall(b"GET /events HTTP/1.1\r\nHost: a\r\n\r\n")
                self.assertIn(b" 403 ", s.recv(4096).split(b"\r\n")[0] + b" ")
            with self.tls("reader").wrap_socket(socket.create_connection(("127.0.0.1", server.port)),
                                                server_hostname="127.0.0.1") as s:
                s.sendall(b"GET /events HTTP/1.1\r\nHost: a\r\n\r\n")
                heard, s_end = b"", time.monotonic() + 20
                while heard.count(b"event: now") < 3 and time.monotonic() < s_end:
                    heard += s.recv(65536)
                self.assertGreaterEqual(heard.count(b"event: now"), 3)
            with socket.create_connection(("127.0.0.1", server.port), timeout=10) as s:  # no TLS
                s.sendall(b"GET /live.json HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertNotIn(b"200 OK", s.recv(4096))
            wait_for(lambda: ended(server, tls=self.tls("reader")))
        self.assertEqual((server.code, server.error), (0, ""))

    def test_and_a_token_are_both_asked_for_where_both_are_set(self):
        (self.folder / "token").write_text("0123456789abcdef\n")
        both = self.folder / "both.toml"
        both.write_text(self.config.read_text() + 'token_file = "token"\n')
        with Server(DAMPLINE, RECORD, "--speed", "0", "--config", both, address="0.0.0.0:0") as server:
            good = {"Authorization": "Bearer 0123456789abcdef"}
            self.assertEqual(self.answer(server, "reader"), 401)
            self.assertEqual(self.answer(server, **good), 403)
            self.assertEqual(self.answer(server, "reader", **good), 200)
            wait_for(lambda: ended(server, tls=self.tls("reader"), **good))

    def test_files_that_cannot_be_used_are_named(self):
        wrong = self.folder / "wrong.toml"
        for text, expected in (('cert_file = "server.pem"', "cert_file and key_file"),
                               ('client_ca_file = "authority.pem"', "client_ca_file"),
                               ('cert_file = "server.pem"\nkey_file = "reader.key"', "server.pem"),
                               ('cert_file = "server.pem"\nkey_file = "nothing"', "nothing"),
                               ('cert_file = "server.pem"\nkey_file = "server.key"', "client_ca_file"),
                               ('cert_file = "server.pem"\nkey_file = "server.key"\nclient_ca_file = "extensions"',
                                "extensions")):
            wrong.write_text("[serve]\n" + text + "\n")
            done = subprocess.run([DAMPLINE, "replay", RECORD, "--config", wrong, "--serve", "0.0.0.0:0"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, text)
            self.assertIn("[serve]", done.stderr)
            self.assertIn(expected, done.stderr)


class Crowd(unittest.TestCase):
    def test_gets_everything_while_some_hardly_read(self):
        with Server(DAMPLINE, RECORD, "--speed", "0") as server:
            wait_for(lambda: ended(server))  # from then on the run takes no more memory
            before = server.memory_kib()
            slow = [ask_events(server.port) for _ in range(SLOW)]
            readers = [ask_events(server.port) for _ in range(READERS)]
            heard = {s: b"" for s in readers}
            chooser = selectors.DefaultSelector()
            for s in readers:
                s.setblocking(False)
                chooser.register(s, selectors.EVENT_READ)
            for s in slow + readers:
                self.addCleanup(s.close)
            end, trickle, answers = time.monotonic() + 8, time.monotonic(), []
            while time.monotonic() < end:
                for key, _ in chooser.select(0.1):
                    heard[key.fileobj] += key.fileobj.recv(65536)
                if time.monotonic() >= trickle:
                    trickle += 1
                    for s in slow:
                        self.assertEqual(len(s.recv(1)), 1)
                    start = time.monotonic()
                    self.assertEqual(server.get("healthz")[0], 200)
                    answers.append(time.monotonic() - start)
            events = sorted(text.count(b"event: now") for text in heard.values())
            print(f"events of a reader: {events[0]} to {events[-1]} in 8 s; answers within {1e3 * max(answers):.0f} ms; "
                  f"{(server.memory_kib() - before) / (READERS + SLOW):.0f} KiB a connection")
            self.assertGreaterEqual(events[0], 12)  # two a second, and the first
            self.assertLess(max(answers), 2.0)
            self.assertLess(server.memory_kib() - before, 128 * (READERS + SLOW))
        self.assertEqual((server.code, server.error), (0, ""))


class Malformed(unittest.TestCase):
    def request(self, rng):
        good = b"GET /live.json HTTP/1.1\r\nHost: localhost\r\nCookie: dampline_token=x; a=b\r\nAuthorization: Bearer x\r\n\r\n"
        kind = rng.randrange(6)
        if kind == 0:
            return rng.randbytes(rng.randrange(1, 400))
        if kind == 1:  # single bytes
            text = bytearray(good)
            for _ in range(rng.randrange(1, 8)):
                text[rng.randrange(len(text))] = rng.randrange(256)
            return bytes(text)
        if kind == 2:  # cut off
            return good[:rng.randrange(len(good))]
        if kind == 3:  # long
            return b"GET /" + b"a" * rng.randrange(40000) + b"?token=" + b"%" * rng.randrange(200) + b" HTTP/1.1\r\n\r\n"
        if kind == 4:
            return b"POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\nContent-Length: -5\r\n\r\nffffffffffffffff\r\n"
        return good[:-2] + b"".join(b"X%d: %s\r\n" % (i, rng.randbytes(20).hex().encode()) for i in range(rng.randrange(400)))

    def test_requests_end_nothing(self):
        rng = random.Random(SEED)
        with Server(DAMPLINE, RECORD, "--speed", "0") as server:
            for n in range(MALFORMED):
                with socket.create_connection(("127.0.0.1", server.port), timeout=10) as s:
                    try:
                        s.sendall(self.request(rng))
                        if n % 10 == 0:
                            s.shutdown(socket.SHUT_WR)
                            s.settimeout(0.1)  # half a request may be waited for
                            s.recv(4096)
                    except OSError:
                        pass
            self.assertEqual(server.get("healthz")[0], 200)
            wait_for(lambda: ended(server))
        self.assertEqual((server.code, server.error), (0, ""))


class Alarm(unittest.TestCase):
    def test_is_in_live_json_and_in_the_metrics(self):
        config = pathlib.Path(FOLDER.name) / "alarm.toml"
        started = pathlib.Path(FOLDER.name) / "started"
        config.write_text("[alarm]\ncoulomb_below_n = 6000.0\ncoulomb_above_n = 6000.0\nhold_s = 0.0\n"
                          f'on_alarm = ["/usr/bin/touch", "{started}"]\n')
        with Server(DAMPLINE, RECORD, "--speed", "0", "--config", config) as server:
            watched = {w["name"]: w for w in wait_for(lambda: ended(server))["watched"]}
            self.assertTrue(watched["coulomb_below"]["active"])
            self.assertFalse(watched["coulomb_above"]["active"])
            self.assertLess(watched["coulomb_below"]["value"], 6000)
            text = server.get("metrics")[2].decode()
            self.assertIn('\ndampline_alarm{name="coulomb_below"} 1\n', text)
            self.assertIn('\ndampline_alarm{name="coulomb_above"} 0\n', text)
        self.assertFalse(started.exists())  # a replay starts no program: a run directory may be anybody's


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
