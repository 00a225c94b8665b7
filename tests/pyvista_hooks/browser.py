"""A headless Chromium, driven over its debugging protocol."""

import asyncio
import base64
import json
import shutil
import subprocess
import time

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
OPTIONS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=900,640",
    "--remote-debugging-port=0",
)  # fmt: skip


class Page:
    """One page of a browser; `async with Page(url, profile) as page`."""

    def __init__(self, url, profile):
        self.url, self.profile = url, profile
        self.number = 0

    async def __aenter__(self):
        import aiohttp

        self.process = subprocess.Popen(
            [CHROMIUM, *OPTIONS, f"--user-data-dir={self.profile}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        port = await self._port()
        self.session = aiohttp.ClientSession()
        async with self.session.get(f"http://127.0.0.1:{port}/json") as answer:
            pages = [tab for tab in await answer.json() if tab["type"] == "page"]
        self.socket = await self.session.ws_connect(
            pages[0]["webSocketDebuggerUrl"], max_msg_size=0
        )
        await self.call("Page.enable")
        await self.call("Page.navigate", url=self.url)
        return self

    async def __aexit__(self, *_):
        await self.socket.close()
        await self.session.close()
        self.process.terminate()
        self.process.wait(20)

    async def _port(self):
        file = self.profile / "DevToolsActivePort"
        for _ in range(200):
            if file.exists() and file.read_text().strip():
                return int(file.read_text().split()[0])
            await asyncio.sleep(0.1)
        raise TimeoutError("the browser has not started")

    async def call(self, method, **parameters):
        self.number += 1
        await self.socket.send_json({"id": self.number, "method": method, "params": parameters})
        while True:
            answer = json.loads((await self.socket.receive()).data)
            if answer.get("id") == self.number:
                return answer.get("result", answer)

    async def text(self, selector):
        code = f"document.querySelector('{selector}')?.innerText"
        found = await self.call("Runtime.evaluate", expression=code, returnByValue=True)
        return found["result"].get("value") or ""

    async def wait_for(self, selector, words, seconds=120):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if words in await self.text(selector):
                return
            await asyncio.sleep(0.2)
        raise TimeoutError(f"{selector} says {await self.text(selector)!r}, not {words!r}")

    async def screenshot(self):
        return base64.b64decode((await self.call("Page.captureScreenshot"))["data"])

    async def drag(self, start, end, steps=8):
        async def mouse(kind, place, **more):
            await self.call("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], **more)

        await mouse("mousePressed", start, button="left", clickCount=1)
        for step in range(1, steps + 1):
            place = [a + (b - a) * step / steps for a, b in zip(start, end, strict=True)]
            await mouse("mouseMoved", place, button="left", buttons=1)
            await asyncio.sleep(0.05)
        await mouse("mouseReleased", end, button="left", clickCount=1)
