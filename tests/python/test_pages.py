"""The pages of the command line, opened in a browser: nothing is fetched, nothing fails, everything fits and can be read."""

import html
import json
import re
import subprocess
from urllib.parse import urlencode

import fric
import numpy as np
import pyarrow
import pytest
from support import LOG, ROBOT, ROOT, SLOW_BENCH, run
from tools import hint, program

BROWSER = program("chromium")
pytestmark = pytest.mark.skipif(BROWSER is None, reason=hint(["chromium"]))

KINDS = ("replay", "discover", "excite", "calibrate", "shape", "friction", "tendon", "fleet")
# A laptop, a telephone.
WIDTHS_PX = (1280, 360)
LOOK = (ROOT / "tests" / "python" / "look.html").as_uri()


def browse(*arguments):
    command = [BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--enable-logging=stderr",
               "--host-resolver-rules=MAP * ~NOTFOUND", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def look(page, scheme, width_px):
    """What is seen of a page, and what its scripts complain of."""
    # 0 is dark, 1 light.
    setting = f"--blink-settings=preferredColorScheme={int(scheme == 'light')}"
    options = ["--allow-file-access-from-files", "--virtual-time-budget=5000", "--dump-dom", setting]
    document, complaints = browse(*options, f"{LOOK}?{urlencode({'page': page.as_uri(), 'width': width_px})}")
    seen = json.loads(html.unescape(re.search(r'<pre id="seen">(.*?)</pre>', document, re.S)[1]))
    return {**seen, "complaints": complaints}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """One page of each kind."""
    place = tmp_path_factory.mktemp("pages")
    page = {name: place / f"{name}.html" for name in KINDS}
    run("replay", LOG, "--report", page["replay"])
    run("excite", "--model", ROBOT, "-o", place / "run.csv", "--preview", page["excite"])
    bench, log = place / "bench.toml", place / "log.mcap"
    bench.write_text(SLOW_BENCH, encoding="utf-8")
    effect = ["--effect", "stribeck:ratio=1.0,velocity_m_per_s=0.03", "--duration", "24"]
    run("simulate", "--model", bench, "-o", log, *effect)
    run("discover", log, "-o", place / "found.toml", "--report", page["discover"])
    arm, pull, loads = (place / name for name in ("arm.toml", "pull.csv", "loads.csv"))
    prototype = ROOT / "examples" / "tendon-prototype.toml"
    run("continuum", "simulate", "--model", prototype, "-o", pull, "--calibration", loads)
    run("continuum", "calibrate", loads, "--model", prototype, "-o", arm, "--report", page["calibrate"])
    for name in ("shape", "friction"):
        run("continuum", name, pull, "--model", arm, "--report", page[name])
    smooth = place / "smooth.toml"
    smooth.write_text(arm.read_text(encoding="utf-8").replace("mu = 0.1753 ", "mu = 0.0 "), encoding="utf-8")
    run("discover", pull, "--model", smooth, "-o", place / "rubs.toml", "--report", page["tendon"])
    page["fleet"].write_text(fleet_page(), encoding="utf-8")
    return page


def fleet_page():
    """A fleet on which one pulley dries, and one log could not be read."""
    noise = np.random.default_rng(1)
    day = np.datetime64("2025-01-01T08", "ns") + np.arange(40) * np.timedelta64(7, "D")
    common = {"robot": "rig", "parameter": "mu", "standard_error": 1e-4}
    dries = 0.02 + 2e-4 * np.maximum(0, np.arange(40) - 20)
    rows = [{**common, "cable": "cable1", "start": int(at), "value": mu + 2e-4 * noise.normal()} for at, mu in zip(day.astype(np.int64), dries)]
    rows += [{**row, "cable": "cable2", "value": 0.02 + 2e-4 * noise.normal()} for row in rows]
    rows = [{**row, "log": f"{row['start']}.mcap", "error": None} for row in rows]
    rows.append({**common, "start": None, "value": None, "log": "broken.mcap", "error": "broken.mcap is no MCAP file"})
    found = fric.fleet.trend(pyarrow.Table.from_pylist(rows), limits={"mu": (None, 0.023)})
    assert [alarm.reason for alarm in found.alarms] == ["limit", "history"]
    return found.to_html()


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_a_page_can_be_read_by_day_and_by_night(pages, name, scheme, width_px):
    seen = look(pages[name], scheme, width_px)
    assert seen["dark"] == (scheme == "dark")
    assert seen["fetched"] == seen["complaints"] == seen["faint"] == seen["tiny"] == seen["overlaps"] == []
    assert seen["overflow_px"] <= 0 and seen["headings"] and seen["texts"] > 10
    assert seen["drawings"] and all(100 < width <= WIDTHS_PX[0] for width in seen["drawings"])


def test_the_discovery_can_be_printed(pages, tmp_path):
    paper = tmp_path / "discovery.pdf"
    browse(f"--print-to-pdf={paper}", pages["discover"].as_uri())
    assert paper.read_bytes().startswith(b"%PDF-") and paper.stat().st_size > 20_000


def test_a_bad_page_is_seen_to_be_bad(tmp_path):
    (tmp_path / "other.css").write_text("p { color: #999 }", encoding="utf-8")
    page = tmp_path / "bad.html"
    page.write_text(
        "<link rel=stylesheet href=other.css><p>faint</p><div style='width: 3000px'>wide</div><script>nobody()</script>",
        encoding="utf-8",
    )
    seen = look(page, "light", WIDTHS_PX[0])
    assert [name for name, *_ in seen["faint"]] == ["P"] and seen["overflow_px"] > 1000
    assert seen["fetched"] == [(tmp_path / "other.css").as_uri()]
    assert "nobody is not defined" in seen["complaints"][0]
