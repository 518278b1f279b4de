"""The pages of the command line, opened in a browser: nothing is fetched, nothing fails, everything fits and can be read."""

import base64
import hashlib
import html
import json
import re
import subprocess
from urllib.parse import urlencode

import fric
import numpy as np
import pyarrow
import pytest
from support import HANG_S, LOG, ROBOT, ROOT, SLOW_BENCH, run
from tools import hint, program

BROWSER = program("chromium")
pytestmark = pytest.mark.skipif(BROWSER is None, reason=hint(["chromium"]))

KINDS = ("replay", "discover", "fit", "hysteresis", "info", "excite", "calibrate", "shape", "friction", "tendon", "fleet")
# Those whose charts answer over time.
ANSWERING = ("replay", "discover", "info", "friction", "tendon")
# A laptop, a telephone.
WIDTHS_PX = (1280, 360)
LOOK = (ROOT / "tests" / "python" / "look.html").as_uri()
USE = (ROOT / "tests" / "python" / "use.html").as_uri()


def browse(*arguments):
    command = [BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--enable-logging=stderr",
               "--host-resolver-rules=MAP * ~NOTFOUND", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False, timeout=HANG_S)
    assert done.returncode == 0, done.stderr
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def look(page, scheme, widths_px, with_what=LOOK):
    """What is seen of a page, in a list by widths where it is looked at, and what its scripts complain of."""
    # 0 is dark, 1 light.
    setting = f"--blink-settings=preferredColorScheme={int(scheme == 'light')}"
    options = ["--allow-file-access-from-files", "--virtual-time-budget=60000", "--dump-dom", setting]
    document, complaints = browse(*options, f"{with_what}?{urlencode({'page': page.as_uri(), 'widths': ','.join(map(str, widths_px))})}")
    seen = json.loads(html.unescape(re.search(r'<pre id="seen">(.*?)</pre>', document, re.S)[1]))
    return seen, complaints


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """One page of each kind."""
    place = tmp_path_factory.mktemp("pages")
    page = {name: place / f"{name}.html" for name in KINDS}
    run("replay", LOG, "--report", page["replay"], "--json", place / "replay.json")
    run("info", LOG, "--report", page["info"])
    crossing = place / "crossing.mcap"
    run("simulate", "--model", ROBOT, "-o", crossing, "--run", "crossing", "--duration", "20")
    run("hysteresis", crossing, "--report", page["hysteresis"])
    run("excite", "--model", ROBOT, "-o", place / "run.csv", "--preview", page["excite"])
    bench, log = place / "bench.toml", place / "log.mcap"
    bench.write_text(SLOW_BENCH, encoding="utf-8")
    effect = ["--effect", "stribeck:ratio=1.0,velocity_m_per_s=0.03", "--duration", "24"]
    run("simulate", "--model", bench, "-o", log, *effect)
    run("discover", log, "-o", place / "found.toml", "--report", page["discover"], "--json", place / "discover.json")
    run("fit", log, "-o", place / "fitted.toml", "--report", page["fit"])
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
def test_a_page_can_be_read_by_day_and_by_night(pages, name, scheme):
    looks, complaints = look(pages[name], scheme, WIDTHS_PX)
    # A frame without scripts complains that it blocks them.
    assert [line for line in complaints if "Blocked script" not in line] == []
    assert [(seen["width"], seen["isAlive"]) for seen in looks] == [(width, alive) for width in WIDTHS_PX for alive in (True, False)]
    for seen in looks:
        assert seen["dark"] == (scheme == "dark")
        assert seen["fetched"] == seen["faint"] == seen["tiny"] == seen["overlaps"] == [], seen["width"]
        assert seen["overflow_px"] <= 0 and seen["headings"] and seen["texts"] > 10
        assert seen["drawings"] or name == "fit"
        assert all(100 < width <= WIDTHS_PX[0] for width in seen["drawings"])
        # The state of each series is the last column of its table.
        assert name != "fleet" or seen["cut"] == []


def test_the_discovery_can_be_printed(pages, tmp_path):
    paper = tmp_path / "discovery.pdf"
    browse(f"--print-to-pdf={paper}", pages["discover"].as_uri())
    assert paper.read_bytes().startswith(b"%PDF-") and paper.stat().st_size > 20_000


@pytest.mark.parametrize("name", ANSWERING)
@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_charts_answer_the_mouse(pages, name, width_px):
    seen, complaints = look(pages[name], "light", [width_px], USE)
    assert complaints == []
    start, end = seen["whole"][0]
    assert all(view == [start, end] for view in seen["whole"] + seen["again"]) and end > start
    # What is read is what is drawn there.
    time_s, *values = seen["hovered"]["values"]
    assert abs(time_s - 0.5 * (start + end)) < 0.02 * (end - start)
    words = seen["hovered"]["words"].replace("−", "-")
    assert f"time {time_s:.3f} s" in words
    assert all(re.search(rf"(?<![\d.]){re.escape(f'{value:.4f}')}(?!\d)", words) for value in values if value and abs(value) > 1e-3)
    assert seen["hovered"]["moved_px"] == 0
    # What is dragged over is what all charts show then.
    zoomed = [start + share * (end - start) for share in (0.25, 0.5)]
    assert all(np.allclose(view, zoomed, atol=0.02 * (end - start)) for view in seen["zoomed"])
    assert len({tuple(view) for view in seen["zoomed"]}) == 1
    assert seen["span"].endswith(" s")
    assert np.allclose(np.subtract(seen["later"][0], seen["zoomed"][0]), 0.5 * (zoomed[1] - zoomed[0]), atol=0.02 * (end - start))
    assert all(seen["series"])
    if name in ("replay", "discover", "tendon"):
        assert seen["withoutBefore"] == [False, False, True, True]
    if name in ("replay", "info"):
        assert not any(seen["cable"][0]) and all(seen["cable"][1])
    if name == "discover":
        (from_s, to_s), view = seen["look"]["asked"], seen["look"]["seen"]
        assert view[0] <= from_s and view[1] >= to_s and view[1] - view[0] < 0.5 * (end - start)


def numbers_of(page):
    """The page without its scripts, as text, and the numbers of its charts."""
    source = page.read_text(encoding="utf-8")
    charts = json.loads(re.search(r'<script type="application/json" id="fric-plots">(.*?)</script>', source, re.S)[1])
    text = re.sub(r"<(style|script)[^>]*>.*?</\1>", "", source, flags=re.S)
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]*>", " ", text))), charts


def test_numbers_of_a_replay_agree(pages):
    """In the sentence, the tables, the charts and the JSON; the charts against the log computed anew with NumPy."""
    told = json.loads((pages["replay"].parent / "replay.json").read_text(encoding="utf-8"))
    text, charts = numbers_of(pages["replay"])
    left = [cable["after"]["rms_n"] / cable["before"]["rms_n"] for cable in told["cables"]]
    assert f"it leaves {100 * min(left):.1f} % to {100 * max(left):.1f} % of the force error" in text
    for cable, share in zip(told["cables"], left):
        row = [cable["name"], cable["samples"], cable["flagged"], f"{cable['before']['rms_n']:.4f}", f"{cable['after']['rms_n']:.4f}"]
        row += [f"{100 * share:.1f} %", f"{cable['before']['mae_n']:.4f}", f"{cable['after']['mae_n']:.4f}"]
        assert " ".join(map(str, row)) in text
    log = fric.read_log(LOG)
    result = fric.replay(fric.Robot.read(ROBOT), log)
    deviation = result.force_at_platform_n - log.reference_force_n
    errors = [plot for plot in charts["plots"] if plot["caption"].startswith("Error of the force at the platform")]
    assert len(errors) == 8
    for place, plot in enumerate(errors):
        after = plot["traces"][1]["values"]
        greatest = after["greatest"]["least"] + after["greatest"]["step"] * max(code for code in codes(after["greatest"]) if code < 65535)
        assert greatest == pytest.approx(np.nanmax(deviation[:, place]), abs=1e-9)
        assert after["least"]["least"] == pytest.approx(np.nanmin(deviation[:, place]), abs=1e-9)


def codes(coded):
    return np.frombuffer(base64.b64decode(coded["u16"]), dtype="<u2").tolist()


def test_numbers_of_a_discovery_agree(pages):
    told = json.loads((pages["discover"].parent / "discover.json").read_text(encoding="utf-8"))
    text, charts = numbers_of(pages["discover"])
    (winch,) = told["cables"]
    for number in (winch["noise_floor_n"], winch["before"]["rms_n"], winch["after"]["rms_n"]):
        assert f"{number:.4f}" in text
    closed = 100 * min(winch["gap_closed"], 1)
    assert (f"{closed:.1f} %" if 98.5 <= closed < 99.95 else f"{closed:.0f} %") in text
    assert "−0 " not in text and "which may be chance" not in text
    # Table and chart of the friction over speed are the same numbers.
    (speed,) = [plot for plot in charts["plots"] if plot["caption"].startswith("Friction over speed")]
    for value in speed["traces"][0]["values"]["y"]:
        assert value is None or f"{value:.4f}".replace("-", "−") in text


def test_a_corrected_recording_is_drawn_before_and_after(tmp_path):
    bench, log, page = (tmp_path / name for name in ("bench.toml", "late.csv", "late.html"))
    bench.write_text(SLOW_BENCH, encoding="utf-8")
    made = fric.simulate(fric.Robot.from_toml(SLOW_BENCH), seed=5, duration_s=24.0)
    # Late by five samples.
    late_n = np.concatenate([np.full(5, np.nan), made.reference_force_n[:-5, 0]])
    columns = [made.time_s, made.sensor_force_n[:, 0], made.length_m[:, 0], made.speed_m_per_s[:, 0], late_n]
    head = "time_s," + ",".join(f"winch.{key}" for key in ("force_n", "length_m", "speed_m_per_s", "reference_n"))
    np.savetxt(log, np.column_stack(columns), fmt="%.9g", delimiter=",", header=head, comments="")
    run("discover", log, "--model", bench, "--report", page)
    text, charts = numbers_of(page)
    (delay_ms,) = re.findall(r"the reference comes late by ([\d.]+) ms", text)
    assert float(delay_ms) == pytest.approx(20, abs=0.5)
    names = ["before: given model, fitted", "after: recording corrected"]
    (residual,) = [plot for plot in charts["plots"] if plot["caption"].startswith("Residual: model less reference")]
    assert [trace["name"] for trace in residual["traces"]] == names
    least, corrected = (trace["values"]["least"]["least"] for trace in residual["traces"])
    assert least < 1.3 * corrected < 0


def test_pages_say_where_they_come_from(pages):
    for name in KINDS:
        text = numbers_of(pages[name])[0] if name in ANSWERING else pages[name].read_text(encoding="utf-8")
        assert f"fric {fric.__version__}" in text
        assert str(pages[name].parent) not in text and str(ROOT) not in text
    told = json.loads((pages["replay"].parent / "replay.json").read_text(encoding="utf-8"))["provenance"]
    assert told["version"] == fric.__version__ and told["command"].startswith("fric-cli replay mini-ipanema.mcap --report replay.html")
    assert told["inputs"] == [{"role": "log", "name": "mini-ipanema.mcap", "sha256": hashlib.sha256(LOG.read_bytes()).hexdigest()}]


def test_a_bad_page_is_seen_to_be_bad(tmp_path):
    (tmp_path / "other.css").write_text("p { color: #999 }", encoding="utf-8")
    page = tmp_path / "bad.html"
    page.write_text(
        "<link rel=stylesheet href=other.css><p>faint</p><div style='width: 3000px'>wide</div><script>nobody()</script>",
        encoding="utf-8",
    )
    (seen, _), complaints = look(page, "light", WIDTHS_PX[:1])
    assert [name for name, *_ in seen["faint"]] == ["P"] and seen["overflow_px"] > 1000
    assert seen["fetched"] == [(tmp_path / "other.css").as_uri()]
    assert "nobody is not defined" in complaints[0]
