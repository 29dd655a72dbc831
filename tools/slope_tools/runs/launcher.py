"""How the ranks of a run are started: by mpirun, or by what --launcher names. The one place that knows."""
import os
import shlex
import shutil
from typing import List, Optional

from ..errors import SlopeError

RANKS = "{np}"


def list_launcher_words(start: Optional[str], ranks: int, slots: int) -> List[str]:
    """The words before the program; start: of --launcher, or None; slots: what mpirun takes as its number of slots."""
    if start:
        given = shlex.split(start)
        found = shutil.which(given[0])
        if found and not os.path.isabs(found):      # a run is started in a folder of its own
            given[0] = os.path.abspath(found)
        if any(RANKS in word for word in given):
            return [word.replace(RANKS, str(ranks)) for word in given]
        return [*given, "-n", str(ranks)]
    if ranks == 1:
        return []
    return ["mpirun", "-np", str(ranks), "--bind-to", "none", *(["--oversubscribe"] if ranks > slots else [])]


def able(start: Optional[str]) -> bool:
    """Whether runs can have several ranks."""
    return start is not None or shutil.which("mpirun") is not None


def check_launcher(start: Optional[str], ranks: int) -> None:
    """Raise SlopeError unless the launcher is there."""
    if start is None:
        if ranks > 1 and not able(start):
            raise SlopeError("--np", "needs mpirun, which is not on the PATH, unless it is 1 (or --launcher)", ranks)
        return
    try:
        given = shlex.split(start)
    except ValueError as error:
        raise SlopeError("--launcher", f"must be a command ({error})", start) from None
    if not given or not shutil.which(given[0]):
        raise SlopeError("--launcher", "must begin with a program on the PATH", start)
