"""What a log costs on a fleet beside fric-cli alone, what a second worker brings, and what is lost where one is killed.

python benches/fleet/make_logs.py FOLDER
python benches/fleet/measure.py FOLDER target/release/fric-cli
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import fric
from distributed import Client, LocalCluster
from fric import fleet

ROBOTS = ("north", "middle", "south")
ONE_THREAD = {"RAYON_NUM_THREADS": "1"}


def by_command_line(folder, cli):
    """Wall and processor seconds of fric-cli over all logs, one after the other."""
    began_s, before = time.perf_counter(), os.times()
    for robot in ROBOTS:
        for log in sorted((folder / robot).glob("*.csv")):
            command = [
                cli,
                "fit",
                log,
                "--model",
                folder / f"{robot}.toml",
                "-o",
                folder / "fitted.toml",
                "--json",
                folder / "fit.json",
                "--force",
            ]
            subprocess.run(command, check=True, capture_output=True, env={**os.environ, **ONE_THREAD})
    after = os.times()
    return time.perf_counter() - began_s, after.children_user - before.children_user + after.children_system - before.children_system


def run_all(folder, results, client, progress=None):
    """The fleet's runs over all robots."""
    return [
        fleet.run("fit", folder / robot / "*.csv", results=results, model=folder / f"{robot}.toml", client=client, progress=progress)
        for robot in ROBOTS
    ]


def by_workers(folder, results, count):
    """Wall seconds of so many workers that have been started before, and processor seconds of all of them."""
    with (
        LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address="127.0.0.1:0", env=ONE_THREAD) as cluster,
        Client(cluster) as client,
    ):
        client.run(lambda: __import__("fric"))
        shutil.rmtree(results, ignore_errors=True)
        began_s, before_s = time.perf_counter(), sum(client.run(time.process_time).values())
        run_all(folder, results, client)
        return time.perf_counter() - began_s, sum(client.run(time.process_time).values()) - before_s


def numbers(results):
    """All values, without what differs from run to run."""
    import pyarrow.dataset

    rows = pyarrow.dataset.dataset(sorted(map(str, Path(results).rglob("*.parquet")))).to_table().to_pylist()
    return sorted((row["log"], row["cable"], row["parameter"], row["value"]) for row in rows)


def killed_and_cut(folder, results):
    """What is computed where a worker is killed in the middle, and where the run is stopped and started again."""
    told = {}
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50, env=ONE_THREAD) as cluster,
        Client(cluster) as client,
    ):
        victims = []

        def kill(fraction):
            if fraction > 0.5 and not victims:
                victims.append(next(iter(client.run(os.getpid).values())))
                os.kill(victims[0], signal.SIGKILL)

        shutil.rmtree(results, ignore_errors=True)
        done = run_all(folder, results, client, kill)
        told["killed"] = {"computed": sum(one.computed for one in done), "failed": sum(len(one.failures) for one in done)}
        told["killed"]["files"] = len(list(results.rglob("*.parquet")))
        expected = numbers(results)
        shutil.rmtree(results)

        def cut(fraction):
            if fraction > 0.6:
                raise KeyboardInterrupt

        try:
            run_all(folder, results, client, cut)
        except KeyboardInterrupt:
            time.sleep(2)
        there = len(list(results.rglob("*.parquet")))
        done = run_all(folder, results, client)
        told["cut"] = {"there": there, "computed": sum(one.computed for one in done), "known": sum(one.known for one in done)}
        began_s = time.perf_counter()
        run_all(folder, results, client)
        told["cut"]["nothing_missing_s"] = time.perf_counter() - began_s
        told["same_numbers"] = numbers(results) == expected
    return told


def main():
    folder, cli = Path(sys.argv[1]), sys.argv[2]
    results = folder / "measured"
    count = sum(len(list((folder / robot).glob("*.csv"))) for robot in ROBOTS)
    alone = by_command_line(folder, cli)
    one, two = by_workers(folder, results, 1), by_workers(folder, results, 2)
    told = {"version": fric.__version__, "logs": count, "load": os.getloadavg()}
    told |= {
        name: {"wall_ms_a_log": 1e3 * wall / count, "cpu_ms_a_log": 1e3 * cpu / count}
        for name, (wall, cpu) in {"fric-cli": alone, "one worker": one, "two workers": two}.items()
    }
    told |= {"speed_up": one[0] / two[0], "cost_wall": one[0] / alone[0], "cost_cpu": one[1] / alone[1]}
    told |= killed_and_cut(folder, results)
    began_s = time.perf_counter()
    found = fleet.trend(results)
    told["trend_s"] = time.perf_counter() - began_s
    told["series"] = len(found.series)
    told["alarms"] = [f"{alarm.robot} {alarm.cable} {alarm.date:%Y-%m-%d} {alarm.parameters}" for alarm in found.alarms]
    told["truth"] = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    print(json.dumps(told, indent=2))


if __name__ == "__main__":
    main()
