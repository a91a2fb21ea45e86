"""Opens a page of `arete preview` in Chromium without a window, uses it as a person would, and prints as JSON what happened.

    browse_page.py CHROMIUM PAGE FOLDER [brief] [FLAG...]

Where the page is a report that holds such a page in a frame, only that is looked at, and whether the wheel scrolls the report. FOLDER gets
before.png, and divided.png (after the divider was drawn to the left; only where there is one); and, unless it is to be brief, turned.png (after
a drag), contours.png and phone.png. FLAGs are Chromium's. Speaks the Chrome DevTools protocol over a WebSocket (RFC 6455) with the standard
library alone.
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
THE_PAGE = "(document.querySelector('iframe')?.contentDocument ?? document)"


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
    settle(tools)  # two frames later all that was asked for is drawn
    path.write_bytes(base64.b64decode(tools.call("Page.captureScreenshot", format="png")["data"]))


class Clock:
    """Hands are quick, however long a picture takes: a hundredth of a second passes between events."""
    now = time.time()

    def tick(self):
        Clock.now += 0.01
        return Clock.now


def drag(tools, start, end, button="left"):
    mask, clock = 1 if button == "left" else 2, Clock()
    mouse = lambda kind, at, buttons: tools.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button=button if buttons or kind == "mouseReleased" else "none",
                                                 buttons=buttons, clickCount=1, timestamp=clock.tick())
    mouse("mouseMoved", start, 0)
    mouse("mousePressed", start, mask)
    for step in range(1, 6) if start != end else ():
        mouse("mouseMoved", [a + (b - a) * step / 5 for a, b in zip(start, end)], mask)
    mouse("mouseReleased", end, 0)


def settle(tools):
    tools.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")


def press(tools, key, code, shift=False):
    for kind in ("rawKeyDown", "keyUp"):
        tools.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code, modifiers=8 if shift else 0)
    settle(tools)


def touch(tools, start, end):
    """Fingers from `start` to `end`, each a list of places."""
    clock = Clock()
    send = lambda kind, places: tools.call("Input.dispatchTouchEvent", type=kind, timestamp=clock.tick(), touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)])
    send("touchStart", start)
    for step in range(1, 6) if start != end else ():
        send("touchMove", [(a + (c - a) * step / 5, b + (d - b) * step / 5) for (a, b), (c, d) in zip(start, end)])
    send("touchEnd", [])
    settle(tools)


def state(tools):
    return tools.value(f"(d => ({{...d.documentElement.dataset, title: d.title, message: d.getElementById('message').textContent,"
                       " readout: d.getElementById('readout').textContent,"
                       " labels: [0, 1].map(i => d.getElementById('label-' + i)).filter(l => !l.hidden).map(l => l.innerText),"
                       " lift: d.getElementById('lift-text').textContent, scale: d.getElementById('bar-text').textContent,"
                       " accuracy: d.getElementById('accuracy').textContent, credit: d.getElementById('credit').textContent,"
                       f" divider: d.getElementById('divider').hidden ? null : d.getElementById('divider').getAttribute('aria-valuenow')}}))({THE_PAGE})")


def wheel(tools, at, by):
    tools.call("Input.dispatchMouseEvent", type="mouseWheel", x=at[0], y=at[1], deltaX=0, deltaY=by)
    settle(tools)


def browse_frame(tools):
    """The wheel over the frame: scrolls the report; after a click on the terrain, zooms."""
    tools.value("document.querySelector('iframe').scrollIntoView({block: 'center'})")
    settle(tools)
    scroll = lambda: tools.value("window.scrollY")
    middle = tools.value("(r => [r.x + r.width / 3, r.y + r.height / 2])(document.querySelector('iframe').getBoundingClientRect())")
    result, start = {}, scroll()
    wheel(tools, middle, -120)
    end = time.monotonic() + DEADLINE_S
    while scroll() == start and time.monotonic() < end:
        time.sleep(0.05)  # scrolling is smooth
    result["scrolled"] = {**state(tools), "by": scroll() - start}
    tools.value("document.querySelector('iframe').scrollIntoView({block: 'center', behavior: 'instant'})")
    settle(tools)
    drag(tools, middle, middle)
    wheel(tools, middle, -120)
    result["clicked"] = state(tools)
    return result


def use_by_hand(tools, folder):
    """Mouse, wheel and keys, then fingers on a phone."""
    result = {}
    drag(tools, (400, 420), (560, 400))
    picture(tools, folder / "turned.png")
    result["turned"] = state(tools)
    wheel(tools, (500, 350), -240)
    tools.call("Input.dispatchMouseEvent", type="mouseMoved", x=480, y=330)
    settle(tools)
    result["zoomed"] = state(tools)
    tools.value("document.getElementById('view').focus()")
    press(tools, "n", 78)
    result["north_up"] = state(tools)
    press(tools, "ArrowLeft", 37)
    press(tools, "ArrowUp", 38)
    press(tools, "ArrowUp", 38, shift=True)
    press(tools, "+", 187)
    result["keyed"] = state(tools)
    press(tools, "0", 48)
    result["keyed_back"] = state(tools)
    drag(tools, (300, 420), (300, 300), button="right")
    result["moved"] = state(tools)
    for _ in range(2):
        drag(tools, (300, 420), (300, 420))
    settle(tools)
    result["double_clicked"] = state(tools)
    tools.value("document.getElementById('contours').click(), document.getElementById('reset').click()")
    picture(tools, folder / "contours.png")
    tools.call("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
    tools.value("document.getElementById('reset').click()")
    tools.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
    picture(tools, folder / "phone.png")
    result["phone"] = state(tools)
    touch(tools, [(200, 400)], [(260, 400)])
    result["one_finger"] = state(tools)
    touch(tools, [(150, 380), (240, 380)], [(110, 380), (280, 380)])
    result["spread"] = state(tools)
    touch(tools, [(150, 380), (240, 380)], [(150, 330), (240, 330)])
    result["two_fingers"] = state(tools)
    touch(tools, [(195, 300), (195, 460)], [(115, 380), (275, 380)])
    result["twisted"] = state(tools)
    touch(tools, [(195, 400)], [(195, 400)])
    touch(tools, [(195, 400)], [(195, 400)])
    result["double_tapped"] = state(tools)
    return result


def browse(tools, page, folder, brief):
    for domain in ("Network", "Page", "Runtime"):
        tools.call(domain + ".enable")
    tools.call("Emulation.setDeviceMetricsOverride", width=1000, height=640, deviceScaleFactor=1, mobile=False)
    tools.call("Page.navigate", url=pathlib.Path(page).resolve().as_uri())
    end = time.monotonic() + DEADLINE_S
    while tools.value(f"{THE_PAGE}.documentElement.dataset.state") not in ("ready", "failed"):
        if time.monotonic() > end:
            raise RuntimeError("the page never became ready")
        time.sleep(0.2)
    picture(tools, folder / "before.png")
    result = {"before": state(tools)}
    if tools.value("document.querySelector('iframe') !== null"):
        result.update(browse_frame(tools))
    elif result["before"]["state"] == "ready":
        for name, at in (("hovered", (300, 420)), ("hovered_middle", (480, 330))):
            tools.call("Input.dispatchMouseEvent", type="mouseMoved", x=at[0], y=at[1])
            settle(tools)
            result[name] = state(tools)["readout"]
        if result["before"]["divider"] is not None:
            drag(tools, (500, 320), (250, 320))
            picture(tools, folder / "divided.png")
            result["divided"] = state(tools)
        if not brief:
            result.update(use_by_hand(tools, folder))
    result["requests"] = [e["params"]["request"]["url"][:80] for e in tools.events if e["method"] == "Network.requestWillBeSent"]
    result["errors"] = [e["params"] for e in tools.events if e["method"] == "Runtime.exceptionThrown" or
                        (e["method"] == "Runtime.consoleAPICalled" and e["params"]["type"] == "error")]
    return result


def main():
    chromium, page, folder, flags = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), sys.argv[4:]
    brief = flags[:1] == ["brief"]
    profile = pathlib.Path(tempfile.mkdtemp(prefix="arete-browser-"))
    browser = subprocess.Popen([chromium, "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                                "--disable-dev-shm-usage", "--no-first-run", "--disable-extensions", "--hide-scrollbars", f"--user-data-dir={profile}", "--remote-debugging-port=0",
                                *flags[brief:], "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        port, end = profile / "DevToolsActivePort", time.monotonic() + DEADLINE_S
        while not (port.exists() and len(port.read_text().split()) == 2):
            if time.monotonic() > end or browser.poll() is not None:
                raise RuntimeError("the browser did not start")
            time.sleep(0.1)
        address = f"http://127.0.0.1:{port.read_text().split()[0]}/json/list"
        targets = json.load(urllib.request.build_opener(urllib.request.ProxyHandler({})).open(address, timeout=DEADLINE_S))
        tools = DevTools(next(t["webSocketDebuggerUrl"] for t in targets if t["type"] == "page"))
        print(json.dumps(browse(tools, page, folder, brief)))
    finally:
        browser.terminate()
        browser.wait()
        shutil.rmtree(profile, ignore_errors=True)


if __name__ == "__main__":
    main()
