"""A fleet: an operation over many logs by processes, one of them killed; and what the results tell of a change."""

import datetime
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from importlib.metadata import requires

import fric
import numpy as np
import pyarrow
import pytest
from distributed import Client, LocalCluster
from fric import fleet
from fric.fleet._needs import LIBRARIES
from matplotlib.colors import to_hex
from support import BENCH

DAY = datetime.datetime(2025, 1, 6, tzinfo=datetime.timezone.utc)
COUNT = 12


def write(path, log, start_s):
    """A log of one cable as CSV, its time that of the day."""
    columns = [log.time_s + start_s, log.sensor_force_n[:, 0], log.length_m[:, 0], log.speed_m_per_s[:, 0], log.reference_force_n[:, 0]]
    head = "time_s," + ",".join(f"winch.{key}" for key in ("force_n", "length_m", "speed_m_per_s", "reference_n"))
    np.savetxt(path, np.column_stack(columns), fmt=["%.4f", *["%.7g"] * 4], delimiter=",", header=head, comments="")


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Logs of a bench, a week apart, and one that is none."""
    place = tmp_path_factory.mktemp("fleet")
    (place / "logs").mkdir()
    (place / "robot.toml").write_text(BENCH, encoding="utf-8")
    for week in range(COUNT):
        log = fric.simulate(fric.Robot.from_toml(BENCH), seed=week, duration_s=8.0)
        write(place / "logs" / f"week{week:02}.csv", log, (DAY + datetime.timedelta(weeks=week)).timestamp())
    (place / "logs" / "broken.csv").write_text("no log\n", encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def cluster():
    # Workers that were killed are started anew.
    environment = {"RAYON_NUM_THREADS": "1"}
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50, env=environment) as cluster,
        Client(cluster) as client,
    ):
        yield client


def fit_all(place, results, client, **options):
    return fleet.run("fit", place / "logs" / "*.csv", results=results, model=place / "robot.toml", client=client, **options)


def rows(results):
    return sorted(fleet._series.Store(results).table().to_pylist(), key=lambda row: (row["log"], row["parameter"] or ""))


def without_time(table):
    return [{key: value for key, value in row.items() if key not in ("seconds", "computed")} for row in table]


def files(results):
    return {path.name: path.stat().st_mtime_ns for path in results.rglob("*.parquet")}


@pytest.fixture(scope="module")
def whole(place, cluster):
    """A run that nothing happens to."""
    return fit_all(place, place / "whole", cluster)


def test_every_log_has_its_result_and_the_broken_one_its_error(place, whole):
    assert (whole.logs, whole.computed, whole.known) == (COUNT + 1, COUNT, 0)
    assert [failure.log for failure in whole.failures] == [str(place / "logs" / "broken.csv")]
    assert "has one column alone" in whole.failures[0].error and whole.failures[0].error in str(whole)
    path = place / "logs" / "week03.csv"
    expected = fric.fit(fric.Robot.from_toml(BENCH), path).cable("winch")
    of_log = {row["parameter"]: row for row in rows(place / "whole") if row["log"] == str(path)}
    for parameter, value in expected.values.items():
        assert of_log[parameter]["value"] == value and of_log[parameter]["standard_error"] == expected.standard_errors[parameter]
    assert of_log["after.rms_n"]["value"] == expected.after.rms_n
    mu = of_log["mu"]
    assert (mu["robot"], mu["cable"], mu["operation"], mu["month"], mu["state"]) == ("bench", "winch", "fit", "2025-01", "fitted")
    assert mu["start"].to_pydatetime() == DAY + datetime.timedelta(weeks=3) and mu["fric_version"] == fric.__version__


def test_a_worker_killed_in_the_middle_costs_no_log(place, whole, cluster):
    killed = []

    def kill(fraction):
        if fraction >= 0.3 and not killed:
            killed.append(next(iter(cluster.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    done = fit_all(place, place / "killed", cluster, progress=kill)
    # What the killed worker had written is known to the one that does its work again.
    assert killed and done.computed + done.known == COUNT and done.failures == whole.failures
    assert without_time(rows(place / "killed")) == without_time(rows(place / "whole"))


def test_a_run_that_was_cut_off_goes_on(place, whole, cluster):
    results = place / "cut"

    def cut(fraction):
        if fraction >= 0.4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fit_all(place, results, cluster, progress=cut)
    time.sleep(0.5)
    before = files(results)
    assert 0 < len(before) < COUNT + 1
    fractions = []
    rest = fit_all(place, results, cluster.scheduler.address, progress=fractions.append)
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert rest.computed + rest.known == COUNT and rest.computed <= COUNT + 1 - len(before) + 1 and rest.failures == whole.failures
    after = files(results)
    assert {name: after[name] for name in before} == before
    assert without_time(rows(results)) == without_time(rows(place / "whole"))
    again = fit_all(place, results, cluster)
    assert (again.computed, again.known, len(again.failures)) == (0, COUNT, 1) and files(results) == after


def test_only_what_a_result_depends_on_is_computed_again(place, whole, cluster):
    logs, results = place / "few", place / "changes"
    logs.mkdir()
    for week in range(3):
        (logs / f"{week}.csv").write_bytes((place / "logs" / f"week{week:02}.csv").read_bytes())

    def counts(**options):
        done = fleet.run("fit", [logs / "*.csv"], results=results, model=place / "robot.toml", client=cluster, **options)
        assert done.failures == ()
        return done.computed, done.known

    assert counts() == (3, 0)
    (logs / "0.csv").rename(logs / "moved.csv")
    os.utime(logs / "1.csv")
    assert counts() == (0, 3)
    assert counts(huber=True) == (3, 0)
    (logs / "2.csv").write_bytes((place / "logs" / "week05.csv").read_bytes())
    assert counts() == (1, 2)


def test_an_error_goes_with_its_log_and_results_are_no_logs(place, cluster):
    logs = place / "renamed"
    results = logs / "results"
    logs.mkdir()
    (logs / "broken.csv").write_text("no table at all\n" * 20)
    (logs / "0.csv").write_bytes((place / "logs" / "week00.csv").read_bytes())

    def failures():
        done = fleet.run("fit", logs / "**" / "*", results=results, model=place / "robot.toml", client=cluster)
        return done.logs, [failure.log for failure in done.failures], [failure.error for failure in done.failures], str(done)

    count, broken, (first,), _ = failures()
    assert (count, broken) == (2, [str(logs / "broken.csv")])
    (logs / "broken.csv").rename(logs / "other.csv")
    (logs / "copy.csv").write_text("no table at all\n" * 20)
    count, broken, errors, told = failures()
    assert (count, broken) == (3, [str(logs / "copy.csv"), str(logs / "other.csv")])
    assert [error.replace(log, str(logs / "broken.csv")) for log, error in zip(broken, errors)] == [first, first]
    assert f"{logs / 'copy.csv'} and 1 more log: " in told and told.count("\n") == 2
    (whole,) = [path for path in results.rglob("*.parquet") if "-failed" not in path.name]
    whole.write_bytes(whole.read_bytes()[:-20])
    with pytest.raises(fric.OutputError, match=f"the result {whole} is damaged; delete it and run again"):
        fleet.trend(results)


def test_other_operations_and_addresses(place, cluster):
    paths = [f"file://{place}/logs/week0[01].csv", place / "logs" / "week00.csv"]
    model = fric.Robot.read(place / "robot.toml")
    done = fleet.run("replay", paths, results=f"file://{place}/replays", model=model, client=cluster, correct=True)
    assert (done.logs, done.computed) == (2, 2)
    found = {row["parameter"] for row in rows(place / "replays")}
    assert found == {"flagged_ratio", "before.rms_n", "before.mae_n", "after.rms_n", "after.mae_n"}
    by_discovery = fleet.run("discover", paths[:1], results=place / "replays", model=model, client=cluster)
    # 8 s are less than a discovery needs.
    assert by_discovery.computed == 0 and "the log tells nothing of winch" in by_discovery.failures[0].error
    with pytest.raises(fric.ConfigError, match="`results` has discover and replay; say by `operation` which of them is meant"):
        fleet.trend(place / "replays")
    assert fleet.trend(place / "replays", operation="replay").logs == 2


def test_what_is_remote_is_fetched(place):
    import fsspec
    from fric.fleet import _logs

    memory = fsspec.filesystem("memory")
    for name in ("week00.csv", "week01.csv"):
        memory.pipe_file(f"/bucket/2025/{name}", (place / "logs" / name).read_bytes())
    found = _logs.find("memory://bucket/**/*.csv", "memory:///bucket/2025/results")
    assert [log.address for log in found] == ["memory:///bucket/2025/week00.csv", "memory:///bucket/2025/week01.csv"]
    with _logs.fetched(found[0].address) as path:
        assert path.suffix == ".csv" and _logs.content_hash(path) == _logs.content_hash(place / "logs" / "week00.csv")
    assert not path.exists()
    # Workers that share this memory.
    with (
        LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        done = fleet.run("fit", "memory://bucket/**/*.csv", results="memory://results", model=place / "robot.toml", client=client)
        again = fleet.run("fit", "memory://bucket/**/*.csv", results="memory://results", model=place / "robot.toml", client=client)
    assert (done.computed, again.known) == (2, 2) and fleet.trend(done).logs == 2


def test_mistakes_are_told(place, cluster, tmp_path):
    logs, model = place / "logs" / "week0*.csv", place / "robot.toml"
    common = {"results": tmp_path / "results", "model": model, "client": cluster}
    with pytest.raises(fric.LogFileNotFoundError, match=r"no log matches .*none\*\.csv; name a log, a glob such as"):
        fleet.run("fit", place / "none*.csv", **common)
    with pytest.raises(fric.ConfigError, match="unknown operation `fits`; did you mean `fit`?"):
        fleet.run("fits", logs, **common)
    with pytest.raises(fric.ConfigError, match="unknown option of fit `hubert`; did you mean `huber`?"):
        fleet.run("fit", logs, **common, hubert=True)
    with pytest.raises(fric.ConfigError, match="muu"):
        fleet.run("fit", logs, **common, parameters=["muu"])
    with pytest.raises(fric.ConfigFileNotFoundError):
        fleet.run("fit", logs, **{**common, "model": place / "none.toml"})
    with pytest.raises(fric.ConfigError, match="`workers` is for processes of this machine"):
        fleet.run("fit", logs, **common, workers=2)
    with pytest.raises(fric.ConfigError, match="`client` is int; give a scheduler's address or a distributed.Client"):
        fleet.run("fit", logs, **{**common, "client": 3})
    with pytest.raises(fleet.FleetError, match="no scheduler answers at nowhere://; start one with `dask scheduler`"):
        fleet.run("fit", logs, **{**common, "client": "nowhere://"})
    with pytest.raises(fric.ConfigError, match="has no results; fric.fleet.run writes them"):
        fleet.trend(tmp_path / "nothing")
    with pytest.raises(fric.ConfigError, match="smb5://x/y cannot be reached: .*smb5"):
        fleet.run("fit", "smb5://x/y", **common)


def test_fric_does_without_dask():
    code = """
import sys
import fric
assert not {"dask", "distributed", "pyarrow", "fsspec", "ruptures"} & set(sys.modules)
sys.modules["fsspec"] = None
try:
    fric.fleet.run("fit", "*.mcap", results="results")
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "fric.fleet needs fsspec; install what fleets need with `pip install dask distributed fsspec pyarrow ruptures`\n"


def test_the_advice_names_the_libraries_of_the_extra():
    extra = {needed.partition(">")[0] for needed in requires("fric") if "fleet" in needed.partition(";")[2]}
    assert extra == set(LIBRARIES.split())


def made(seed, kind, *, count=60, size=8.0, outliers=0.0):
    """A series of unequal standard errors and a scatter from log to log as large as these, changed at the log `change`."""
    noise = np.random.default_rng(seed)
    day = np.sort(noise.uniform(0, 720, count))
    error = 1e-4 * noise.uniform(0.6, 1.5, count)
    change = int(noise.integers(15, count - 15))
    value = 0.02 + error * noise.normal(size=count) + 1e-4 * noise.normal(size=count)
    ahead = np.maximum(0, day - day[change]) / (day[-1] - day[change])
    value += 1e-4 * size * {"none": 0 * day, "step": day >= day[change], "slope": 3 * ahead}[kind]
    wrong = noise.random(count) < outliers
    value[wrong] += 5e-3 * noise.normal(size=wrong.sum())
    return day, value, error, change


def table(made_series, *, robot="rig", parameter="mu"):
    day, value, error, _ = made_series
    start = [DAY + datetime.timedelta(days=float(one)) for one in day]
    names = {"robot": [robot] * len(day), "cable": ["cable1"] * len(day), "parameter": [parameter] * len(day)}
    return pyarrow.table({**names, "start": start, "value": value, "standard_error": error})


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("outliers", [0.0, 0.05])
def test_a_step_is_found_where_it_was_made(seed, outliers):
    series = made(seed, "step", outliers=outliers)
    found = fleet.trend(table(series))
    (alarm,) = found.alarms
    (change,) = alarm.changes
    assert (alarm.robot, alarm.cable, alarm.reason, change.kind) == ("rig", "cable1", "history", "step")
    at = int(np.searchsorted(found.series[0].date, np.datetime64(change.date.replace(tzinfo=None))))
    assert abs(at - series[3]) <= 1 and change.earliest <= change.date <= change.latest
    assert change.size == pytest.approx(8e-4, abs=4 * change.size_standard_error) and change.delta_bic < -10
    assert change.size_standard_error == pytest.approx(1.45e-4 * np.sqrt(1 / at + 1 / (60 - at)), rel=0.5)


@pytest.mark.parametrize("seed", range(6))
def test_a_slope_is_told_from_a_step(seed):
    series = made(seed, "slope")
    found = fleet.trend(table(series))
    (change,) = found.alarms[0].changes
    first = DAY + datetime.timedelta(days=float(series[0][series[3]]))
    assert change.kind == "slope" and change.earliest - datetime.timedelta(days=30) <= first <= change.latest + datetime.timedelta(
        days=30
    )
    assert change.after == pytest.approx(0.02 + 24e-4, abs=2e-4) and found.alarms[0].cause == "a bearing of this cable runs dry or wears"


def test_a_fleet_without_changes_has_no_alarm():
    tables = [table(made(seed, "none", outliers=0.03), robot=f"robot{seed}") for seed in range(20)]
    found = fleet.trend(pyarrow.concat_tables(tables))
    assert len(found.series) == 20 and found.alarms == ()
    assert "nothing has changed" in str(found) and "Nothing: all parameters are what they were" in found.to_html()


def test_a_change_of_the_model_is_none_of_the_machine():
    series = made(2, "step")
    whole, day = table(series), series[0]

    def found(switch):
        models = ["old" if one < switch else "new" for one in day]
        return fleet.trend(whole.append_column("model_hash", [models]))

    with_it = found(day[series[3]])
    (change,) = with_it.series[0].changes
    assert change.of_model and with_it.alarms == ()
    assert "nothing has changed but values that go with another model" in str(with_it) and "run all logs with the same ones" in str(with_it)
    assert "within their scatter" not in with_it.to_html()
    apart = found(day[series[3] // 2])
    assert not apart.series[0].changes[0].of_model and len(apart.alarms) == 1


def test_effects_that_come_and_go_are_told():
    start = [DAY + datetime.timedelta(weeks=week) for week in range(8)]
    names = {"operation": "discover", "robot": "rig", "cable": "cable1"}
    rows = [{**names, "parameter": "mu", "value": 0.02, "standard_error": 1e-4, "start": one, "state": "fitted", "log_hash": str(one)} for one in start]
    rows += [{**row, "parameter": f"found.{kind}", "state": "found", "value": 1.0} for kind, since in (("stribeck", 4), ("sensor_gain", 0)) for row in rows[since:8]]
    found = fleet.trend(pyarrow.Table.from_pylist(rows))
    gain, stribeck = found.named
    assert (gain.kind, gain.logs, gain.of_logs, gain.first) == ("sensor_gain", 8, 8, DAY)
    assert (stribeck.kind, stribeck.logs, stribeck.of_logs, stribeck.first) == ("stribeck", 4, 8, start[4])
    assert "nothing has changed but effects that only some logs show" in str(found)
    assert f"stribeck is named on rig cable1 in 4 of 8 logs, first on {start[4]:%Y-%m-%d}" in str(found) and "sensor_gain" not in str(found)


def test_few_logs_are_no_good_news():
    few = table(tuple(column[:5] for column in made(0, "none")[:3]) + (0,))
    found = fleet.trend(few)
    assert found.alarms == () and "too few logs of different dates, 6 of each robot are needed" in str(found)
    assert "cannot tell whether anything has changed" in found.to_html() and "Nothing: all parameters" not in found.to_html()
    undated = few.set_column(few.schema.get_field_index("start"), "start", pyarrow.nulls(few.num_rows, few.schema.field("start").type))
    assert fleet.trend(undated, limits={"mu": (None, 0.05)}).series == ()


def test_logs_of_few_dates_have_no_order_among_them():
    """Logs of one recording session, or copies with one start, cannot tell a change; two sessions tell a step, and no slope."""
    _, value, error, _ = made(4, "none")
    one = fleet.trend(table((np.zeros(60), value, error, 0)))
    assert one.alarms == () and "too few logs of different dates" in str(one) and "too few dates" in one.to_html()
    later = np.where(np.arange(60) < 30, 0.0, 30.0)
    assert fleet.trend(table((later, value, error, 0))).alarms == ()
    (alarm,) = fleet.trend(table((later, value + 2e-3 * (later > 0), error, 0))).alarms
    assert [(change.kind, change.earliest == change.latest) for change in alarm.changes] == [("step", True)]


def test_a_replaced_pulley_ends_a_slope():
    day, value, error, _ = made(3, "none")
    value = value + 3e-5 * np.where((day > 200) & (day < 500), day - 200, 0) / 3
    found = fleet.trend(table((day, value, error, 0)))
    assert [(change.kind, change.size > 0) for change in found.series[0].changes] == [("slope", True), ("step", False)]


def test_a_wander_is_no_change():
    wrong = 0
    for seed in range(10):
        day, value, error, _ = made(seed, "none")
        noise = np.random.default_rng(1000 + seed)
        at = np.cumsum(np.append(0.0, np.diff(day)))
        memory = np.exp(-np.abs(at[:, None] - at[None, :]) / 20.0)
        value = value + 2e-4 * np.linalg.cholesky(memory + 1e-9 * np.eye(len(day))) @ noise.normal(size=len(day))
        wrong += bool(fleet.trend(table((day, value, error, 0))).alarms)
    assert wrong <= 2


def test_limits_and_a_last_log_out_of_line():
    series = made(1, "slope")
    limited = fleet.trend(table(series), limits={"mu": (None, 0.0215)})
    kinds = {alarm.reason: alarm for alarm in limited.alarms}
    assert set(kinds) == {"history", "limit"} and "above the limit of 0.0215" in kinds["limit"].text
    assert kinds["limit"].date > kinds["history"].date
    # A chart marks the date of its own alarm, the later one further to the right.
    sections = [section.split("</section>")[0] for section in limited.to_html().split('<section class="alarm"')[1:]]
    marked = {alarm.reason: re.findall(r'class="since" d="M([\d.]+),', section) for alarm, section in zip(limited.alarms, sections)}
    assert [len(at) for at in marked.values()] == [1, 1] and float(marked["limit"][0]) > float(marked["history"][0])
    assert all(f"since {alarm.date:%Y-%m-%d}" in section for alarm, section in zip(limited.alarms, sections))
    ahead = fleet.trend(table(series), limits={"rig/cable1/mu": (None, 0.024)})
    assert "at this pace it reaches 0.024 about 202" in ahead.alarms[0].text and len(ahead.alarms) == 1
    day, value, error, _ = made(2, "none")
    value[-1] += 0.01
    (alarm,) = fleet.trend(table((day, value, error, 0))).alarms
    assert alarm.reason == "last_log" and "record another log" in alarm.remedy
    with pytest.raises(fric.ConfigError, match="unknown parameter for a limit `muu`; did you mean `mu`?"):
        fleet.trend(table(series), limits={"muu": (0.0, 1.0)})
    with pytest.raises(fric.ConfigError, match="the least value comes first"):
        fleet.trend(table(series), limits={"mu": (1.0, 0.0)})
    with pytest.raises(fric.ShapeError, match="`results` has no column cable, parameter; a table needs"):
        fleet.trend(table(series).drop_columns(["cable", "parameter"]))
    with pytest.raises(fric.ConfigError, match="unknown robot `rog`; did you mean `rig`?"):
        limited.of("rog", "cable1", "mu")


def test_a_step_beyond_a_limit_is_one_alarm():
    series = table(made(1, "step"))
    (plain,) = fleet.trend(series).alarms
    (alarm,) = fleet.trend(series, limits={"mu": (None, plain.changes[0].before)}).alarms
    assert (alarm.reason, alarm.date, alarm.changes) == ("limit", plain.date, plain.changes)
    assert alarm.text.startswith(plain.text) and "above the limit of" in alarm.text
    for limits in ({"mu": 0.05}, {"mu": (0.0,)}, {"mu": (0.0, float("nan"))}, {"mu": "ab"}):
        with pytest.raises(fric.ConfigError, match="the limit of `mu` in `limits` is .*; give least and greatest value as a pair"):
            fleet.trend(series, limits=limits)
    with pytest.raises(fric.ArgumentTypeError, match="`limits` must be a dict of pairs"):
        fleet.trend(series, limits=[0.05])


def test_only_logs_without_a_result_are_failures():
    day = DAY.replace(tzinfo=None)
    good = {"robot": "rig", "cable": "c", "parameter": "mu", "start": day, "value": 0.02, "standard_error": 1e-4, "state": "fitted"}

    def row(log, log_hash, hour, **rest):
        return {**good, "log": log, "log_hash": log_hash, "computed": day + datetime.timedelta(hours=hour), **rest}

    failed = {"cable": None, "parameter": None, "value": None, "standard_error": None, "start": None}
    rows = [
        # Failed without a model, then computed with one.
        row("a.mcap", "a", 1, **failed, robot="unknown", error="no robot file"),
        row("a.mcap", "a", 2),
        # Computed with its own model, then tried with that of another robot.
        row("b.mcap", "b", 1),
        row("b.mcap", "b", 2, **failed, robot="other", error="other cables"),
        # Broken, then recorded anew under the same name.
        row("c.mcap", "c", 1, **failed, error="damaged"),
        row("c.mcap", "c2", 2),
        # Failed twice.
        row("d.mcap", "d", 1, **failed, robot="unknown", error="no robot file"),
        row("d.mcap", "d", 2, **failed, error="damaged"),
        # Broken since.
        row("e.mcap", "e", 1),
        row("e.mcap", "e2", 2, **failed, error="damaged"),
    ]
    names = {name: None for one in rows for name in one}
    found = fleet.trend(pyarrow.Table.from_pylist([{**names, **one} for one in rows]))
    assert found.failures == (fleet.LogFailure("d.mcap", "damaged"), fleet.LogFailure("e.mcap", "damaged"))
    assert "2 logs gave no result\n  d.mcap and 1 more log: damaged\n" in str(found)
    assert "<td" in found.to_html() and "d.mcap and 1 more log" in found.to_html()


def test_an_error_of_all_logs_is_told_once_and_one_log_is_no_logs():
    failures = tuple(fleet.LogFailure(f"{name}.mcap", "unknown reference `x`") for name in "abc") + (fleet.LogFailure("d.mcap", "damaged"),)
    told = str(fleet.FleetRun("fit", "out", 4, 0, 0, failures))
    assert told == (
        "fit of 4 logs into out: 0 computed, 0 there before, 4 failed\n  a.mcap and 2 more logs: unknown reference `x`\n  d.mcap: damaged\n"
    )
    assert str(fleet.FleetRun("fit", "out", 1, 1, 0, ())).startswith("fit of 1 log into out")
    day = np.array([0.0])
    assert str(fleet.trend(table((day, day, day, 0)))).startswith("1 log of 1 robot, 1 series by fric fit")


def test_a_trend_is_shown_in_all_forms(whole):
    found = fleet.trend(pyarrow.concat_tables([table(made(1, "step")), table(made(5, "none"), robot="<other>")]))
    told = found.to_dict()
    assert told["format"] == "fric-trend/1" and told["alarms"][0]["changes"][0]["kind"] == "step"
    assert [len(series["values"]) for series in told["series"]] == [60, 60]
    assert json.loads(found.to_json()) == told and found.alarms[0].text in str(found)
    page = found.to_html()
    assert "<other>" not in page and "&lt;other&gt;" in page and "http" not in page and page.count("<svg") == 1
    ax = fric.plot.trend(found, "rig", "cable1", "mu")
    drawn = [line for line in ax.get_lines() if to_hex(line.get_color()) == "#0072b2"]
    assert sum(len(line.get_xdata()) for line in drawn) == 60 and len(drawn) == 2
    measured = fleet.trend(whole)
    assert measured.logs == COUNT and measured.failures == whole.failures and measured.alarms == ()
    assert measured.of("bench", "winch", "mu").values == pytest.approx(np.full(COUNT, 0.02), abs=2e-4)


def test_logs_without_a_date_are_left_out(place, cluster, tmp_path):
    write(tmp_path / "undated.csv", fric.simulate(fric.Robot.from_toml(BENCH), seed=1, duration_s=8.0), 0.0)
    done = fleet.run("fit", tmp_path / "undated.csv", results=tmp_path / "results", model=place / "robot.toml", client=cluster)
    found = fleet.trend(done)
    assert (found.logs, found.undated, found.series) == (0, (str(tmp_path / "undated.csv"),), ())
    assert "1 log has no date" in str(found)


def test_own_workers_are_started_and_ended(place, tmp_path):
    threads = threading.active_count()
    done = fleet.run("fit", place / "logs" / "week00.csv", results=tmp_path / "results", model=place / "robot.toml", workers=1)
    assert done.computed == 1 and threading.active_count() <= threads + 2
