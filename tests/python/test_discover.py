"""Discovery from Python and by the command line: the same numbers; and its figures."""

import json
import math
import re
from typing import get_args, get_type_hints

import fric
import numpy as np
import pytest
from matplotlib import pyplot
from fric._results.replay import Fault
from support import PRESS_SOON, ROBOT, ROOT, SLOW_BENCH, printed, run, without_origin

HIDDEN = {"kind": "stribeck", "ratio": 1.0, "velocity_m_per_s": 0.03}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A bench and logs of it with an effect that its file does not have."""
    place = tmp_path_factory.mktemp("discover")
    (place / "robot.toml").write_text(SLOW_BENCH, encoding="utf-8")
    effect = ["--effect", "stribeck:ratio=1.0,velocity_m_per_s=0.03"]
    for name in ("hidden", "again"):
        options = [*effect, "--duration", "24", "--seed", str(len(name))]
        run("simulate", "--model", place / "robot.toml", "-o", place / f"{name}.mcap", *options)
    return place


@pytest.fixture(scope="module")
def log(place, robot):
    return fric.read_log(place / "hidden.mcap", robot)


@pytest.fixture(scope="module")
def result(robot, log):
    return fric.discover(robot, log)


def by_command_line(place, *logs):
    files = [place / name for name in ("found.json", "extended.toml")]
    logs = [place / log for log in logs]
    run("discover", *logs, "--model", place / "robot.toml", "-o", files[1], "--json", files[0], "--force")
    return [file.read_text(encoding="utf-8") for file in files]


def told(cable):
    """All of a cable's attributes as the result for machines has them."""
    attributes = {name: getattr(cable, name) for name in dir(cable) if not name.startswith("_")}
    for name in ("time_s", "residual_before_n", "residual_after_n", "where_in_words"):
        del attributes[name]
    # These keys are absent where the logs share all values, and where nothing is at the end of its range or undetermined.
    for name in ("per_log", "at_bound", "undetermined", "revised"):
        if not attributes[name]:
            del attributes[name]
    for name in ("before", "after"):
        error = attributes[name]
        attributes[name] = error and {"rms_n": error.rms_n, "mae_n": error.mae_n}
    return attributes


@pytest.mark.parametrize("logs", [["hidden.mcap"], ["hidden.mcap", "again.mcap"]])
def test_a_discovery_tells_what_the_command_line_tells(place, robot, logs):
    expected, extended = by_command_line(place, *logs)
    paths = [place / log for log in logs]
    result = fric.discover(robot, paths if len(paths) > 1 else paths[0])
    assert without_origin(result.to_json()) == without_origin(expected) and result.to_dict() == json.loads(result.to_json())
    # Comments and layout included.
    assert result.robot.to_toml() == extended
    assert [told(cable) for cable in result.cables] == json.loads(expected)["cables"]
    assert result.common_effects == json.loads(expected)["common_effects"] == []
    read = [fric.read_log(path, robot) for path in paths]
    assert result.cables[0].residual_after_n.shape == (sum(map(len, read)),)


def test_zeros_of_the_logs_are_no_effect():
    tared = [SLOW_BENCH.replace("friction = {", f"friction = {{ offset_n = {zero_n},") for zero_n in (0.3, -0.5, 0.1)]
    logs = [fric.simulate(fric.Robot.from_toml(text), seed=seed, duration_s=24.0) for seed, text in enumerate(tared)]
    result = fric.discover(fric.Robot.from_toml(SLOW_BENCH), logs, per_log=["offset_n"])
    winch = result.cable("winch")
    assert (winch.verdict, winch.effects) == ("complete", [])
    assert [log["log"] for log in winch.per_log] == ["log 1", "log 2", "log 3"]
    assert told(winch) == json.loads(result.to_json())["cables"][0]
    assert result.robot.cable("winch").friction.offset_n == winch.per_log[2]["parameters"]["offset_n"]


def test_the_hidden_effect_is_named_with_its_values(robot, result):
    winch = result.cable("winch")
    (effect,) = winch.effects
    assert (winch.verdict, effect["kind"], winch.missing, winch.unexplained) == ("extended", "stribeck", None, None)
    for key in ("ratio", "velocity_m_per_s"):
        assert effect["parameters"][key] == pytest.approx(HIDDEN[key], rel=0.25)
        assert effect["parameters"][key] == winch.parameters[f"stribeck.{key}"]
        assert effect["standard_errors"][key] == winch.standard_errors[f"stribeck.{key}"]
    assert winch.candidates[0]["kind"] == "stribeck" and effect["evidence"]["delta_bic"] < -10
    assert effect["runner_up"]["held_out_rms_n"] > effect["evidence"]["held_out_rms_n"] == winch.after.rms_n
    assert 0.9 < winch.gap_closed < 1.1 and winch.where[0]["signal"] == "speed"
    assert len(winch.where_in_words) == len(winch.where) and "speeds below" in winch.where_in_words[0]
    assert robot.cable("winch").effects == () and robot.to_toml() == SLOW_BENCH
    assert "The model lacks stribeck; with it, what is left is noise." in result.summary()
    assert repr(winch) == '<CableDiscovery "winch": extended, stribeck>'
    assert repr(result) == '<DiscoverResult of "bench": 1 cable, effects found on 1>'


def test_the_residual_is_that_of_a_replay_with_the_extended_robot(log, result):
    winch = result.cable("winch")
    replayed = fric.replay(result.robot, log)
    left_n = replayed.force_at_platform_n[:, 0] - log.reference_force_n[:, 0]
    used = np.isfinite(winch.residual_after_n)
    assert np.allclose(winch.time_s, log.time_s, rtol=0, atol=1e-9) and used.sum() == winch.samples
    assert np.allclose(winch.residual_after_n[used], left_n[used], rtol=0, atol=1e-12)
    for residual_n, error in ((winch.residual_before_n, winch.before), (winch.residual_after_n, winch.after)):
        judged_n = np.concatenate([residual_n[slice(*rows)] for rows in winch.held_out_samples])
        assert math.sqrt(np.nanmean(judged_n**2)) == pytest.approx(error.rms_n, rel=1e-12)
    with pytest.raises(ValueError, match="read-only"):
        winch.residual_after_n[0] = 0.0


def test_nothing_is_found_where_nothing_is_hidden(robot):
    winch = fric.discover(robot, fric.simulate(robot, seed=2, duration_s=20.0)).cables[0]
    assert (winch.verdict, winch.effects, winch.gap_closed) == ("complete", [], None)


def test_a_fault_of_the_recording_is_told_beside_the_verdict(robot):
    hum = {"kind": "hum", "amplitude_n": 0.2, "frequency_hz": 31.0}
    winch = fric.discover(robot, fric.simulate(robot, duration_s=20.0, disturbances=[hum])).cables[0]
    assert (winch.verdict, winch.effects, winch.unexplained) == ("complete", [], None)
    (fault,) = winch.faults
    assert (fault["kind"], fault["intervals_s"]) == ("hum", [])
    assert fault["parameters"]["frequency_hz"] == pytest.approx(31.0, abs=0.01)
    # The sensor feels both ends of a cable that turns round by 180°.
    assert fault["parameters"]["amplitude_n"] == pytest.approx(0.1, rel=0.05)


def test_a_wrong_gain_is_found_by_the_wrench():
    given = ROBOT.read_text(encoding="utf-8").replace("cycle_s = 0.001", "cycle_s = 0.004")
    hidden = given.replace("\nfriction =", '\neffects = [{ kind = "sensor_gain", gain = 1.04 }]\nfriction =', 1)
    log = fric.simulate(fric.Robot.from_toml(hidden), seed=4, duration_s=16.0)
    result = fric.discover(fric.Robot.from_toml(given), log, reference="wrench")
    first, *others = result.cables
    assert [effect["kind"] for effect in first.effects] == ["sensor_gain"] and not any(of.effects for of in others)
    assert first.effects[0]["parameters"]["gain"] == pytest.approx(1.04, abs=0.002)
    # No force to compare a single cable with.
    assert first.before is None and first.after is None and first.gap_closed is None
    gap = result.wrench
    assert (gap["reference"], gap["verdict"], gap["geometry"], gap["alike"]) == ("wrench", "extended", [], [])
    assert gap["after"]["force_rms_n"] < 0.2 * gap["before"]["force_rms_n"]
    assert [of["name"] for of in gap["components"]] == ["fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"]
    assert all(of["noise"] < 1.5 * of["after"] < of["before"] for of in gap["components"])
    (effect,) = result.robot.cables[0].effects
    assert (effect["kind"], effect["gain"]) == ("sensor_gain", first.parameters["sensor_gain.gain"])


def without_reference(log, column):
    names = ("stamp_nanos", "sensor_force_n", "length_m", "speed_m_per_s", "position_m", "orientation_xyzw")
    arrays = {name: getattr(log, name) for name in names}
    reference_force_n = np.array(log.reference_force_n)
    reference_force_n[:, column] = np.nan
    return fric.Log.from_arrays(cable_names=log.cable_names, reference_force_n=reference_force_n, **arrays)


def test_what_a_log_lacks_is_told(robot, log):
    lacks = r"no reference forces on /reference_forces\. .* force sensors at the platform\."
    with pytest.raises(fric.FitError, match=lacks):
        fric.discover(robot, without_reference(log, 0))
    lacks = r"2\.0 s of samples with a reference are too few, 8 s are needed\. Record a longer run"
    with pytest.raises(fric.FitError, match=lacks):
        fric.discover(robot, fric.simulate(robot, duration_s=2.0))


def test_a_cable_without_reference_has_no_verdict():
    second = SLOW_BENCH[SLOW_BENCH.index("[[cable]]") :].replace('"winch"', '"other"')
    robot = fric.Robot.from_toml(SLOW_BENCH + second)
    log = without_reference(fric.simulate(robot, duration_s=20.0), 1)
    result = fric.discover(robot, log)
    other = result.cable("other")
    assert (result.cable("winch").verdict, other.verdict, other.before) == ("complete", None, None)
    assert "no reference forces on /reference_forces of other" in other.missing["cause"]
    assert other.residual_after_n.size == 0 and result.to_dict()["log"] == ["log 1"]
    with pytest.raises(fric.FitError, match=r"nothing can be told of other: .* of other\. Name their topic as"):
        result.plot("other")


def test_what_is_misspelt_is_answered(robot, log, result):
    with pytest.raises(fric.ConfigError, match="unknown cable `wich`; did you mean `winch`"):
        result.cable("wich")
    with pytest.raises(fric.ConfigError, match="unknown cable `wich`; did you mean `winch`"):
        fric.plot.where(result, "wich")
    with pytest.raises(TypeError, match="progres"):
        fric.discover(robot, log, progres=True)
    with pytest.raises(TypeError, match="`log` must be a Log, a path, or a list of them; what came is"):
        fric.discover(robot, 3)
    with pytest.raises(fric.ConfigError, match="given twice"):
        fric.discover(robot, [log, log])
    with pytest.raises(fric.ShapeError, match="the log has the cables winch, the robot cable1"):
        fric.discover(fric.Robot.read(ROBOT), log)


def test_progress_goes_from_nothing_to_all(robot, log):
    told = []
    fric.discover(robot, log, progress=told.append)
    assert told == sorted(told) and told[0] == 0.0 and told[-1] == 1.0


def test_ctrl_c_ends_a_discovery(place):
    code = f"""{PRESS_SOON}
import fric
robot = fric.Robot.read({str(place / "robot.toml")!r})
log = fric.simulate(robot, duration_s=600.0, effects=[{HIDDEN!r}])
try:
    fric.discover(robot, log, progress=press_soon)
except KeyboardInterrupt:
    print(max(seen) < 1.0, len(fric.simulate(robot, duration_s=1.0)))
"""
    assert printed(code) == "True 250\n"


def bars(ax):
    return [patch.get_width() for patch in ax.patches]


def names(ax):
    return [label.get_text() for label in ax.get_yticklabels()]


def test_figures_show_the_numbers(result):
    winch = result.cable("winch")
    ladder = fric.plot.gap_ladder(result, "winch")
    assert names(ladder) == ["given model", "+ stribeck"]
    assert np.allclose(bars(ladder), [winch.before.rms_n, winch.after.rms_n], rtol=1e-12)
    assert any("of the gap closed" in text.get_text() for text in ladder.texts)
    assert ladder.get_lines()[0].get_xdata()[0] == winch.noise_floor_n
    places = fric.plot.where(result, "winch")
    assert names(places) == winch.where_in_words
    shares = [place[key] for key in ("share_of_excess", "share_of_samples") for place in winch.where]
    assert np.allclose(bars(places), 100 * np.array(shares))
    tried = fric.plot.candidates(result, "winch")
    assert names(tried) == [candidate["kind"] for candidate in winch.candidates]
    assert np.allclose(bars(tried), [candidate["held_out_rms_n"] for candidate in winch.candidates], rtol=1e-12)
    colors = [patch.get_facecolor() for patch in tried.patches]
    assert colors.count(colors[0]) == 1 and names(tried)[0] == "stribeck"


def test_a_cable_is_drawn_as_a_whole_or_into_axes_given(robot, result):
    whole = result.plot("winch")
    assert [ax.get_xlabel() for ax in whole.axes] == [
        "rms on samples held out [N]",
        "share [%]",
        "rms on samples held out [N]",
    ]
    figure, axes = pyplot.subplots(3)
    for draw, ax in zip((fric.plot.gap_ladder, fric.plot.where, fric.plot.candidates), axes):
        assert draw(result, "winch", ax=ax) is ax
    assert pyplot.get_fignums() == [whole.number, figure.number]
    quiet = fric.discover(robot, fric.simulate(robot, seed=2, duration_s=20.0))
    assert [text.get_text() for ax in quiet.plot("winch").axes[1:] for text in ax.texts] == [
        "the model agrees to the noise",
        "nothing was tried",
    ]


def test_the_type_of_a_fault_has_every_fault_of_the_documentation():
    kinds = get_args(get_type_hints(Fault)["kind"])
    page = (ROOT / "docs" / "discovery.md").read_text(encoding="utf-8")
    section = page.split("\n## Faults of the recording\n")[1].split("\n## ")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    assert sorted(kinds) == sorted(re.findall("`([a-z_]+)`", " ".join(rows)))
