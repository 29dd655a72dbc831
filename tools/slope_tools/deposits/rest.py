"""Whether a run's deposit is at rest, by its summary: how the run ended, and what still moves then."""
from dataclasses import dataclass
from typing import Any, Mapping, Optional

from ..digits import format_measured_share, rounded

FAST = 0.1              # m/s: what is slower creeps or jitters (motion: fast_... of fix deposit/grid)
MOST_FAST = 0.01        # share of the released volume that may be faster in a deposit at rest, in older summaries
CUT = "run completed"   # what a summary calls the end of a run that no criterion ended
ENDS = {"halted": "ended by its rest criterion", CUT: "stopped at its duration",
        "time limit": "cut by a limit of computing time"}


@dataclass(frozen=True)
class Rest:
    """at_rest, and in what the run falls short of it; share: of the volume that moves, volume in m3, speed in m/s."""
    halted: bool
    ended: str
    at_rest: bool
    share: float
    threshold: float
    volume: Optional[float] = None      # these two: None in summaries that do not know them
    speed: Optional[float] = None

    @property
    def moves(self) -> str:
        """What moves: `2.3 % of the volume (940 m3) is faster than 0.1 m/s, up to 30 m/s`."""
        text = f"{format_measured_share(self.share)} of the volume"
        if self.volume is not None:
            text += f" ({rounded(self.volume, 3)} m3)"
        text += f" is faster than {self.threshold:g} m/s"
        return text if self.speed is None else f"{text}, up to {rounded(self.speed, 2)} m/s"

    @property
    def text(self) -> str:
        """`at rest`, or how it ended and what moves."""
        return "at rest" if self.at_rest else f"{self.ended}; {self.moves}"

    @property
    def short(self) -> str:
        """For a narrow table."""
        if self.at_rest:
            return "at rest"
        return "moves" if self.halted else "duration" if self.ended == ENDS[CUT] else "cut"


def state(summary: Mapping[str, Any]) -> Rest:
    """The state of a run by its summary (run_folders.load_summary).

    At rest is a deposit whose run ended by the deck's criterion of rest, and of which less than the deck's rest_share
    (1 % in older summaries) is faster than 0.1 m/s; a summary without fast_share has only the share that is faster than
    a threshold of the deck's.
    """
    reason, motion = str(summary["stop"]["reason"]), summary["motion"]
    halted, ended = reason == "halted", ENDS.get(reason, f"was written in the run ({reason})")
    if "fast_share" not in motion:
        still = motion["moving_share"] < MOST_FAST and motion["threshold"] <= FAST and not summary["moving"]
        return Rest(halted, ended, halted and still, motion["moving_share"], motion["threshold"])
    share, most = float(motion["fast_share"]), float(motion.get("rest_share", MOST_FAST))
    return Rest(halted, ended, halted and share < most, share, FAST, motion["fast_volume"], motion["fast_speed"])
