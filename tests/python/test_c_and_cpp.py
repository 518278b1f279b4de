"""libfric as a user has it: `make install`, CMake and pkg-config, the examples, and the bits of `fric-cli replay`."""

import json
import math
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pandas as pd
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from support import ARM, LOG, ROBOT, ROOT, run, started
from tools import hint, program

import fric
from fric import continuum

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="`make install` is for Linux")

WARNINGS = "-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Werror"
ROW_COUNT = 6000


def tool(package):
    """A program of the system."""
    found = program(package)
    assert found, hint([package])
    return found


def call(*command, **options):
    """What a command prints; fails with all of it."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """Where `make install` has put the library, away from this repository."""
    prefix = tmp_path_factory.mktemp("prefix") / "usr"
    call("make", "--no-print-directory", "-C", ROOT, "install", "PROFILE=dev", f"PREFIX={prefix}")
    return prefix


@pytest.fixture(scope="module")
def examples(prefix, tmp_path_factory):
    """The built programs of `examples/c` and `examples/cpp`, each from a folder of its own."""
    tool("g++")
    programs = {}
    for language in ["c", "cpp"]:
        folder = tmp_path_factory.mktemp(language)
        source = shutil.copytree(ROOT / "examples" / language, folder / "source")
        flags = [f"-DCMAKE_{compiler}_FLAGS={WARNINGS}" for compiler in ["C", "CXX"]]
        call(tool("cmake"), "-S", source, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={prefix}", *flags)
        call("cmake", "--build", folder / "build")
        programs[language] = folder / "build"
    return programs


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    """The first rows of the example log as CSV."""
    path = tmp_path_factory.mktemp("rows") / "rows.csv"
    table = fric.read_log(LOG).to_pandas().iloc[:ROW_COUNT]
    table.to_csv(path, index=False)
    return path


@pytest.fixture(scope="module")
def few_rows(rows):
    """The first of them, for runs in slow motion."""
    path = rows.with_name("few.csv")
    path.write_text("".join(rows.read_text(encoding="utf-8").splitlines(keepends=True)[:300]), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def outcome(examples, rows, tmp_path_factory):
    """What the C++ example makes of the rows."""
    path = tmp_path_factory.mktemp("outcome") / "out.csv"
    call(examples["cpp"] / "replay", ROBOT, rows, path)
    return numbers(path)


def numbers(path):
    """A table as written, to the last bit, whichever version of pandas reads it."""
    table = pd.read_csv(path, dtype=str)
    return table.astype({name: np.int64 if name == "stamp_nanos" else float for name in table})


COMPILERS = {"c": ("gcc", "c", "c11"), "cpp": ("g++", "c++", "c++17")}


def blocks_of_the_docs(language):
    """Page and text of each block of a language in the docs."""
    pages = sorted((ROOT / "docs").glob("*.md"))
    pattern = rf"^```{language}\n(.*?)^```$"
    return [(page.name, text) for page in pages for text in re.findall(pattern, page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)]


@pytest.mark.parametrize("language", COMPILERS)
def test_what_the_docs_show_compiles(language, prefix, tmp_path):
    compiler, name, standard = COMPILERS[language]
    tool("g++")
    blocks = blocks_of_the_docs(language)
    assert blocks
    for page, text in blocks:
        # What is no program is the inside of a function.
        includes, body = ("".join(line for line in text.splitlines(keepends=True) if line.startswith("#") == is_include) for is_include in (True, False))
        source = text if " main(" in text else f"{includes}void shown();\nvoid shown() {{\n{body}}}\n"
        program = tmp_path / f"{page}.out"
        libraries = [f"-I{prefix}/include", f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"]
        mode = ["-o", program] if " main(" in text else ["-c", "-o", tmp_path / "shown.o"]
        call(compiler, f"-std={standard}", "-x", name, "-", "-x", "none", *libraries, *mode, "-lfric", input=source)


def test_the_tutorial_s_programs_print_what_the_model_s_equations_give(prefix, tmp_path):
    """Equations 10 and 11 of the paper by hand: 10 N on a sensor pulley of 180°, then 90°, μ = 0.02, F_pv = 0.3 N s/m, 0.05 m/s."""
    text = (ROOT / "docs" / "tutorial-control.md").read_text(encoding="utf-8")
    (tmp_path / "winch.toml").write_text(re.search(r"^```toml\n(format.*?)^```$", text, re.MULTILINE | re.DOTALL)[1], encoding="utf-8")
    expected = []
    for speed in (0.05, -0.05):
        sense = math.copysign(1.0, speed)
        behind_sensor = (10.0 * (2.0 + sense * 0.02 * 2.0) + 2.0 * 0.3 * speed) / 4.0
        behind = sense * 0.02 * 2.0 * math.sin(math.radians(45.0))
        expected.append((behind_sensor * (2.0 + behind) + 2.0 * 0.3 * speed) / (2.0 - behind))
    for language, forces in (("c", expected[:1]), ("cpp", expected)):
        compiler, name, standard = COMPILERS[language]
        [source] = [block for page, block in blocks_of_the_docs(language) if page == "tutorial-control.md"]
        libraries = [f"-I{prefix}/include", f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"]
        flags = WARNINGS.split()
        call(compiler, f"-std={standard}", *flags, "-x", name, "-", "-x", "none", *libraries, "-o", tmp_path / language, "-lfric", input=source)
        printed = call(tmp_path / language, cwd=tmp_path)
        assert printed == "".join(f"{force:.3f} N at the platform, status 0\n" for force in forces)


STANDARDS = {
    "fric.h": ("c", ["c99", "c11", "c17", "c2x"], ""),
    "fric.hpp": ("c++", ["c++17", "c++20", "c++2b"], "-Wold-style-cast"),
}


@pytest.mark.parametrize("header", STANDARDS)
@pytest.mark.parametrize("package", ["g++", "clang"])
def test_headers_compile_without_a_warning(package, header):
    language, standards, extra = STANDARDS[header]
    compiler = program(package)
    if compiler is None:
        pytest.skip(hint([package]))
    flags = f"{WARNINGS} {extra} -fsyntax-only".split()
    folder = ROOT / "crates/fric-capi/include"
    for standard in standards:
        source = f"#include <{header}>\n"
        call(compiler, f"-std={standard}", *flags, f"-I{folder}", f"-x{language}", "-", input=source)


def test_a_zero_byte_in_a_text_of_cpp_is_refused(prefix, tmp_path):
    source = tmp_path / "zero.cpp"
    source.write_text(
        """
        #include <fric.hpp>
        #include <iostream>
        int main() {
            try { fric::Compensator::from_text(std::string("format = 1\\0", 11)); }
            catch (const fric::Error& error) { std::cout << error.what(); }
        }
        """,
        encoding="utf-8",
    )
    libraries = [f"-L{prefix}/lib", "-lfric", f"-Wl,-rpath,{prefix}/lib"]
    call("g++", "-std=c++17", "-Wno-unused-result", f"-I{prefix}/include", source, *libraries, "-o", tmp_path / "zero")
    assert "zero byte" in call(tmp_path / "zero")


def test_the_c_example_agrees_with_python(examples):
    text = call(examples["c"] / "cycle", ROBOT)
    compensator = fric.Compensator(fric.Robot.read(ROBOT))
    pose = {"position_m": np.zeros(3), "orientation_xyzw": np.array([0.0, 0.0, 0.0, 1.0])}
    for cycle in range(1000):
        force_n, length_m = 15.0 + 1e-3 * (cycle % 10), 0.05 * 0.001 * cycle
        last = compensator.step(np.full(8, force_n), np.full(8, length_m), np.full(8, 0.05), **pose)
    forces_n = [float(value) for value in re.findall(r"([\d.]+) N at the platform", text)]
    assert text.startswith("mini-ipanema\n") and text.count("status ok\n") == 8
    assert np.allclose(forces_n, last.force_at_platform_n, rtol=0, atol=5.01e-5)
    assert "applied force" in text


# Bends with reversals of all sizes, one that repeats itself within what is held, and one out of reach.
PATH_RAD = [0.3, 0.9, 0.9004, 0.88, 0.89, 0.5, 0.52, 9.0, 1.4, 1.1, 0.2]


def model(**drive):
    """The static model as the examples have it."""
    return continuum.StaticModel(continuum.Manipulator.read(ARM), greatest_tension_n=[3.0, 0.0], **drive)


def test_the_c_example_of_an_arm_has_the_bits_of_python(examples):
    name, *lines = call(examples["c"] / "arm", ARM).splitlines()
    assert name == "tendon-prototype"
    python = model()
    for line, bend_rad in zip(lines, [0.3, 0.9, 0.88, 0.89, 0.5, 0.52, 1.4, 1.1, 0.2], strict=True):
        command = python.tension_for(bend_rad=bend_rad)
        shape = python.solve(command.base_tension_n)
        lost_n = command.base_tension_n[0] - shape.tension_n[0, -1]
        numbers = [float(number) for number in re.findall(r"-?[\d.]+(?:e-?\d+)?", line)]
        assert numbers == [shape.bend_rad, command.base_tension_n[0], *shape.disk_position_m[-1], lost_n]
        assert ("turns round" in line) == bool(command.status & continuum.GoalStatus.REVERSAL)
        assert ("dead band" in line) == bool(command.status & continuum.GoalStatus.DEAD_BAND)
        assert "missed" not in line
    assert sum("turns round" in line for line in lines) >= 4


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A path of bends for the loop around an arm."""
    path = tmp_path_factory.mktemp("path") / "path.csv"
    path.write_text("bend_rad\n" + "".join(f"{bend_rad}\n" for bend_rad in PATH_RAD), encoding="utf-8")
    return path


def test_the_cpp_example_of_an_arm_has_the_bits_of_python(examples, path, tmp_path):
    told = call(examples["cpp"] / "arm_loop", ARM, path, tmp_path / "out.csv")
    assert told == f"tendon-prototype: {len(PATH_RAD)} goals, 1 out of reach\n"
    python = model(hold_rad=1e-3)
    for row in numbers(tmp_path / "out.csv").itertuples():
        command = python.tension_for(bend_rad=row.wanted_rad)
        shape = python.solve([1e-4 * float(int(command.base_tension_n[0] / 1e-4 + 0.5)), 0.0])
        ours = [command.base_tension_n[0], shape.bend_rad, *shape.disk_position_m[-1], shape.tension_n[0, -1]]
        assert ours == [row.tension_n, row.bend_rad, row.tip_x_m, row.tip_y_m, row.tip_tension_n]
        assert (command.status, shape.status) == (row.goal_status, row.shape_status)
        assert (row.goal_status == continuum.GoalStatus.HELD) == (row.wanted_rad == 0.9004)


def test_the_cpp_example_has_the_bits_of_the_command_line(outcome, tmp_path):
    replayed = tmp_path / "replayed.mcap"
    run("replay", LOG, "-o", replayed)
    efforts = {"/fric/cable_forces": [], "/fric/friction": []}
    wrenches = []
    with open(replayed, "rb") as file:
        for _, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            if channel.topic in efforts and len(efforts[channel.topic]) < ROW_COUNT:
                efforts[channel.topic].append(list(message.effort))
            elif channel.topic == "/fric/wrench" and len(wrenches) < ROW_COUNT:
                stamp = message.header.stamp
                force, torque = message.wrench.force, message.wrench.torque
                six = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
                wrenches.append([stamp.sec * 1_000_000_000 + stamp.nanosec, *six])
    for column, topic in [("force_at_platform_n", "/fric/cable_forces"), ("friction_n", "/fric/friction")]:
        ours = outcome[[f"{column}.cable{number}" for number in range(1, 9)]].to_numpy()
        assert np.array_equal(ours.view(np.int64), np.array(efforts[topic]).view(np.int64))
    columns = ["force_n.x", "force_n.y", "force_n.z", "torque_nm.x", "torque_nm.y", "torque_nm.z"]
    ours = outcome.set_index("stamp_nanos")[columns]
    both = [(ours.loc[stamp].to_numpy(), np.array(six)) for stamp, *six in wrenches if stamp in ours.index]
    assert len(both) > ROW_COUNT - 10
    assert all(np.array_equal(one.view(np.int64), other.view(np.int64)) for one, other in both)


def test_under_valgrind_there_is_no_error_and_no_leak(examples, few_rows, path, outcome, tmp_path):
    arguments = [ROBOT, few_rows, tmp_path / "out.csv"]
    arm = [examples["cpp"] / "arm_loop", ARM, path, tmp_path / "arm.csv"]
    checks = ["--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=definite,indirect,possible"]
    for program in [[examples["cpp"] / "replay", *arguments], [examples["c"] / "cycle", ROBOT], arm]:
        call(tool("valgrind"), "--quiet", *checks, *program)
    under_valgrind = numbers(tmp_path / "out.csv")
    assert under_valgrind.equals(outcome.iloc[: len(under_valgrind)])


def functions(profile):
    """Names of the functions that callgrind has seen running."""
    return set(re.findall(r"^c?fn=\(\d+\) (.+)$", profile.read_text(encoding="utf-8"), re.MULTILINE))


def test_after_set_up_nothing_allocates(examples, few_rows, path, tmp_path):
    """Every function that runs between the first cycle and the last, by callgrind; `malloc` and the kernel are not there."""

    replay = [examples["cpp"] / "replay", ROBOT, few_rows, tmp_path / "out.csv"]

    def seen(start, program):
        profile = tmp_path / f"{start}.out"
        options = ["--tool=callgrind", f"--toggle-collect={start}", f"--callgrind-out-file={profile}"]
        call(tool("valgrind"), *options, *program)
        return functions(profile)

    def allocating(names):
        plain = r"_*(malloc|calloc|realloc|free|posix_memalign|aligned_alloc|mmap|munmap|s?brk)"
        return {name for name in names if re.match(rf"({plain}$|operator (new|delete)|.*__rust_(alloc|realloc))", name)}

    arm = seen("run_cycles*", [examples["cpp"] / "arm_loop", ARM, path, tmp_path / "arm.csv"])
    assert any("fric_static_model_solve" in name for name in arm) and any("tension_for" in name for name in arm)
    assert allocating(arm) == set()
    cycle = seen("run_cycles*", replay)
    assert any("fric_step" in name for name in cycle) and any("step_into" in name for name in cycle)
    assert allocating(cycle) == set()
    assert "malloc" in allocating(seen("fric_load_file", replay)), "the check does not see allocations"


def test_the_control_loop_takes_no_page_and_no_memory(examples, few_rows):
    done = subprocess.run([examples["cpp"] / "control_loop", ROBOT, few_rows, "1"], capture_output=True, text=True, check=False)
    assert done.stderr == "" and "1000 cycles, 0 flagged" in done.stdout, done
    assert re.search(r"wake-up +[\d.]+ .*\nstep +[\d.]+", done.stdout)
    taken = re.search(r"(\d+) minor and (\d+) major page faults, (-?\d+) bytes", done.stdout)
    if "memory is not locked" not in done.stdout:
        assert taken.groups() == ("0", "0", "0") and done.returncode == 0, done
    assert taken[3] == "0"


def test_the_control_loop_skips_the_cycles_that_it_has_overslept(examples, few_rows):
    """Half a second asleep in the midst of two: the cycles of that time are skipped, not made up for."""
    command = [examples["cpp"] / "control_loop", ROBOT, few_rows, "2"]
    with started(*command) as loop:
        time.sleep(1.0)
        loop.send_signal(signal.SIGSTOP)
        time.sleep(0.5)
        loop.send_signal(signal.SIGCONT)
        told, _ = loop.communicate()
    overruns, skipped = map(int, re.search(r"(\d+) overruns, (\d+) cycles skipped", told).groups())
    assert overruns >= 1 and skipped >= 400, told
    assert "2000 cycles, 0 flagged" in told, told


# Each effect of the catalogue, acting.


def example_of(path):
    """The example of itself that a file of the catalogue states, as in a robot file."""
    text = path.read_text(encoding="utf-8")
    kind = re.search(r'kind: "(\w+)"', text)[1]
    parameters = text[text.index("parameters: &") : text.index("example: &[")]
    keys = re.findall(r'(?:fitted|setting|size)\(\s*"(\w+)"', parameters)
    if "ripple::rows" in parameters:
        keys = [*re.findall(r'\["(\w+)", "(\w+)"\]', parameters)[0], "period_m"]
    values = re.search(r"example: &\[(.*?)\]", text, re.DOTALL)[1].strip(" \n,").split(",")
    values = [float(value.replace("_", "")) for value in values]
    # A parameter that several effects share is defined elsewhere; it is 0, as without it.
    assert kind == path.stem and not any(values[len(keys) :])
    return ", ".join([f'kind = "{kind}"', *(f"{key} = {value}" for key, value in zip(keys, values, strict=False))])


# One of each kind, and those whose other sign takes another path.
CATALOGUE = (ROOT / "crates/fric-core/src/effects").glob("*.rs")
ALL_EFFECTS = [example_of(path) for path in sorted(CATALOGUE) if path.stem not in ("mod", "friction", "ripple")]
EFFECTS = [
    *ALL_EFFECTS,
    'kind = "presliding_shape", exponent = 0.5',
    'kind = "time_delay", delay_s = -0.004',
]


def write_robot(path, cable_count, effects, keys="", monitor="", pulleys=None):
    """The example robot with as many cables, every one with these effects and keys."""
    head, *cables = ROBOT.read_text(encoding="utf-8").split("[[cable]]\n")
    listed = ", ".join(f"{{ {effect} }}" for effect in effects)
    text = head + monitor
    for index in range(cable_count):
        cable = re.sub(r'name = "\w+"', f'name = "cable{index + 1}"', cables[index % len(cables)])
        if pulleys:
            cable = re.sub(r"pulleys = \[.*?\n\]", lambda _: f"pulleys = [{pulleys}]", cable, flags=re.DOTALL)
        text += "[[cable]]\n" + cable.replace("friction = {", f"{keys}effects = [{listed}]\nfriction = {{")
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def shipped(tmp_path_factory):
    """Where `make install` has put the optimised library."""
    prefix = tmp_path_factory.mktemp("shipped") / "usr"
    call("make", "--no-print-directory", "-C", ROOT, "install", f"PREFIX={prefix}")
    return prefix


def compiled(source, prefix, folder):
    """A program of `crates/fric-capi/tests`."""
    program = folder / source.removesuffix(".c")
    libraries = [f"-L{prefix}/lib", "-lfric", "-lm", "-pthread", f"-Wl,-rpath,{prefix}/lib"]
    flags = ["-std=c11", "-O1", *WARNINGS.split(), f"-I{prefix}/include"]
    call("gcc", *flags, ROOT / "crates/fric-capi/tests" / source, *libraries, "-o", program)
    return program


MONITORED = "[monitor]\nlength_noise_m = 1e-5\nfrozen_cycles = 20\n\n"
LIMITED = "traction_mu = 0.1\nvalidated = { force_n = [2.0, 30.0], speed_m_per_s = 0.1 }\n"


@pytest.mark.skipif(platform.machine() != "x86_64", reason="other processors need not have traps")
@pytest.mark.parametrize("library", ["prefix", "shipped"])
@pytest.mark.parametrize(
    ("cable_count", "keys", "monitor"), [(8, "", ""), (5, LIMITED, MONITORED), (1, "", MONITORED), (17, LIMITED, "")]
)
def test_no_operation_is_invalid_on_finite_signals(request, tmp_path, library, cable_count, keys, monitor):
    """Each effect, all together and none, in both forms of presliding; in lanes without a cable too."""
    program = compiled("traps.c", request.getfixturevalue(library), tmp_path)
    sets = [[], *([effect] for effect in EFFECTS), ALL_EFFECTS]
    robots = []
    for presliding in ["per_pulley", "lumped"]:
        for number, effects in enumerate(sets):
            path = tmp_path / f"{presliding}{number}.toml"
            robots.append(write_robot(path, cable_count, effects, f'presliding = "{presliding}"\n{keys}', monitor))
    assert math.isfinite(float(call(program, *robots)))


def test_a_file_is_loaded_with_the_stack_that_is_stated(shipped, tmp_path):
    """64 cables of eight pulleys with every effect and a slip limit; the example robot needs less."""
    header = (shipped / "include/fric.h").read_text(encoding="utf-8")
    most_kib, few_kib = map(int, re.search(r"(\d+) KiB of stack, (\d+) KiB", header).groups())
    program = compiled("stack.c", shipped, tmp_path)
    pulleys = ", ".join(["{ wrap_deg = 180.0, sensor = true }", *["{ wrap_deg = 90.0 }"] * 6])
    pulleys += ', { wrap = "pose", radius_m = 0.01, axis = [0.0, 0.0, 1.0] }'
    for cable_count, kib in [(64, most_kib), (16, few_kib), (8, few_kib)]:
        worst = write_robot(tmp_path / f"{cable_count}.toml", cable_count, ALL_EFFECTS, LIMITED, pulleys=pulleys)
        call(program, str(kib * 1024), ROBOT if cable_count == 8 else worst, worst)


def test_a_static_model_takes_the_stack_that_is_stated(shipped, tmp_path):
    """As many disks as there may be, each hole with its own friction, under weight."""
    header = (shipped / "include/fric.h").read_text(encoding="utf-8")
    kib = int(re.search(r"(\d+) KiB of stack, as all functions of a static model do", header)[1])
    text = ARM.read_text(encoding="utf-8").replace("disk_count = 8", "disk_count = 32").replace("0.037", "0.00925")
    text = text.replace("[0.0, 0.0]", "[0.0, -9.81]").replace("mu = 0.1753", f"mu = {[0.1 + 0.002 * hole for hole in range(32)]}")
    worst = tmp_path / "arm.toml"
    worst.write_text(text, encoding="utf-8")
    call(compiled("stack.c", shipped, tmp_path), str(kib * 1024), ARM, worst)


def test_pkg_config_finds_the_library(prefix, tmp_path):
    """The C example without CMake, with the shared library."""
    environment = {**os.environ, "PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig")}
    flags = call(tool("pkg-config"), "--cflags", "--libs", "fric", env=environment).split()
    program = tmp_path / "cycle"
    call("cc", "-std=c11", ROOT / "examples" / "c" / "cycle.c", *flags, f"-Wl,-rpath,{prefix / 'lib'}", "-o", program)
    assert call(program, ROBOT).startswith("mini-ipanema\n")
    assert call("pkg-config", "--modversion", "fric", env=environment).strip() == fric.__version__


def test_mistakes_are_told_in_a_sentence(examples, rows, tmp_path):
    def refused(*arguments):
        done = subprocess.run([examples["cpp"] / "replay", *arguments], capture_output=True, text=True, check=False)
        assert done.returncode == 1 and done.stderr.count("\n") == 1, done
        return done.stderr

    assert "no-such.toml" in refused("no-such.toml", rows, tmp_path / "out.csv")
    broken = tmp_path / "robot.toml"
    broken.write_text(ROBOT.read_text(encoding="utf-8").replace("mu = 0.016", "mu = 7.0"), encoding="utf-8")
    assert re.search(r"robot.toml.*line \d+.*cable1.*`mu` is 7; allowed is 0 to 0.9", refused(broken, rows, "out"))
    lacking = tmp_path / "rows.csv"
    lacking.write_text("stamp_nanos,sensor_force_n.cable1\n", encoding="utf-8")
    assert "no column 'length_m.cable1'" in refused(ROBOT, lacking, tmp_path / "out.csv")


@pytest.fixture
def cargo(tmp_path):
    """Stands in for cargo: says that it has built the shared library in these folders. The usual one holds an older library."""

    def built(*folders):
        for folder in ["debug", *folders]:
            (tmp_path / "target" / folder).mkdir(parents=True, exist_ok=True)
            for library in ["libfric.so", "libfric.a"]:
                (tmp_path / "target" / folder / library).write_text(folder, encoding="utf-8")
        paths = [[str(tmp_path / "target" / folder / library) for library in ("libfric.so", "libfric.a")] for folder in folders]
        messages = [{"reason": "compiler-artifact", "target": {"name": "fric"}, "filenames": two, "fresh": True} for two in paths]
        program = tmp_path / "cargo"
        lines = "\n".join(json.dumps(message, separators=(",", ":")) for message in [*messages, {"reason": "build-finished", "success": True}])
        program.write_text(f"#!/bin/sh\ncat <<'END'\n{lines}\nEND\n", encoding="utf-8")
        program.chmod(0o755)
        command = ["make", "--no-print-directory", "-C", ROOT, "install", "PROFILE=dev", f"PREFIX={tmp_path}/usr", f"CARGO={program}"]
        environment = {**os.environ, "CARGO_TARGET_DIR": str(tmp_path / "target")}
        return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)

    return built


def test_what_is_installed_is_what_cargo_has_built(cargo, tmp_path):
    """For another target its files are in a folder of that name, beside those of an earlier build for this machine."""
    done = cargo("riscv64gc-unknown-linux-gnu/debug")
    assert done.returncode == 0, done
    for library in ["libfric.so", "libfric.a"]:
        assert (tmp_path / "usr/lib" / library).read_text(encoding="utf-8") == "riscv64gc-unknown-linux-gnu/debug"


@pytest.mark.parametrize(
    ("folders", "words"),
    [([], "cargo has built no libfric.so of fric-capi; set build.target"), (["a/debug", "b/debug"], "for several targets; set CARGO_BUILD_TARGET")],
)
def test_nothing_is_installed_where_cargo_has_built_no_library_or_several(cargo, folders, words, tmp_path):
    done = cargo(*folders)
    assert done.returncode != 0 and words in done.stderr, done
    assert not (tmp_path / "usr").exists()


def test_destdir_is_respected(tmp_path):
    call("make", "--no-print-directory", "-C", ROOT, "install", "PROFILE=dev", "PREFIX=/opt/fric", f"DESTDIR={tmp_path}")
    root = tmp_path / "opt" / "fric"
    assert (root / "include" / "fric.hpp").is_file() and (root / "lib" / "libfric.so").is_symlink()
    assert not any(str(tmp_path) in path.read_text() for path in root.rglob("*.cmake"))
