"""What is asked of a report."""
from pathlib import Path
from typing import NamedTuple, Optional, Sequence


class Asked(NamedTuple):
    """A page on a folder; all else may be left to the tools."""
    folder: Path                                # of a study, or of a run
    shown: Optional[str] = None                 # the run of a study whose maps are shown
    section: Optional[Sequence[str]] = None     # X1 Y1 X2 Y2, the file of a line, or fall
    local: bool = False                         # that line is in local metres
    reference: Optional[Path] = None            # numbers from elsewhere
    converge: Optional[Path] = None             # of slope sensitivity --converge
