"""What a run released, compared with the body that it represents."""
import math
from typing import List, NamedTuple, Optional

from .. import digits, disk
from ..case import logs
from ..digits import format_measured_share
from ..findings import Finding
from ..releases import packing

NOTHING = 5e-5         # of a body
CUBIC = 6 / math.pi         # bulk volume of balls on a simple cubic lattice / volume of the balls
DOUBTFUL = 0.15             # the bulk factor is farther from the usual one only if the balls are not the body


class Release(NamedTuple):
    """Volumes in m3 of ground; what is not known is None."""
    released: float
    body: Optional[float]           # of the region that the balls stand for
    factor: float                   # bulk volume / volume of the balls
    from_cubic: float               # factor / (6/pi) - 1
    removed: Optional[float]        # share of the balls that delete_balls took away at the start
    packed: bool = False            # whether they began in a disordered packing, not on a lattice

    @property
    def usual(self) -> str:
        """The bulk factor where no ball is missing, as it is written."""
        return f"1/{packing.SOLID:.2f}" if self.packed else "6/pi"

    @property
    def off(self) -> float:
        """factor / (the usual one) - 1"""
        return (1 + self.from_cubic) * CUBIC / packing.BULK - 1 if self.packed else self.from_cubic

    @property
    def left_out(self):
        """Share of the body that is not released; None where the body is not known."""
        return None if self.body is None else 1 - self.released / self.body

    @property
    def text(self):
        """What a table says of it."""
        return over_runs([self])

    @property
    def doubts(self) -> List[Finding]:
        """Why the released mass may not be the body: one reason, or none."""
        also = {"released": self.released, "of_body": f" of {digits.cubic(self.body)}" if self.body else ""}
        if abs(self.off) > DOUBTFUL:
            why = "there are more balls than the body has room for" if self.off < 0 else (
                f"the balls fill only {100 / (1 + self.off):.0f} % of the body, and each stands for more ground "
                "than it has room for")
            return [Finding("bulk factor", {"factor": self.factor, "off": format_measured_share(abs(self.off)),
                                            "why": why,
                                            "usual": self.usual, "side": "below" if self.off < 0 else "above", **also})]
        if self.left_out is not None and abs(self.left_out) > DOUBTFUL:
            return [Finding("body volume", {"off": format_measured_share(abs(self.left_out)), "body": self.body,
                                            "side": "less" if self.left_out > 0 else "more", **also})]
        if self.body is None and self.removed is not None and 1 / (1 - self.removed) > 1 + DOUBTFUL:
            return [Finding("balls removed", {"off": format_measured_share(self.removed), **also})]
        return []


def over_runs(releases, factor=True):
    """The same for several runs: body, share left out, balls removed and bulk factor (or not), the range of each."""
    bodies = [f"body {one.body:,.0f} m3, {released_share(one.left_out)}" for one in releases if one.body is not None]
    words = [span(bodies)] if bodies and len(bodies) == len(releases) else ["body unknown"]
    removed = sorted(one.removed for one in releases if one.removed is not None)
    if removed and removed[-1] > 0:
        words.append(f"{span([format_measured_share(removed[0]), format_measured_share(removed[-1])])} of the balls "
                     "overlapped the slip surface " "or the ground and were removed")
    if releases and factor:
        factors = sorted(one.factor for one in releases)
        farthest = max(releases, key=lambda entry: abs(entry.off))
        side = f"{format_measured_share(abs(farthest.off))} {'above' if farthest.off > 0 else 'below'} {farthest.usual}"
        most = "at most " if factors[0] < factors[-1] else ""
        words.append(f"bulk factor {span([f'{factors[0]:.4g}', f'{factors[-1]:.4g}'])}, "
                     + (farthest.usual if abs(farthest.off) < 5e-4 else most + side)
                     + f" ({farthest.usual}: balls {'without order' if farthest.packed else 'in a cubic lattice'})")
    return "; ".join(words)


def released_share(left_out):
    """What became of the body; left_out: the share of it that is not released, < 0 if more is."""
    if abs(left_out) < NOTHING:
        return "all of it released"
    return (f"{format_measured_share(left_out)} of it not released" if left_out > 0
            else f"{format_measured_share(-left_out)} more released")


def span(texts):
    return texts[0] if texts[0] == texts[-1] else f"{texts[0]} to {texts[-1]}"


def release(summary, texts):
    """The Release of a run by its summary; texts: notes and warnings of its log."""
    about = summary.get("release") if isinstance(summary.get("release"), dict) else {}
    body, factor, off = (about.get(key) for key in ("body_volume", "bulk_factor", "from_cubic"))
    factor = factor if disk.is_finite_number(factor) and factor > 0 else summary["bulk_factor"]
    return Release(summary["volume"]["released"], body if disk.is_finite_number(body) and body > 0 else None, factor,
                   off if disk.is_finite_number(off) else factor / CUBIC - 1, logs.removed(texts), logs.packed(texts))
