# SPDX-License-Identifier: MIT
"""`dampline replay` on a port of its own, for a test."""
import pathlib
import re
import subprocess
import urllib.error
import urllib.request


def simulate(dampline, folder, *more, duration=90):
    record = pathlib.Path(folder) / "run.log"
    subprocess.run([dampline, "simulate", "--duration", str(duration), "--quiet", "--force", "--out", record, *more],
                   check=True)
    return record


class Server:
    def __init__(self, dampline, record, *options, address="127.0.0.1:0"):
        self.child = subprocess.Popen([dampline, "replay", record, "--serve", address, "--quiet", *options],
                                      stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        line = self.child.stderr.readline()
        found = re.search(r"serving (https?://.*:(\d+)/)", line)
        if not found:
            raise RuntimeError(line)
        self.url, self.port = found.group(1).replace("0.0.0.0", "127.0.0.1"), int(found.group(2))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.child.terminate()
        self.code = self.child.wait(timeout=60)
        self.error = self.child.stderr.read()
        self.child.stderr.close()

    def get(self, path, method="GET", tls=None, **headers):
        """Status, headers, body."""
        request = urllib.request.Request(self.url + path, headers=headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=20, context=tls) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def memory_kib(self):
        text = pathlib.Path(f"/proc/{self.child.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", text).group(1))
