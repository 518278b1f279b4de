"""Makes a robot file and two logs for fric-cli from the recordings of the linear drive EMPS.

    python emps.py CLONE OUT

CLONE is a clone of https://github.com/forgi86/sysid-neural-continuous, which distributes the benchmark of A. Janot, M. Gautier and M. Brunot
(Data Set and Reference Models of EMPS, Workshop on Nonlinear System Identification Benchmarks, 2019) under the Apache License 2.0. OUT is the
folder for `robot.toml`, `drive.csv` and `pulses.csv`. Needs numpy and scipy. docs/recordings.md has what to do with them.

Motor, ball screw and carriage stand for winch, pulley and platform: the motor pulls on a cable whose pretension is known. The force of the
motor is its voltage times the published gain of the drive. In the second recording pulses of force disturb the drive.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import scipy.io

RECORDINGS = {"drive": "DATA_EMPS.mat", "pulses": "DATA_EMPS_PULSES.mat"}
PRETENSION_N = 1000.0
ROBOT = f"""format = "fric-robot/1"
name = "emps"
cycle_s = 0.001
[log]
reference = {{ constant_n = {PRETENSION_N} }}
[log.columns]
"drive.force_n" = {{ column = "motor_force_n", offset = {PRETENSION_N} }}
"drive.length_m" = {{ column = "position_m", factor = -1.0, offset = 1.0 }}
[[cable]]
name = "drive"
pulleys = [{{ wrap_deg = 180.0 }}]
friction = {{ mu = 0.01, sigma_n_per_m = 1e5, viscous_n_s_per_m = 100.0 }}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clone", type=Path)
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "robot.toml").write_text(ROBOT)
    for name, file in RECORDINGS.items():
        path = arguments.clone / "examples" / "EMPS" / "data" / file
        if not path.exists():
            sys.exit(f"{path} is not there; clone https://github.com/forgi86/sysid-neural-continuous")
        data = {key: np.ravel(value) for key, value in scipy.io.loadmat(path).items() if not key.startswith("__")}
        force_n = data["gtau"] * data["vir"]
        columns = np.column_stack([data["t"], data["qm"], force_n])
        header = "time_s,position_m,motor_force_n"
        np.savetxt(arguments.out / f"{name}.csv", columns, delimiter=",", header=header, comments="", fmt="%.9g")


if __name__ == "__main__":
    main()
