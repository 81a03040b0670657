"""What the Python engines of the league share: the scenes, the clock, the file of a run."""

import json
import math
import sys
import time
from pathlib import Path


def scenes():
    return json.loads(Path(sys.argv[1]).read_text())


def steps(world, step, state):
    """One world's trajectory: `step` advances it, `state` gives 13 numbers for each body.

    Times are of the processor, not of the clock: other programs run beside.
    """
    ms, frames = [], []
    for number in range(1, world["steps"] + 1):
        start = time.process_time()
        step()
        ms.append(1e3 * (time.process_time() - start))
        if number % world["every"] == 0:
            numbers = [float(x) for body in state() for x in body]
            frames.append([x if math.isfinite(x) else None for x in numbers])
    return {"ms": ms, "frames": frames}


def write(engine, version, setting, worlds):
    run = {"engine": engine, "version": version, "setting": setting, "is_wasm": False, "worlds": worlds}
    name = "".join(c if c.isalnum() else "_" for c in f"{engine} {setting}")
    Path(sys.argv[2], f"{name}.json").write_text(json.dumps(run))
    print(f"{engine} {version}, {setting}", file=sys.stderr)
