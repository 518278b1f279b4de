"""Tendons through disks: what Python gives is what the command line gives, and what the truth is."""

import copy
import re

import fric
import numpy as np
import pytest
from matplotlib import pyplot
from fric import continuum
from support import ROOT, run, without_origin

ARM = ROOT / "examples" / "tendon-prototype.toml"


@pytest.fixture(scope="module")
def arm():
    return continuum.Manipulator.read(ARM)


@pytest.fixture(scope="module")
def tendon(arm):
    return continuum.simulate(arm, run="mixed", seed=5)


@pytest.fixture(scope="module")
def calibrated(arm, tendon):
    return continuum.calibrate(arm, tendon.load_n, tendon.load_shift_nm).manipulator


@pytest.fixture(scope="module")
def shapes(calibrated, tendon):
    return continuum.shape(calibrated, tendon.run, mixed=True, shapes=4)


def test_a_run_counts_once(arm, tendon):
    for runs in ([tendon.run, tendon.run], [tendon.run, copy.copy(tendon.run)]):
        with pytest.raises(fric.ConfigError, match="runs 1 and 2 of `runs` are the same, and its samples would count twice"):
            continuum.fit(arm, runs)
    with pytest.raises(fric.ConfigError, match="`runs` is an empty list; give at least one run"):
        continuum.fit(arm, [])


def test_calibration_is_numpy_s_line(arm, tendon):
    result = continuum.calibrate(arm, tendon.load_n, tendon.load_shift_nm)
    for grating in range(8):
        slope, offset = np.polyfit(tendon.load_shift_nm[:, grating], tendon.load_n, 1)
        assert np.isclose(result.newton_per_nm[grating], slope, rtol=1e-10)
        assert np.isclose(result.offset_n[grating], offset, rtol=0, atol=1e-10)
    assert (result.largest_residual_ratio < 0.01).all()
    assert result.manipulator.to_toml().startswith(arm.to_toml())
    assert result.to_dict()["gratings"][2]["grating"] == 3


def test_the_command_line_says_the_same(tmp_path, calibrated, shapes):
    files = [tmp_path / name for name in ("run.csv", "loads.csv", "truth.json", "cal.toml", "shape.json")]
    run_csv, loads, truth, cal, out = map(str, files)
    simulate = ["continuum", "simulate", "--model", str(ARM), "-o", run_csv, "--run", "mixed", "--seed", "5"]
    assert run(*simulate, "--calibration", loads, "--truth", truth) == ""
    assert run("continuum", "calibrate", loads, "--model", str(ARM), "-o", cal) == ""
    assert run("continuum", "shape", run_csv, "--model", cal, "--mixed", "--shapes", "4", "--json", out) == ""
    assert without_origin(files[4].read_text(encoding="utf-8")) == without_origin(shapes.to_json())
    read = continuum.read_run(run_csv, calibrated)
    assert np.array_equal(read.marker_m, continuum.read_run(run_csv, calibrated).marker_m) and len(read) == len(shapes.time_s)
    load_n, shift_nm = continuum.read_loads(loads, calibrated)
    assert load_n.shape == (10,) and shift_nm.shape == (10, 8)
    calibrated.write(tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_text() == calibrated.to_toml() == files[3].read_text()


def test_frictions_are_the_truth_s(calibrated, tendon):
    result = continuum.friction(calibrated, tendon.run)
    within = np.abs(result.friction_n - tendon.friction_n) < 2 * result.standard_error_n
    assert within.mean() > 0.9 and result.directions_differ.sum() > 20
    assert np.allclose(result.friction_n[:, 1:].sum(1) + result.friction_n[:, 0], result.friction_n.sum(1))
    assert "Directions differ" in result.summary()


def test_the_history_knows_the_directions(shapes, tendon):
    assert shapes.ways == ("none", "coulomb", "measured", "history")
    counts = np.abs(tendon.friction_n) > 0.1 * tendon.bound_n
    right = shapes.friction_n("history")[counts] * tendon.friction_n[counts] > 0
    assert right.mean() >= 0.95
    distance_m = np.linalg.norm(shapes.disk_position_m("history") - tendon.run.marker_m, axis=2)
    history = next(way for way in shapes.errors if way["way"] == "history")
    assert np.isclose(history["all"]["mean_mm"], 1e3 * distance_m.mean())
    assert np.isclose(history["all"]["max_mm"], 1e3 * distance_m.max())
    lost_n = tendon.run.tension_base_n - shapes.tension_n("history")[:, -1]
    assert np.allclose(shapes.friction_n("history").sum(1), lost_n, rtol=0, atol=1e-12)
    assert shapes.bend_rad("none").max() > shapes.bend_rad("history").max()


def test_a_dead_grating_is_a_warning(calibrated, tendon):
    shift_nm = tendon.run.shift_nm.copy()
    shift_nm[:, 3] = np.nan
    given = dict(time_s=tendon.run.time_s, tension_base_n=tendon.run.tension_base_n, shift_nm=shift_nm)
    dead = continuum.TendonRun.from_arrays(calibrated, marker_m=tendon.run.marker_m, **given)
    with pytest.warns(fric.LogWarning, match="grating 4 is dead in the whole run"):
        result = continuum.shape(calibrated, dead)
    assert result.to_dict()["bridged"][0]["grating"] == 4


def test_a_hole_is_a_line_through_the_origin():
    first_n, angle_rad = np.linspace(0.5, 2.0, 8), np.full(8, 1.1)
    second_n = 0.85 * first_n + 0.002 * np.sin(np.arange(8))
    normal_n = (first_n + second_n) * np.cos(1.1)
    result = continuum.hole(first_n, second_n, angle_rad, angle_rad)
    assert np.isclose(result.mu, (normal_n * (first_n - second_n)).sum() / (normal_n**2).sum())
    assert result.interval[0] < result.mu < result.interval[1]


def test_what_is_wrong_is_named(arm, calibrated, tendon, shapes, tmp_path):
    made = continuum.TendonRun.from_arrays
    with pytest.raises(fric.LogError, match="time goes from 0.1 s to 0.0 s at sample 3|time goes from 0.1 s to 0 s"):
        made(arm, time_s=[0.0, 0.1, 0.0], tension_base_n=[0.0, 0.0, 0.0])
    with pytest.raises(fric.LogError, match="`tension_base_n` is NaN"):
        made(arm, time_s=[0.0, 0.1], tension_base_n=[0.0, np.nan])
    with pytest.raises(fric.ShapeError, match=r"`shift_nm` must be .* \(2, 8\)"):
        made(arm, time_s=[0.0, 0.1], shift_nm=np.zeros((2, 7)))
    with pytest.raises(fric.LogError, match="capacity of 4 N"):
        continuum.shape(arm, made(arm, time_s=[0.0], tension_base_n=[4.5]))
    with pytest.raises(fric.ConfigError, match=r"no `\[gratings\]`"):
        continuum.friction(arm, tendon.run)
    with pytest.raises(fric.LogError, match="no gratings: friction cannot be measured"):
        continuum.friction(calibrated, made(arm, time_s=[0.0], tension_base_n=[1.0]))
    with pytest.raises(fric.ConfigError, match="did you mean `history`"):
        shapes.friction_n("histry")
    with pytest.raises(fric.ConfigError, match="did you mean `history`"):
        continuum.shape(calibrated, tendon.run, ways=["histry"])
    assert continuum.shape(calibrated, tendon.run, ways=["history"]).ways == ("history",)
    with pytest.raises(fric.ConfigError, match="99 s is not within the run"):
        continuum.shape(calibrated, tendon.run, at_s=[99.0])
    with pytest.raises(fric.ConfigError, match="did you mean `mixed`"):
        continuum.simulate(arm, run="mixd")
    with pytest.raises(fric.FitError, match="fewer than three loads"):
        continuum.hole([1.0], [0.9], [1.0], [1.0])
    with pytest.raises(fric.FitError, match="grating 1 does not answer"):
        continuum.calibrate(arm, np.arange(5.0), np.tile([[1.0], [-1.0], [1.0], [-1.0], [1.0]], (1, 8)))
    (tmp_path / "bad.csv").write_text("time_s,tension_n\n0,1\n")
    with pytest.raises(fric.LogError, match="did you mean `tension_base_n`"):
        continuum.read_run(tmp_path / "bad.csv", arm)
    with pytest.raises(fric.ConfigError, match="cannot read the manipulator file"):
        continuum.Manipulator.read(tmp_path / "none.toml")


def test_figures_show_the_numbers(shapes):
    ax = fric.plot.tendon_shape(shapes, 1)
    drawn = {line.get_label(): line.get_xydata() for line in ax.get_lines()}
    assert list(drawn) == ["none", "coulomb", "measured", "history", "markers"]
    assert np.array_equal(drawn["markers"], shapes.shapes[1]["marker_m"])
    assert np.array_equal(drawn["history"][1:], shapes.shapes[1]["ways"][3]["disk_position_m"])
    ax = fric.plot.tendon_friction(shapes, 1)
    heights = [bar.get_height() for bar in ax.containers[2]]
    assert np.array_equal(heights, shapes.shapes[1]["ways"][3]["friction_n"])
    with pytest.raises(fric.ConfigError, match="no shape 4"):
        fric.plot.tendon_shape(shapes, 4)


def test_discovery_names_what_the_file_lacks(tmp_path, calibrated, tendon):
    files = [tmp_path / name for name in ("smooth.toml", "run.csv", "found.toml", "found.json")]
    text = re.sub(r"(?m)^sigma_n_per_m = .*$", "", re.sub(r"(?m)^mu = .*$", "mu = 0.0", calibrated.to_toml()))
    smooth = continuum.Manipulator.from_toml(text)
    smooth.write(files[0])
    run("continuum", "simulate", "--model", ARM, "-o", files[1], "--run", "mixed", "--seed", "5")
    run("discover", files[1], "--model", files[0], "-o", files[2], "--json", files[3])
    result = continuum.discover(smooth, continuum.read_run(files[1], smooth))
    assert {**without_origin(result.to_json()), "log": None} == {**without_origin(files[3].read_text(encoding="utf-8")), "log": None}
    assert result.manipulator.to_toml() == files[2].read_text(encoding="utf-8")
    assert result.verdict == "extended" and "coulomb" in result.summary()
    kinds = {effect["kind"]: effect for effect in result.effects}
    assert list(kinds) == ["coulomb", "presliding"]
    # The truth scatters from hole to hole by ±10 %.
    mu, error = kinds["coulomb"]["parameters"]["mu"], kinds["coulomb"]["standard_errors"]["mu"]
    assert abs(mu - tendon.mu.mean()) < 0.05 * mu and 0 < error < 0.05 * mu
    rms_n = [np.sqrt(np.nanmean(residual**2)) for residual in (result.residual_before_n, result.residual_after_n)]
    assert result.residual_before_n.shape == (len(result.time_s), 8) and rms_n[1] < 0.2 * rms_n[0]
