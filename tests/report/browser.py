# SPDX-License-Identifier: MIT
"""Chromium through chromedriver's WebDriver protocol, with nothing but the standard library."""
import base64
import json
import re
import shutil
import subprocess
import urllib.error
import urllib.request


class Missing(Exception):
    """A program that is not installed, or a package that cannot be had."""


def need(program):
    if shutil.which(program) is None:
        raise Missing(f"{program} is not installed")
    return program


class Browser:
    def __init__(self):
        need("chromium")
        self.driver = subprocess.Popen([need("chromedriver"), "--port=0"], stdout=subprocess.PIPE,
                                       stderr=subprocess.DEVNULL, text=True)
        port = None
        while port is None:
            line = self.driver.stdout.readline()
            if not line:
                raise RuntimeError("chromedriver ended")
            found = re.search(r"successfully on port (\d+)", line)
            port = found and found.group(1)
        self.address = f"http://127.0.0.1:{port}"
        options = {"args": ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]}
        self.session = self.call("/session", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options}}}, "")["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            urllib.request.urlopen(urllib.request.Request(
                f"{self.address}/session/{self.session}", method="DELETE"), timeout=30)
        finally:
            self.driver.terminate()
            self.driver.wait()

    def call(self, path, body, prefix=None):
        prefix = f"/session/{self.session}" if prefix is None else prefix
        request = urllib.request.Request(self.address + prefix + path, data=json.dumps(body).encode(),
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def devtools(self, command, **parameters):
        return self.call("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def run(self, script, *arguments):
        return self.call("/execute/sync", {"script": script, "args": list(arguments)})

    def run_async(self, script, *arguments):
        return self.call("/execute/async", {"script": script, "args": list(arguments)})

    def open(self, page, width, dark=False, scripts=True):
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=900,
                      deviceScaleFactor=1, mobile=width < 600)
        self.devtools("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.devtools("Emulation.setScriptExecutionDisabled", value=not scripts)
        self.call("/url", {"url": page.as_uri()})

    def evaluate(self, expression):
        """As run(), also where the page's own scripts are off."""
        found = self.devtools("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"])
        return found["result"].get("value")

    def print(self):
        return base64.b64decode(self.call("/print", {"page": {"width": 21.0, "height": 29.7}}))

    def drag(self, element_script, start, end):
        """The mouse from one share of an element's box to another."""
        box = self.run(f"const e = {element_script}; e.scrollIntoView({{block: 'center'}});"
                       "const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]")
        x, y, w, h = box
        at = lambda share: {"x": round(x + share[0] * w), "y": round(y + share[1] * h)}
        move = lambda share: {"type": "pointerMove", "duration": 50, **at(share)}
        self.call("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            move(start), {"type": "pointerDown", "button": 0}, move(end),
            {"type": "pointerUp", "button": 0}]}]})

    def double_click(self, element_script):
        self.run(f"const e = {element_script}; e.dispatchEvent(new MouseEvent('dblclick', {{bubbles: true}}))")

    def press(self, *keys):
        codes = {"Left": "\ue012", "Right": "\ue014"}
        actions = [a for k in keys for a in ({"type": "keyDown", "value": codes.get(k, k)},
                                             {"type": "keyUp", "value": codes.get(k, k)})]
        self.call("/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})
