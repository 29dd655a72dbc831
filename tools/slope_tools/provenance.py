"""Which program made a result, where and when."""
import datetime
import os
import platform
import re
import subprocess
from pathlib import Path


def version():
    """The version of the package, from the one place that has it."""
    header = Path(__file__).resolve().parents[2] / "src" / "slope_version.h"
    return re.findall(r'SLOPE_VERSION "(.*)"', header.read_text(encoding="ascii"))[0]


def now():
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")


def machine():
    """Name, processor and cores of this machine."""
    try:
        model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace"))
    except OSError:
        model = None
    return {"name": platform.node(), "system": f"{platform.system()} {platform.release()}",
            "processor": model[1] if model else platform.machine(), "cores": len(os.sched_getaffinity(0))}


def package_version():
    """What `git describe` calls the package, None where it is no git checkout."""
    try:
        done = subprocess.run(["git", "-C", Path(__file__).parent, "describe", "--always", "--tags", "--dirty"],
                              text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    except OSError:
        return None
    return done.stdout.strip() or None
