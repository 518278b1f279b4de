"""Writes the logs of three simulated robots over two years: on one a pulley dries, on one a sensor is replaced.

python benches/fleet/make_logs.py FOLDER [SEED]
"""

import json
import sys
from datetime import datetime, timedelta, timezone
from pathlib import Path

import fric
import numpy as np

ROBOTS = ("north", "middle", "south")
LOG_COUNT = 200
FIRST = datetime(2024, 3, 1, 8, tzinfo=timezone.utc)
DAYS = 730
DURATION_S = 12.0
# What nobody knows but this file.
DRY = ("north", "left", datetime(2025, 4, 10, tzinfo=timezone.utc))
NEW_SENSOR = ("south", "right", datetime(2024, 12, 5, tzinfo=timezone.utc))
DRY_MU_A_YEAR = 0.05
NEW_GAIN, NEW_OFFSET_N = 1.015, 0.12
# From log to log, as the temperature changes.
MU_RATIO, VISCOUS_RATIO, OFFSET_N = 0.02, 0.08, 0.01

MODEL = """format = "fric-robot/1"
name = "{name}"
cycle_s = 0.001
"""
CABLE = """[[cable]]
name = "{name}"
pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}, {{ wrap_deg = 120.0 }}]
friction = {{ mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.3, offset_n = 0.0 }}
effects = [{{ kind = "sensor_gain", gain = 1.001 }}]
"""


def model(name):
    """The robot as its maker describes it."""
    return fric.Robot.from_toml(MODEL.format(name=name) + "".join(CABLE.format(name=cable) for cable in ("left", "right")))


def truth(name, date, noise):
    """The robot as it is on a day."""
    robot = model(name)
    warmth = noise.normal()
    for cable in robot.cables:
        friction = {"mu": 0.02 * (1 + MU_RATIO * (0.7 * warmth + 0.7 * noise.normal()))}
        friction["viscous_n_s_per_m"] = 0.3 * (1 - VISCOUS_RATIO * warmth)
        gain, friction["offset_n"] = 1.0, OFFSET_N * noise.normal()
        effects = []
        if (name, cable.name) == NEW_SENSOR[:2] and date >= NEW_SENSOR[2]:
            gain, friction["offset_n"] = NEW_GAIN, NEW_OFFSET_N + friction["offset_n"]
        if (name, cable.name) == DRY[:2] and date >= DRY[2]:
            dry = friction["mu"] + DRY_MU_A_YEAR * (date - DRY[2]) / timedelta(days=365)
            effects.append({"kind": "pulley_defect", "pulley": 2, "mu": dry})
        cable.set(friction={**friction, "sigma_n_per_m": 900.0}, effects=[{"kind": "sensor_gain", "gain": gain}, *effects])
    return robot


def write(path, log, date):
    """A log as CSV, its time that of the day."""
    head, columns = ["time_s"], [log.time_s + date.timestamp()]
    for place, cable in enumerate(log.cable_names):
        head += [f"{cable}.{key}" for key in ("force_n", "length_m", "speed_m_per_s", "reference_n")]
        columns += [array[:, place] for array in (log.sensor_force_n, log.length_m, log.speed_m_per_s, log.reference_force_n)]
    layout = ["%.4f"] + ["%.7g"] * (len(head) - 1)
    np.savetxt(path, np.column_stack(columns), fmt=layout, delimiter=",", header=",".join(head), comments="")


def main():
    folder, seed = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    noise = np.random.default_rng(seed)
    dates = [FIRST + timedelta(days=float(day)) for day in np.sort(noise.uniform(0, DAYS, LOG_COUNT))]
    told = {"dry": [], "new_sensor": []}
    for name in ROBOTS:
        (folder / name).mkdir(parents=True, exist_ok=True)
        model(name).write(folder / f"{name}.toml", force=True)
    for place, date in enumerate(dates):
        name = ROBOTS[place % len(ROBOTS)]
        log = fric.simulate(truth(name, date, noise), seed=1000 * seed + place, duration_s=DURATION_S)
        path = folder / name / f"{date:%Y-%m-%d-%H%M}.csv"
        write(path, log, date)
        for what, (robot, _, begin) in (("dry", DRY), ("new_sensor", NEW_SENSOR)):
            if robot == name and date >= begin:
                told[what].append(path.name)
    (folder / "truth.json").write_text(json.dumps({what: names[0] for what, names in told.items()}), encoding="utf-8")
    print(f"{LOG_COUNT} logs in {folder}")


if __name__ == "__main__":
    main()
