"""Makes a robot file and two logs for fric-cli from the recordings of the four-cable robot IRMA4U.

    python irma4u.py CLONE OUT

CLONE is a clone of https://github.com/fzoffoli/UACDPR_SelfCalibration, OUT the folder for `robot.toml`, `medium_a.csv` and
`final.csv`. Needs numpy and scipy. docs/recordings.md has what to do with them.

Four lengths do not fix the six numbers of a pose. The inclinometer gives two more, and the swivel angles of the pulleys and the
inclinometer's yaw help: the pose of each sample is the one that meets all of them best.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import scipy.io
from scipy.spatial.transform import Rotation

CABLES = 4
RECORDINGS = {"medium_a": "sc_27_medium_a.log", "final": "sc_27_final.log"}
GEOMETRY = "libs/config/IRMA4U_Mar25.mat"

# The controller counted with other metres per motor increment than the winches have (FixActuatorsTransmissionRatio.m).
LOGGED_M_PER_COUNT = np.array([2.747236952757055e-08, 2.732421689203843e-08, 2.713028601161863e-08, 2.731442160182809e-08])
TRUE_M_PER_COUNT = 2.676436866832799e-08
# Each log begins in the home pose, whose lengths and swivel angles are known (CdprDataHandling.m); then logging stops for a while.
HOME_LENGTHS_M = np.array([2.27254824660233, 2.27300821626030, 2.27300821626030, 2.27254824660233])
HOME_SWIVELS_RAD = 0.568104732474427 * np.array([1.0, -1.0, 1.0, -1.0])
LOGGING_STOP_S = 2.0

# What each signal may be off by: lengths, swivel angles, roll and pitch, yaw.
LENGTH_ERROR_M = 0.002
SWIVEL_ERROR_RAD = np.radians(1.0)
TILT_ERROR_RAD = np.radians(0.3)
YAW_ERROR_RAD = np.radians(3.0)


class Robot:
    """The geometry: where cables enter the swivelling pulleys, about which axis these swivel, and where cables hold the platform."""

    def __init__(self, clone):
        described = scipy.io.loadmat(clone / GEOMETRY, squeeze_me=True, struct_as_record=False)["s"]
        platform, pulleys = described.EndEffector.Platform, described.Trasmission.Pulley
        self.mass_kg = float(platform.m)
        self.center_of_mass_m = np.asarray(platform.PtoG, dtype=float)
        self.platform_m = np.array([np.asarray(point, dtype=float) for point in platform.points])
        self.base_m = np.array([pulley.CableEnterPosition for pulley in pulleys], dtype=float)
        self.radius_m = np.array([pulley.r for pulley in pulleys], dtype=float)
        frames = np.array([[np.asarray(axis, dtype=float) for axis in pulley.FixedFrame] for pulley in pulleys])
        self.zero, self.quarter, self.axis = frames[:, 0], frames[:, 1], frames[:, 2]

    def lengths_and_swivels(self, poses):
        """Cable lengths from the entry into the pulley on (m) and swivel angles (rad) in poses (x, y, z, roll, pitch, yaw)."""
        rotation = Rotation.from_euler("XYZ", poses[:, 3:]).as_matrix()
        attachment = poses[:, None, :3] + np.einsum("nij,cj->nci", rotation, self.platform_m)
        offset = attachment - self.base_m
        along = np.einsum("nci,ci->nc", offset, self.axis)
        across = offset - along[..., None] * self.axis
        from_centre = np.linalg.norm(across, axis=2) - self.radius_m
        to_centre = np.hypot(from_centre, along)
        # The free cable is a tangent to the pulley; the rest of the length lies on it.
        tangent = np.arctan2(along, from_centre) + np.arccos(self.radius_m / to_centre)
        lengths = self.radius_m * (np.pi - tangent) + np.sqrt(to_centre**2 - self.radius_m**2)
        swivels = np.arctan2(np.einsum("nci,ci->nc", offset, self.quarter), np.einsum("nci,ci->nc", offset, self.zero))
        return lengths, swivels

    def poses(self, log):
        """The pose that meets the signals of each sample best, by Gauss and Newton's method for all samples at once."""

        def deviations(poses):
            lengths, swivels = self.lengths_and_swivels(poses)
            return np.hstack([
                (lengths - log["lengths_m"]) / LENGTH_ERROR_M,
                (swivels - log["swivels_rad"]) / SWIVEL_ERROR_RAD,
                (poses[:, 3:5] - log["angles_rad"][:, :2]) / TILT_ERROR_RAD,
                (poses[:, 5:] - log["angles_rad"][:, 2:]) / YAW_ERROR_RAD,
            ])

        poses = np.hstack([np.tile([0.0, 0.0, 0.5], (len(log["time_s"]), 1)), log["angles_rad"]])
        for _ in range(50):
            now = deviations(poses)
            steps = 1e-6 * np.eye(6)
            jacobian = np.stack([(deviations(poses + step) - now) / 1e-6 for step in steps], axis=2)
            normal = np.einsum("nji,njk->nik", jacobian, jacobian)
            change = np.linalg.solve(normal, np.einsum("nji,nj->ni", jacobian, now)[..., None])[..., 0]
            poses = poses - np.clip(change, -0.3, 0.3)
            if np.abs(change).max() < 1e-7:
                return poses, deviations(poses)
        raise SystemExit("The pose of some samples is not found: signals and geometry contradict each other.")


def read_log(path):
    """The signals of a recording after the home pose, sampled at 10 Hz."""
    try:
        rows = [[float(field) for field in line.split(",")] for line in path.read_text().splitlines()]
    except (OSError, ValueError) as error:
        raise SystemExit(f"{path} cannot be read: {error}") from error
    # Rows of kind 3 are winches, one after the other, rows of kind 5 the inclinometer.
    inclinometer = np.array([row for row in rows if row[0] == 5])
    winches = np.array([row for row in rows if row[0] == 3]).reshape(len(inclinometer), CABLES, -1)
    time_s = inclinometer[:, 1]
    home = int(np.argmax(np.diff(time_s) > LOGGING_STOP_S)) + 1
    ratio = TRUE_M_PER_COUNT / LOGGED_M_PER_COUNT
    lengths_m, swivels_rad = winches[:, :, 7] * ratio, -winches[:, :, 13]
    angles_rad = np.radians(inclinometer[:, 2:5])
    return {
        "time_s": time_s[home:],
        "lengths_m": (lengths_m - lengths_m[:home].mean(axis=0) + HOME_LENGTHS_M)[home:],
        "swivels_rad": (swivels_rad - swivels_rad[:home].mean(axis=0) + HOME_SWIVELS_RAD)[home:],
        "angles_rad": (angles_rad - [0.0, 0.0, angles_rad[:home, 2].mean()])[home:],
        "speeds_m_per_s": (winches[:, :, 8] * ratio)[home:],
        "forces_n": winches[home:, :, 9],
    }


def robot_file(robot):
    """The robot file: one pulley a cable, whose wrap follows the pose, with friction values to begin from."""

    def numbers(values):
        return "[" + ", ".join(f"{float(value)!r}" for value in values) + "]"

    text = ['format = "fric-robot/1"', 'name = "irma4u"', "cycle_s = 0.1", "", "[platform]"]
    text += [f"mass_kg = {robot.mass_kg:g}", f"center_of_mass_m = {numbers(robot.center_of_mass_m)}"]
    for cable in range(CABLES):
        pulley = f'{{ wrap = "pose", radius_m = {robot.radius_m[cable]:g}, axis = {numbers(robot.axis[cable])} }}'
        text += ["", "[[cable]]", f'name = "cable{cable + 1}"']
        text += [f"base_m = {numbers(robot.base_m[cable])}", f"platform_m = {numbers(robot.platform_m[cable])}"]
        text += [f"pulleys = [{pulley}]", "friction = { mu = 0.02, sigma_n_per_m = 3000.0, viscous_n_s_per_m = 1.0 }"]
    return "\n".join(text) + "\n"


def write_csv(path, log, poses):
    """A log with the columns that fric-cli looks for by default."""
    names, columns = ["time_s"], [log["time_s"]]
    for cable in range(CABLES):
        for suffix, signal in (("force_n", "forces_n"), ("length_m", "lengths_m"), ("speed_m_per_s", "speeds_m_per_s")):
            names.append(f"cable{cable + 1}.{suffix}")
            columns.append(log[signal][:, cable])
    names += ["pose.x_m", "pose.y_m", "pose.z_m", "pose.qx", "pose.qy", "pose.qz", "pose.qw"]
    columns += [*poses[:, :3].T, *Rotation.from_euler("XYZ", poses[:, 3:]).as_quat().T]
    np.savetxt(path, np.column_stack(columns), fmt="%.9g", delimiter=",", header=",".join(names), comments="")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clone", type=Path, help="clone of fzoffoli/UACDPR_SelfCalibration")
    parser.add_argument("out", type=Path, help="folder for the robot file and the logs")
    arguments = parser.parse_args()
    if not (arguments.clone / GEOMETRY).is_file():
        sys.exit(f"{arguments.clone} has no {GEOMETRY}: it is no clone of fzoffoli/UACDPR_SelfCalibration.")
    arguments.out.mkdir(parents=True, exist_ok=True)
    robot = Robot(arguments.clone)
    (arguments.out / "robot.toml").write_text(robot_file(robot))
    for name, recording in RECORDINGS.items():
        log = read_log(arguments.clone / recording)
        poses, deviations = robot.poses(log)
        write_csv(arguments.out / f"{name}.csv", log, poses)
        length_mm = 1e3 * LENGTH_ERROR_M * np.sqrt((deviations[:, :CABLES] ** 2).mean())
        swivel_deg = np.degrees(SWIVEL_ERROR_RAD) * np.sqrt((deviations[:, CABLES : 2 * CABLES] ** 2).mean())
        print(f"{name}.csv: {len(poses)} samples; poses meet lengths to {length_mm:.1f} mm, swivel angles to {swivel_deg:.1f}° (rms)")


if __name__ == "__main__":
    main()
