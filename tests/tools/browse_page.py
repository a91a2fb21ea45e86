"""Opens a page of `arete preview` in Chromium without a window, uses it as a person would, and prints as JSON what happened.

    browse_page.py CHROMIUM PAGE FOLDER

FOLDER gets before.png, turned.png (after a drag), divided.png (after the divider was drawn to the left; only where there is one) and
phone.png. Speaks the Chrome DevTools protocol over a WebSocket (RFC 6455) with the standard library alone.
"""
import base64
import json
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import urllib.request

DEADLINE_S = 240


class DevTools:
    def __init__(self, url):
        host, path = url.removeprefix("ws://").split("/", 1)
        name, port = host.split(":")
        self.socket = socket.create_connection((name, int(port)), timeout=DEADLINE_S)
        self.buffer, self.count, self.events = b"", 0, []
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET /{path} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n").encode())
        while b"\r\n\r\n" not in self.buffer:
            self._more()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise RuntimeError(f"no WebSocket: {head!r}")

    def _more(self):
        part = self.socket.recv(1 << 16)
        if not part:
            raise RuntimeError("the browser closed the connection")
        self.buffer += part

    def _take(self, count):
        while len(self.buffer) < count:
            self._more()
        part, self.buffer = self.buffer[:count], self.buffer[count:]
        return part

    def _send(self, text):
        data, mask = text.encode(), os.urandom(4)
        size = len(data)
        head = bytes([0x81, 0x80 | size]) if size < 126 else bytes([0x81, 0xFE]) + struct.pack(">H", size)
        self.socket.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def _receive(self):
        text = b""
        while True:
            first, second = self._take(2)
            size = second & 127
            if size >= 126:
                size = struct.unpack(">H", self._take(2))[0] if size == 126 else struct.unpack(">Q", self._take(8))[0]
            part = self._take(size)
            if first & 15 in (0, 1):
                text += part
                if first & 128:
                    return json.loads(text)

    def call(self, method, **parameters):
        self.count += 1
        self._send(json.dumps({"id": self.count, "method": method, "params": parameters}))
        while True:
            message = self._receive()
            if message.get("id") == self.count:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)

    def value(self, expression):
        return self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)["result"].get("value")


def picture(tools, path):
    # Two frames later all that was asked for is drawn.
    tools.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
    path.write_bytes(base64.b64decode(tools.call("Page.captureScreenshot", format="png")["data"]))


def drag(tools, start, end):
    mouse = lambda kind, at, buttons: tools.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button="left" if buttons or kind == "mouseReleased" else "none",
                                                 buttons=buttons, clickCount=1)
    mouse("mouseMoved", start, 0)
    mouse("mousePressed", start, 1)
    for step in range(1, 6):
        mouse("mouseMoved", [a + (b - a) * step / 5 for a, b in zip(start, end)], 1)
    mouse("mouseReleased", end, 0)


def state(tools):
    return tools.value("({...document.documentElement.dataset, title: document.title, message: document.getElementById('message').textContent,"
                       " readout: document.getElementById('readout').textContent,"
                       " labels: [0, 1].map(i => document.getElementById('label-' + i)).filter(l => !l.hidden).map(l => l.innerText),"
                       " lift: document.getElementById('lift-text').textContent, scale: document.getElementById('bar-text').textContent,"
                       " divider: document.getElementById('divider').hidden ? null : document.getElementById('divider').getAttribute('aria-valuenow')})")


def browse(tools, page, folder):
    for domain in ("Network", "Page", "Runtime"):
        tools.call(domain + ".enable")
    tools.call("Emulation.setDeviceMetricsOverride", width=1000, height=640, deviceScaleFactor=1, mobile=False)
    tools.call("Page.navigate", url=pathlib.Path(page).resolve().as_uri())
    end = time.monotonic() + DEADLINE_S
    while tools.value("document.documentElement.dataset.state") not in ("ready", "failed"):
        if time.monotonic() > end:
            raise RuntimeError("the page never became ready")
        time.sleep(0.2)
    picture(tools, folder / "before.png")
    result = {"before": state(tools)}
    if result["before"]["state"] == "ready":
        drag(tools, (400, 420), (560, 400))
        picture(tools, folder / "turned.png")
        result["turned"] = state(tools)
        tools.call("Input.dispatchMouseEvent", type="mouseWheel", x=500, y=350, deltaX=0, deltaY=-240)
        tools.call("Input.dispatchMouseEvent", type="mouseMoved", x=480, y=330)
        tools.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
        result["zoomed"] = state(tools)
        tools.value("document.getElementById('view').focus()")
        tools.call("Input.dispatchKeyEvent", type="rawKeyDown", key="n", code="KeyN", windowsVirtualKeyCode=78)
        tools.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
        result["north_up"] = state(tools)
        if result["before"]["divider"] is not None:
            drag(tools, (500, 320), (250, 320))
            picture(tools, folder / "divided.png")
            result["divided"] = state(tools)
        tools.value("document.getElementById('contours').click(), document.getElementById('reset').click()")
        picture(tools, folder / "contours.png")
        tools.call("Emulation.setDeviceMetricsOverride", width=390, height=780, deviceScaleFactor=2, mobile=True)
        tools.value("document.getElementById('reset').click()")
        picture(tools, folder / "phone.png")
    result["requests"] = [e["params"]["request"]["url"][:80] for e in tools.events if e["method"] == "Network.requestWillBeSent"]
    result["errors"] = [e["params"] for e in tools.events if e["method"] == "Runtime.exceptionThrown" or
                        (e["method"] == "Runtime.consoleAPICalled" and e["params"]["type"] == "error")]
    return result


def main():
    chromium, page, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    profile = pathlib.Path(tempfile.mkdtemp(prefix="arete-browser-"))
    browser = subprocess.Popen([chromium, "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                                "--disable-dev-shm-usage", "--no-first-run", "--disable-extensions", "--hide-scrollbars", f"--user-data-dir={profile}", "--remote-debugging-port=0",
                                "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        port, end = profile / "DevToolsActivePort", time.monotonic() + DEADLINE_S
        while not (port.exists() and len(port.read_text().split()) == 2):
            if time.monotonic() > end or browser.poll() is not None:
                raise RuntimeError("the browser did not start")
            time.sleep(0.1)
        address = f"http://127.0.0.1:{port.read_text().split()[0]}/json/list"
        targets = json.load(urllib.request.build_opener(urllib.request.ProxyHandler({})).open(address, timeout=DEADLINE_S))
        tools = DevTools(next(t["webSocketDebuggerUrl"] for t in targets if t["type"] == "page"))
        print(json.dumps(browse(tools, page, folder)))
    finally:
        browser.terminate()
        browser.wait()
        shutil.rmtree(profile, ignore_errors=True)


if __name__ == "__main__":
    main()
