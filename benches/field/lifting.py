"""Makes robot files and logs for fric-cli from recordings of a winch that lifts 1 kg and 5 kg, and fits the same model by itself.

    python lifting.py CLONE OUT

CLONE is a clone of https://github.com/eliasoa/TTK4900_CDPR, OUT the folder for what is made: `1kg.toml` and `5kg.toml` read
the recordings as they are; `robot.toml` reads the six logs of both loads, which have the reference as a column.
Needs numpy and scipy. docs/recordings.md has what to do with them.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

RUNS = ["1kg/Up05", "1kg/Down05", "1kg/Up1", "1kg/Down1", "5kg/Up05", "5kg/Down05"]
G_M_PER_S2 = 9.80665

# The drum's radius, and the torque of the motor (150 turns a minute and volt) for a current: Plot.m and curve_fit_polynomial.m.
DRUM_RADIUS_M = 0.02
TORQUE_NM_PER_A = 8.27 / 150.0
# The cable pulls with a negative current, and a growing position reels it in.
FORCE_N_PER_A = -TORQUE_NM_PER_A / DRUM_RADIUS_M
LENGTH_M_PER_TURN = -2.0 * np.pi * DRUM_RADIUS_M

# The acceleration is the slope of the drive's speed over this time to both sides; beyond the greatest there is no reference.
SLOPE_S = 0.08
GREATEST_ACCELERATION_M_PER_S2 = 0.5
# The independent fit: samples faster than this, further than this from where the motion began, so that all friction slides.
SLIDING_M_PER_S = 0.03
SLIDING_AFTER_M = 0.02
# Ripples of the force, periods a turn of the motor.
RIPPLES = (14, 28)
# Deviations further apart than this have forgotten each other.
BLOCK_S = 1.0

COLUMNS = {"time_s": "time", "winch.force_n": "ODrive 2 Current", "winch.length_m": "ODrive 2 Position", "winch.speed_m_per_s": "ODrive 2 Velocity"}
FACTORS = {"winch.force_n": FORCE_N_PER_A, "winch.length_m": LENGTH_M_PER_TURN, "winch.speed_m_per_s": LENGTH_M_PER_TURN}

ROBOT = """format = "fric-robot/1"
name = "lifting"
cycle_s = 0.031
{log}
[[cable]]
name = "winch"
pulleys = [{{ wrap_deg = 180.0 }}]
friction = {{ mu = 0.02, sigma_n_per_m = 2000.0, viscous_n_s_per_m = 1.0, offset_n = 0.0 }}
"""


def recording(clone, run):
    load, name = run.split("/")
    return clone / "Lifting_tests" / load / "ODrive2" / f"{name}.csv"


def mass_kg(run):
    return float(run.split("kg")[0])


def read_run(path, mass):
    """Time, force, length, speed, and the force at the load, NaN where it is not known."""
    try:
        table = np.genfromtxt(path, delimiter=",", names=True, deletechars="")
    except (OSError, ValueError) as error:
        raise SystemExit(f"{path} cannot be read: {error}") from error
    names = {key: name.replace(" ", "_") for key, name in COLUMNS.items()}
    signals = np.array([table[names[key]] * FACTORS.get(key, 1.0) for key in COLUMNS])
    time_s, force_n, length_m, speed_m_per_s = signals[:, np.isfinite(signals).all(axis=0)]
    reference_n = np.full(len(time_s), np.nan)
    for place, now_s in enumerate(time_s):
        near = np.abs(time_s - now_s) <= SLOPE_S
        if near.sum() >= 4:
            acceleration = np.polyfit(time_s[near] - now_s, speed_m_per_s[near], 1)[0]
            if abs(acceleration) <= GREATEST_ACCELERATION_M_PER_S2:
                reference_n[place] = mass * (G_M_PER_S2 - acceleration)
    return time_s, force_n, length_m, speed_m_per_s, reference_n


def robot_of_load(mass):
    """A robot file that reads the recordings as they are."""
    lines = ["", "[log]", f"reference = {{ hanging_mass_kg = {mass:.1f} }}", "", "[log.columns]"]
    for key, column in COLUMNS.items():
        factor = f", factor = {float(FACTORS[key])!r}" if key in FACTORS else ""
        lines.append(f'"{key}" = {{ column = "{column}"{factor} }}')
    return ROBOT.format(log="\n".join(lines) + "\n")


NAMES = ["mu", "drag_n", "viscous_n_s_per_m", "gain", "offset_n"]


def shown(values, length_m, speed_m_per_s, reference_n):
    """The force that the current shows while all friction slides.

    One pulley of 180 degrees between drive and load bears both tensions: paying out, the load's T is the drive's F and the
    friction, T = F + mu (F + T) + drag + viscous v. The current shows gain F + offset and the ripples.
    """
    mu, drag_n, viscous, gain, offset_n = values[:5]
    sign = np.sign(speed_m_per_s)
    drive_n = (reference_n * (1.0 - sign * mu) - sign * drag_n - viscous * speed_m_per_s) / (1.0 + sign * mu)
    total_n = gain * drive_n + offset_n
    for ripple, (sine, cosine) in zip(RIPPLES, values[5:].reshape(-1, 2), strict=True):
        angle = 2.0 * np.pi * ripple * length_m / abs(LENGTH_M_PER_TURN)
        total_n = total_n + sine * np.sin(angle) + cosine * np.cos(angle)
    return total_n


def fit(runs):
    """Least squares over all runs, with standard errors by the scatter of blocks of the samples."""
    rows, blocks = [], []
    for number, (time_s, force_n, length_m, speed_m_per_s, reference_n) in enumerate(runs):
        slides = np.isfinite(reference_n) & (np.abs(speed_m_per_s) > SLIDING_M_PER_S)
        slides &= np.abs(length_m - length_m[0]) > SLIDING_AFTER_M
        rows.append(np.column_stack([force_n, length_m, speed_m_per_s, reference_n])[slides])
        blocks.append(1000 * number + (time_s[slides] // BLOCK_S))
    force_n, *signals = np.vstack(rows).T
    start = np.concatenate([[0.01, 1.0, 0.0, 1.0, 0.0], np.full(2 * len(RIPPLES), 0.1)])
    found = least_squares(lambda values: shown(values, *signals) - force_n, start)
    scores = found.jac * found.fun[:, None]
    of_blocks = np.array([scores[np.concatenate(blocks) == block].sum(axis=0) for block in np.unique(np.concatenate(blocks))])
    bread = np.linalg.inv(found.jac.T @ found.jac)
    errors = np.sqrt(np.diag(bread @ (of_blocks.T @ of_blocks) @ bread))
    return found.x, errors, np.sqrt((found.fun**2).mean()), len(force_n)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clone", type=Path, help="clone of eliasoa/TTK4900_CDPR")
    parser.add_argument("out", type=Path, help="folder for the robot files and the logs")
    arguments = parser.parse_args()
    missing = [run for run in RUNS if not recording(arguments.clone, run).is_file()]
    if missing:
        sys.exit(f"{arguments.clone} has no {recording(Path(), missing[0])}: it is no clone of eliasoa/TTK4900_CDPR.")
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "robot.toml").write_text(ROBOT.format(log=""))
    for mass in (1.0, 5.0):
        (arguments.out / f"{mass:.0f}kg.toml").write_text(robot_of_load(mass))
    runs = [read_run(recording(arguments.clone, run), mass_kg(run)) for run in RUNS]
    for run, signals in zip(RUNS, runs, strict=True):
        header = "time_s,winch.force_n,winch.length_m,winch.speed_m_per_s,winch.reference_n"
        path = arguments.out / f"{run.replace('/', '-')}.csv"
        np.savetxt(path, np.column_stack(signals), fmt="%.9g", delimiter=",", header=header, comments="")
    values, errors, rms_n, count = fit(runs)
    print(f"least squares over {count} samples that slide, rms of the rest {rms_n:.3f} N; ± is one standard error")
    for name, value, error in zip(NAMES, values, errors, strict=False):
        print(f"  {name:18} {value:9.4f} ± {error:.4f}")
    for ripple, pair, error in zip(RIPPLES, values[5:].reshape(-1, 2), errors[5:].reshape(-1, 2), strict=True):
        period_mm = 1e3 * abs(LENGTH_M_PER_TURN) / ripple
        print(f"  {ripple} a turn ({period_mm:.3f} mm): {np.hypot(*pair):.3f} N; sine {pair[0]:.3f} ± {error[0]:.3f}, cosine {pair[1]:.3f} ± {error[1]:.3f}")


if __name__ == "__main__":
    main()
