"""A page served by trame, seen by a browser."""

import asyncio
import io
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from browser import CHROMIUM, Page

PAGE = Path(__file__).parents[2] / "examples" / "live" / "trame_page.py"

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no chromium to open the page")


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


async def visit(url, profile):
    async with Page(url, profile) as page:
        await page.wait_for("#words", "16 samples (done)")
        # The page gets the picture a little later
        await asyncio.sleep(1)
        first = await page.screenshot()
        await page.drag((400, 350), (520, 330))
        # The picture has begun anew, and is finished again
        end = asyncio.get_running_loop().time() + 30
        while "(done)" in await page.text("#words"):
            assert asyncio.get_running_loop().time() < end, "the drag changed nothing"
            await asyncio.sleep(0.05)
        await page.wait_for("#words", "16 samples (done)")
        await asyncio.sleep(1)
        return first, await page.screenshot()


@pytest.mark.slow
def test_a_served_page_shows_the_picture_and_follows_the_mouse(tmp_path):
    for module in ("trame", "trame_vtk", "trame_vuetify", "trame_pyvista", "aiohttp"):
        pytest.importorskip(module, reason="the page needs vtkmcvr[viewer]")
    from PIL import Image

    port = free_port()
    with open(tmp_path / "server.txt", "w+") as log:
        server = subprocess.Popen(
            [sys.executable, str(PAGE), "--port", str(port), "--samples", "16"],
            stdout=log, stderr=log,
        )  # fmt: skip
        try:
            wait_for_port(port, server)
            shots = asyncio.run(visit(f"http://127.0.0.1:{port}/", tmp_path / "profile"))
        finally:
            server.terminate()
            server.wait(30)
    if folder := os.environ.get("VTKMCVR_KEEP_PICTURES"):
        for number, shot in enumerate(shots):
            (Path(folder) / f"page_{number}.png").write_bytes(shot)
    first, second = (np.array(Image.open(io.BytesIO(s)).convert("RGB"), float) for s in shots)
    view = first[100:-20]
    assert (view.mean(axis=2) > 60).mean() > 0.1, "the head is not there"
    assert (view.mean(axis=2) < 5).mean() > 0.2, "the background is not there"
    assert np.abs(first - second)[100:-20].mean() > 2, "the drag turned nothing"


def wait_for_port(port, server):

    for _ in range(600):
        assert server.poll() is None, "the server has ended"
        with socket.socket() as one:
            if one.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.2)
    raise TimeoutError("the server does not answer")
