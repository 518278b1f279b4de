"""What a cycle can cost at most, in instructions, for the robot of a file: worst_case.py PROGRAM ROBOT [RUNS]

callgrind counts every instruction of every cycle on hostile signals. The bound adds up, over all instructions of the built code, the
most often that each ran in any one cycle: as if the dearest ways through all places were taken in the same cycle. Code that never ran
is not in it; how the bound grows with the number of cycles shows whether there is any left.
"""

import statistics
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

CYCLES_OF_RUN = 2000
ENTRY = "worst_case::one_cycle"


def counted(program, robot, signals):
    """Instructions of each cycle: {(object, address): count}."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "counts")
        subprocess.run(
            ["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={out}", "--dump-instr=yes", "--dump-line=no", "--combine-dumps=yes",
             f"--toggle-collect={ENTRY}", f"--dump-after={ENTRY}", program, robot, str(CYCLES_OF_RUN), str(signals)],
            check=True,
        )  # fmt: skip
        in_object, address, is_call, cycle = "", 0, False, None
        for line in out.open():
            if line.startswith("part:"):
                if cycle:
                    yield cycle
                cycle = defaultdict(int)
            elif line.startswith("ob="):
                in_object = line.split("(")[1].split(")")[0]
            elif line.startswith("calls="):
                is_call = True
            elif line[0] in "0+-*":
                place, count = line.split()
                address = int(place, 16) if place[0] == "0" else address + int(place.replace("*", "0"))
                # The line of a call has the cost of what it calls, which is counted where it stands.
                if not is_call:
                    cycle[in_object, address] += int(count)
                is_call = False
        if cycle:
            yield cycle


def main(program, robot, runs=10):
    calm = [sum(cycle.values()) for cycle in counted(program, robot, "calm")]
    print(f"calm signals: {statistics.median(calm):.0f} instructions a cycle, {max(calm)} in the dearest of {len(calm)}")
    most, greatest, cycles = Counter(), 0, 0
    for run in range(int(runs)):
        for cycle in counted(program, robot, run):
            most |= Counter(cycle)
            greatest = max(greatest, sum(cycle.values()))
            cycles += 1
        print(f"hostile signals, {cycles} cycles: {greatest} in the dearest, at most {most.total()}")


if __name__ == "__main__":
    main(*sys.argv[1:])
