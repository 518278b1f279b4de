"""Robots in Python: every key can be edited, nothing wrong gets in."""

import copy
import pickle

import fric
import numpy as np
import pytest
from support import ROBOT


@pytest.fixture
def robot():
    return fric.Robot.read(ROBOT)


def test_a_robot_reads_as_its_file(robot):
    assert (robot.name, robot.cycle_s) == ("mini-ipanema", 0.001)
    assert robot.cable_names == tuple(f"cable{number}" for number in range(1, 9))
    assert [cable.name for cable in robot.cables] == list(robot.cable_names)
    assert robot.platform.mass_kg == 0.41 and robot.platform.gravity_m_per_s2 == (0.0, 0.0, -9.80665)
    assert robot.log.cable == "/cable_states" and robot.log.length is None
    assert robot.monitor.frozen_cycles is None
    cable = robot.cable("cable4")
    assert (cable.base_m, cable.presliding, cable.traction_mu) == ((0.55, -0.4, 0.5), "per_pulley", None)
    assert cable.pulleys[0] == {"wrap_deg": 180.0, "sensor": True}
    assert (cable.effects, cable.validated) == ((), None)
    friction = cable.friction
    assert (friction.mu, friction.sigma_n_per_m) == (0.017, 602.0)
    assert (friction.viscous_n_s_per_m, friction.offset_n) == (0.138, 0.0)


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ("", "name", "rig"),
        ("", "cycle_s", 0.002),
        ("platform", "mass_kg", 1),
        ("platform", "center_of_mass_m", [0.0, 0.1, 0.2]),
        ("platform", "inertia_kg_m2", [0.002, 0.0, 0.0, 0.002, 0.0, 0.003]),
        ("monitor", "frozen_cycles", 7),
        ("monitor", "length_noise_m", 1e-5),
        ("monitor", "sensor_jump_n", 2.5),
        ("log", "reference", "/load_cells"),
        ("log", "length", "/winches.length[:]"),
        ("cable", "name", "winch"),
        ("cable", "presliding", "lumped"),
        ("cable", "base_m", np.array([0.5, 0.25, 1.0])),
        ("cable", "traction_mu", 0.3),
        ("cable", "validated", {"force_n": (2.0, 30.0)}),
        ("cable", "effects", [{"kind": "stribeck", "ratio": 0.5, "velocity_m_per_s": 0.02}]),
        ("cable", "pulleys", [{"wrap_deg": 180.0, "sensor": True}, {"wrap_deg": np.float64(45.0)}]),
        ("friction", "mu", np.float32(0.25)),
        ("friction", "sigma_n_per_m", None),
        ("friction", "viscous_n_s_per_m", 0.5),
        ("friction", "offset_n", -0.125),
    ],
)
def test_every_key_can_be_set(robot, table, key, value):
    cable = robot.cable("cable2")
    holder = {"": robot, "cable": cable, "friction": cable.friction}.get(table) or getattr(robot, table)
    setattr(holder, key, value)
    found = getattr(holder, key)
    if isinstance(value, np.ndarray | list) and key not in ("effects", "pulleys"):
        value = tuple(value)
    assert (list(found) if isinstance(value, list) else found) == value
    assert robot != fric.Robot.read(ROBOT)
    assert fric.Robot.from_toml(robot.to_toml()) == robot


@pytest.mark.parametrize(
    ("table", "key", "value", "told"),
    [
        ("friction", "mu", 2, 'cable "cable2": `mu` is 2; allowed is 0 to 0.9'),
        ("friction", "mu", float("nan"), 'cable "cable2": `mu` is NaN, which is not a finite number; allowed is 0 to'),
        ("friction", "mu", "0.02", 'cable "cable2": `mu` is the text "0.02"; it must be a number'),
        ("friction", "mu", None, 'cable "cable2": `mu` is None; it needs a value'),
        ("friction", "mu", object(), 'cable "cable2": `mu` holds a object, which a robot file cannot; numbers'),
        ("friction", "sigma_n_per_m", 0, 'cable "cable2": `sigma_n_per_m` is 0; allowed is 0.001 to 1e12'),
        ("cable", "presliding", "lumpd", '`presliding` has an unknown value `lumpd`; did you mean `lumped`?'),
        ("cable", "name", "cable1", 'cable "cable1": `name` is the name of an earlier cable too'),
        ("cable", "base_m", None, 'cable "cable2": `platform_m` is given without `base_m`; give both or neither'),
        ("cable", "base_m", [1.0, 2.0], 'cable "cable2": `base_m` has 2 entries; it must be 3 numbers in brackets'),
        ("cable", "pulleys", [{"wrap_degg": 90}], 'cable "cable2": unknown key `wrap_degg`; did you mean `wrap_deg`?'),
        ("cable", "pulleys", [{"wrap_deg": 400}], 'cable "cable2": `wrap_deg` of pulley 1 is 400; allowed is 0 to 360'),
        ("cable", "effects", [{"kind": "stribek"}], 'names an unknown effect `stribek`; did you mean `stribeck`?'),
        ("platform", "mass_kg", -1, "`mass_kg` is -1; allowed is 0 to 1000000"),
        ("", "cycle_s", 0, "`cycle_s` is 0; allowed is 1e-6 to 10"),
    ],
)
def test_a_value_that_is_not_allowed_changes_nothing(robot, table, key, value, told):
    cable = robot.cable("cable2")
    holder = {"": robot, "cable": cable, "friction": cable.friction}.get(table) or getattr(robot, table)
    with pytest.raises(fric.ConfigError) as raised:
        setattr(holder, key, value)
    assert told in str(raised.value)
    assert isinstance(raised.value, ValueError) and isinstance(raised.value, fric.FricError)
    assert robot == fric.Robot.read(ROBOT)


def test_keys_that_belong_together_are_set_together(robot):
    cable = robot.cable("cable1")
    cable.set(base_m=None, platform_m=None, pulleys=[{"wrap_deg": 90.0}])
    assert (cable.base_m, cable.platform_m) == (None, None)
    with pytest.raises(fric.ConfigError, match="unknown key `sigma_n_m`; did you mean `sigma_n_per_m`"):
        cable.friction.set(mu=0.5, sigma_n_m=3.0)
    assert cable.friction.mu == 0.016


def test_a_misspelt_attribute_is_answered_with_the_nearest(robot):
    friction = robot.cable("cable1").friction
    for attempt in [lambda: setattr(friction, "mue", 0.1), lambda: friction.mue]:
        with pytest.raises(AttributeError, match="Friction: unknown attribute `mue`; did you mean `mu`?"):
            attempt()
    for holder, name, nearest in [(robot, "cabels", "cables"), (robot.cables[0], "frictoin", "friction")]:
        with pytest.raises(AttributeError, match=f"did you mean `{nearest}`"):
            getattr(holder, name)
    for holder, name, nearest in [
        (robot, "cycles_s", "cycle_s"),
        (robot.cables[0], "presliding_", "presliding"),
        (robot.platform, "mass", "mass_kg"),
        (robot.monitor, "frozen_cycle", "frozen_cycles"),
        (robot.log, "references", "reference"),
    ]:
        with pytest.raises(AttributeError, match=f"did you mean `{nearest}`"):
            setattr(holder, name, 1)
    with pytest.raises(fric.ConfigError, match="unknown cable `cabel1`; did you mean `cable1`?"):
        robot.cable("cabel1")


def test_values_that_play_tricks_do_no_harm(robot):
    cable = robot.cable("cable1")

    class Meddling:
        """Changes the robot while it is read."""

        def __iter__(self):
            cable.friction.mu = 0.25
            return iter([1.0, 2.0, 3.0])

    cable.base_m = Meddling()
    assert (cable.friction.mu, cable.base_m) == (0.25, (1.0, 2.0, 3.0))
    endless = []
    endless.append(endless)
    with pytest.raises(fric.ConfigError, match="`pulleys` holds a list within lists without end"):
        cable.pulleys = endless


def test_what_is_read_cannot_be_changed_unnoticed(robot):
    cable = robot.cable("cable1")
    with pytest.raises(TypeError):
        cable.base_m[0] = 1.0
    with pytest.raises(TypeError):
        cable.pulleys[0]["wrap_deg"] = 90.0


def test_copies_and_pickles_are_equal_and_apart(robot):
    for other in [copy.copy(robot), copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))]:
        assert other == robot and other is not robot
        other.cable("cable1").friction.mu = 0.5
        assert other != robot and robot != "robot"
    with pytest.raises(TypeError, match="unhashable"):
        hash(robot)
    error = fric.ConfigError("text")
    assert str(pickle.loads(pickle.dumps(error))) == "text"


def test_a_file_is_written_whole_or_not_at_all(robot, tmp_path):
    path = tmp_path / "robot.toml"
    robot.write(path)
    assert fric.Robot.read(str(path)) == robot
    before = path.read_bytes()
    robot.cycle_s = 0.002
    with pytest.raises(fric.OutputError, match="exists; choose another name") as raised:
        robot.write(path)
    assert isinstance(raised.value, OSError) and path.read_bytes() == before
    robot.write(path, force=True)
    assert fric.Robot.read(path) == robot
    with pytest.raises(fric.OutputError, match="cannot be written"):
        robot.write(tmp_path / "nowhere" / "robot.toml")
    assert [file.name for file in tmp_path.iterdir()] == ["robot.toml"]


def test_a_file_that_is_not_right_says_where(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(ROBOT.read_text(encoding="utf-8").replace("mu = 0.011", "mue = 0.011"), encoding="utf-8")
    with pytest.raises(fric.ConfigError, match=r"robot.toml, line \d+: unknown key `mue`; did you mean `mu`"):
        fric.Robot.read(path)
    with pytest.raises(fric.ConfigError, match="cannot read the robot file"):
        fric.Robot.read(tmp_path / "none.toml")
    with pytest.raises(fric.ConfigError, match="`format` is missing"):
        fric.Robot.from_toml("")
