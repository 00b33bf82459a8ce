"""One HTML file that holds a recording and the viewer, and plays offline from ``file://``.

The viewer's program (wasm) comes from the installed rerun itself, so that it always fits the recording.  It
is started by an interface that rerun does not promise to keep; the version is pinned, and a test opens the
page in a browser.
"""

from __future__ import annotations

import base64
import gzip
import urllib.request
from html import escape
from pathlib import Path

from edl6dof.replay.program import HOST, free_port, running

_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:;
 style-src 'unsafe-inline'; connect-src blob: data:; img-src blob: data:; font-src data:; worker-src blob:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>@TITLE@</title>
<link rel="icon" href="data:,">
<style>
html, body { margin: 0; height: 100%; overflow: hidden; background: #0d1011; color: #cad8de; font: 16px sans-serif }
canvas { position: absolute; inset: 0; width: 100%; height: 100% }
#note { position: absolute; inset: 45% 10% auto; text-align: center }
</style>
</head>
<body>
<canvas id="view"></canvas>
<p id="note">Unpacking the replay ...</p>
<script>
// A page on its own asks nobody for anything: what the viewer would fetch from the network fails at once, quietly.
const local = window.fetch.bind(window);
const inside = what => /^(blob|data):/.test(what.url || what);
window.fetch = (what, how) => inside(what) ? local(what, how) : Promise.resolve(new Response(null, {status: 404}));
</script>
<script>@PROGRAM@</script>
<script>
async function unpack(base64) {
  const packed = await (await local("data:application/gzip;base64," + base64)).blob();
  return new Uint8Array(await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());
}
async function play() {
  await wasm_bindgen({module_or_path: await unpack("@WASM@")});
  const viewer = new wasm_bindgen.WebHandle({url: [], hide_welcome_screen: true, theme: "dark", persist: false,
    enable_history: false, notebook: false, render_backend: "webgl"});
  await viewer.start(document.getElementById("view"));
  document.getElementById("note").remove();
  viewer.open_channel("replay", "replay");
  viewer.send_rrd_to_channel("replay", await unpack("@RECORDING@"));
  document.documentElement.dataset.state = "playing";
}
play().catch(problem => {
  document.documentElement.dataset.state = "failed";
  document.getElementById("note").textContent = "This browser cannot show the replay (it needs WebGL 2 and WebAssembly): " + problem;
});
</script>
</body>
</html>
"""


def page(recording: Path, title: str) -> bytes:
    """The HTML file of a recording.

    Raises:
        ViewerFailed: the viewer's program cannot be had from the installed rerun.
    """
    script, wasm = _program()
    parts = {
        "TITLE": escape(title),
        "PROGRAM": script.replace("</script", "<\\/script"),
        "WASM": _packed(wasm),
        "RECORDING": _packed(recording.read_bytes()),
    }
    return "".join(parts[piece] if k % 2 else piece for k, piece in enumerate(_PAGE.split("@"))).encode(
        "utf-8"
    )


def _program() -> tuple[str, bytes]:
    """The viewer for browsers: its script and its wasm, asked from rerun's own server on this machine, which
    serves nothing else.
    """
    port, data = free_port(), free_port()
    with running("--serve-web", "--web-viewer-port", str(port), "--port", str(data)) as program:
        program.wait_for(port)
        script, wasm = (
            _fetch(f"http://{HOST}:{port}/{name}") for name in ("re_viewer.js", "re_viewer_bg.wasm")
        )
    return script.decode("utf-8"), wasm


def _fetch(url: str) -> bytes:
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url, timeout=30.0) as answer:
        return bytes(answer.read())


def _packed(content: bytes) -> str:
    return base64.b64encode(gzip.compress(content, 6, mtime=0)).decode("ascii")
