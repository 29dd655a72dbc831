"""The letter with which page 1 begins and the console ends: what must be cleared, how far it goes, which share of known
events; its parts, then a sentence for each.

The number and its share are of tables/headline, the length of tables/how_far.reach(): README.md has the
whole way.
"""
from typing import Callable, List, NamedTuple, Optional, Sequence

from ..digits import percent, three
from ..seismic import chain_files
from ..sites.site_bodies import VARIABLE
from ..statistics.entries import Cause, Code, Headline, Kind, Road, Source, SweepPart
from ..statistics.withheld import UNFINISHED
from ..tables import answer_words, ensemble_types, intensity, judged, quantities, sizes, study_types, usable
from ..tables.how_far import TAIL, Reach
from ..tables.rows import finished_of
from .road_numbers import Number, read_road_numbers

Write = Callable[[str, str, float], str]        # a number of what, in which unit, as text
ALIKE = {Source.SWEEP.value: "with chosen settings", Source.ENSEMBLE.value: "with drawn settings"}
OF = {**ALIKE, Source.ENSEMBLE.value: "weighted by known events"}
EVENTS = "known events of this volume and height"
CAUSES = {Cause.RUNS.value: "chance and parameters", Cause.TRANSFER.value: "from the coarse to the detailed model",
          Cause.SIZE.value: "a still more detailed model", Cause.OTHER.value: "the other runs"}
NARROWS = {Cause.RUNS.value: "more runs, or a past event for calibration", Cause.TRANSFER.value:
           "more runs of the detailed model", Cause.SIZE.value: "a more detailed model"}
LACKS = {"no repeats": "what chance changes, as no run was repeated",
         "slip assumed": "whether, and how likely, the slope fails, and with which slip surface",
         "road on body": "what it takes to build the road anew where it lies on the mass and goes with it"}
DRY = "water in the mass or on its way, with which it would go farther"
MOST = 0.9              # of the runs of an ensemble that nothing weighs
TOLD = Code.NOT_REACHED,       # reasons that are said with the road
VOLUME = "volume to remove from the road"


class Letter(NamedTuple):
    """Volumes in m3 of ground, lengths in m along the fall path.

    released: what comes down; number: what must be cleared, None without a road; gap: of it, see entries.KnownQuantile;
    cut: degrees, of the road's edges, above which is removed; events: how many known events weigh the runs, None: none;
    reach: how far; roads: of a site with several, the worst first; lacks: kinds of findings, of what is not in it;
    size: what the size of the balls would change, a sentence without its full stop; chain: how often earthquakes block
    the road, the same; bodies: volumes of several, one of which comes down in a run; drawn: an ensemble without a
    number that no known events weigh, or that is withheld.
    """
    released: float
    number: Optional[Headline]
    gap: Optional[Sequence[float]]
    reach: Optional[Reach]
    roads: Sequence[Number]
    lacks: Sequence[str]
    size: str
    cut: Optional[float] = None
    events: Optional[int] = None
    chain: Sequence[str] = ()
    bodies: Sequence[float] = ()
    drawn: Optional[ensemble_types.Ensemble] = None


def make_letter(study: study_types.Study) -> Letter:
    """Of a study with a finished run."""
    rows, number = finished_of(study.runs), study.headline
    known = ensemble_types.weighted(study.ensemble)
    gap = next((one.gap for one in known.to_remove or () if one.share == number.share), None) \
        if known and number and number.source is Source.ENSEMBLE else None
    return Letter(max((row.released_m3 for row in rows), default=0.0), number, gap, study.reach,
                  read_road_numbers(study),
                  [*(one.kind for one in judged.limits(study, bool(study.study.repeat))),
                   *(one.kind for one in study.warnings if one.kind in LACKS)],
                  study.size.text if study.size else sizes.alone(max(
                      (row.released_m3 / row.ball_m3 for row in rows), default=0.0)),
                  study.study.road["cut_angle"] if study.study.road else None, known.events if known else None,
                  chain_files.sentences(study.chain) if study.chain and not study.chain.withheld else (),
                  [one.volume_m3 for one in study.chain.bodies if one.volume_m3 is not None] if study.chain else
                  list({row.variables.get(VARIABLE): row.released_m3 for row in rows}.values()),
                  None if number or study.chain or known and study.ensemble and not study.ensemble.withheld
                  else study.ensemble)


class Sentences(NamedTuple):
    """Sentences; empty where there is nothing to say."""
    down: str
    clear: str
    basis: str          # of which runs the number is, and what makes its band
    far: str
    roads: str
    change: str
    lacks: str
    size: str


def format_console_number(_: str, __: str, value: float) -> str:
    """A number on the console."""
    return three(value)


def write_letter(letter: Letter, write: Write = format_console_number) -> Sentences:
    number = letter.number
    clear = " ".join(map(capital, letter.chain))
    if number or letter.drawn:
        clear = describe_clearing(number, write) if number else describe_drawn(letter.drawn, write)
    basis = f"{describe_cut(letter)} {describe_basis(number, letter, write) if number else ''}".strip()
    far, roads = describe_reach(letter.reach, write, settings_of(letter.drawn)), describe_roads(letter, write)
    lacks = "; ".join([DRY, *(text for kind, text in LACKS.items() if kind in letter.lacks
                              and not (letter.chain and kind == "slip assumed"))])
    down = f"{three(letter.released)} m3 of ground would come down."
    if len(letter.bodies) > 1:
        least, most = map(three, (min(letter.bodies), max(letter.bodies)))
        down = f"{len(letter.bodies)} bodies of {least} to {most} m3 may come down."
    in_band = sizes.UNKNOWN not in letter.size and number and any(
        share.cause == Cause.SIZE.value for share in number.band)
    return Sentences(down, clear, basis, far, roads,
                     describe_change(number) if number else "", f"Not in it: {lacks}.",
                     capital(letter.size) + " The band has it." * bool(in_band))


def list_letter_lines(letter: Letter) -> List[str]:
    """For the console."""
    return ["for a letter:", *(f"  {text}" for text in write_letter(letter) if text)]


def capital(text: str) -> str:
    """A sentence of a text without its full stop."""
    return f"{text[0].upper()}{text[1:]}." if text else ""


def describe_alike_runs(study: study_types.Study) -> str:
    """The runs of a study, where each counts as much."""
    return counted(study.study.finished, settings_of(study.ensemble) or ALIKE[Source.SWEEP.value])


def settings_of(ensemble: Optional[ensemble_types.Ensemble]) -> str:
    """How the settings of its runs were chosen; empty without one."""
    if not ensemble:
        return ""
    calibrated = ensemble.design.kind == ensemble_types.CALIBRATED
    return "with calibrated settings" if calibrated else ALIKE[Source.ENSEMBLE.value]


def count_runs_of(number: Headline, source: Source) -> str:
    """How many runs of a study there are, and what kind of them."""
    part = number.paper if source is Source.SWEEP else number.ensemble
    return counted(part.runs if part else 0, OF[source.value])


def counted(runs: int, which: str = "") -> str:
    return f"{runs} run{'s' * (runs != 1)} {which}".strip()


# --- what must be cleared ---

def describe_cut(letter: Letter) -> str:
    """What to clear means."""
    drawn = letter.drawn and not letter.drawn.withheld and quantities.REMOVE in drawn_of(letter.drawn)
    if letter.cut is None or not (letter.number and letter.number.volume_m3 or drawn):
        return ""
    return ("That is what lies on it, and what beside it would slide onto it, "
            f"above {letter.cut:g} degrees from its edges.")


def describe_clearing(number: Headline, write: Write) -> str:
    """The sentence with the number, or what stands in its place."""
    if number.kind is Kind.WITHHELD:
        return ""       # page 1 begins with what is known: see describe_change()
    return {Kind.NUMBER: describe_number, Kind.FLOOR: describe_floor, Kind.OPEN: describe_open,
            Kind.NOTHING: describe_nothing}[number.kind](number, write)


def describe_number(number: Headline, write: Write) -> str:
    low, high = (write(f"{VOLUME}, {name} end", "m3", value or 0.0)
                 for value, name in ((number.low_m3, "lower"), (number.high_m3, "upper")))
    ends = f"between {low} and {high} m3"
    if not has_chance(number):
        ends += ", without what chance changes, as no run was repeated"
    elif number.open_above:
        ends = f"with 95 % confidence above {low} m3, and below {high} m3 as far as these runs go"
    else:
        ends = f"with 90 % confidence {ends}"
    return (f"{write(VOLUME, 'm3', number.volume_m3 or 0.0)} m3 must be cleared from the road; "
            f"within the model this figure lies {ends}.")


def has_chance(number: Headline) -> bool:
    """Whether what chance changes is in the band."""
    return any(one.cause == Cause.RUNS.value for one in number.band)


def describe_floor(number: Headline, write: Write) -> str:
    if number.volume_m3:
        return (f"At least {write(f'{VOLUME}, at least', 'm3', number.volume_m3)} m3 must be cleared from the road: no "
                "number to design with.")
    reached = number.road and number.road.brought.reach
    where = "" if reached else ", where the mass reaches it as known events do and no run does"
    return f"More than 0 m3 must be cleared from the road{where}; how much is not known."


def describe_open(number: Headline, write: Write) -> str:
    return (f"{write(f'{VOLUME}, of these runs', 'm3', number.volume_m3 or 0.0)} m3 must be cleared from the road by "
            "these runs, which is neither an upper nor a lower bound: no number to design with.")


def describe_nothing(number: Headline, write: Write) -> str:
    return (f"{write(VOLUME, 'm3', 0.0)} m3 must be cleared from the road, by these runs: in none does anything come "
            "to lie on it.")


def describe_drawn(ensemble: Optional[ensemble_types.Ensemble], write: Write) -> str:
    """What most runs stay within, of the quantity that counts, or why that is not said."""
    if not ensemble or ensemble.of not in ensemble.quantities:
        return ""
    if ensemble.withheld:
        return f"{capital(usable.UNUSABLE).removesuffix('.')}: {' '.join(rule.client() for rule in ensemble.withheld)}"
    return " ".join(describe_most(ensemble, key, write) for key in drawn_of(ensemble))


def drawn_of(ensemble: ensemble_types.Ensemble) -> List[str]:
    """The quantity that counts; what lies on a road is less than what must be cleared, which follows it."""
    return [key for key in (ensemble.of, quantities.REMOVE if ensemble.of == intensity.QUANTITY else None)
            if key in ensemble.quantities]


def describe_most(ensemble: ensemble_types.Ensemble, key: str, write: Write) -> str:
    """What most runs stay within; of an angle, of which the least is the farthest, from where to where they are."""
    entry, runs = ensemble.quantities[key], counted(ensemble.finished, settings_of(ensemble))
    what = capital(quantities.ALL[key].title or entry.name).removesuffix(".")
    if entry.unit == "degrees":
        low, high = (write(f"{what}, {end}", entry.unit, value)
                     for end, value in (("least", entry.smallest), ("most", entry.largest)))
        return f"{what}: {low} to {high} degrees in the {runs}; the less, the farther the mass goes."
    most = next((each for each in entry.quantiles if each.share == MOST), entry.quantiles[-1])
    which = f"{what}, of {percent(most.share)} of the runs"
    ends = " and ".join(f"{word} {write(f'{which}, {end} end', entry.unit, value)} {entry.unit}"
                        for word, end, value in (("at least", "lower", most.low), ("at most", "upper", most.high))
                        if value is not None)
    return (f"{what}: {percent(most.share)} of the {runs} stay within {write(which, entry.unit, most.value)} "
            f"{entry.unit}" + (f", with {percent(ensemble.confidence)} confidence {ends}." if ends else
                               ": the runs are too few for its bounds."))


def describe_basis(number: Headline, letter: Letter, write: Write) -> str:
    """Of which runs it is, what the others give, and what makes its band."""
    if not number.volume_m3 or not number.source:
        return ""
    source, lower = number.source, "It is the lower end, with 90 % confidence, of what"
    runs, floor = count_runs_of(number, source), number.kind is Kind.FLOOR
    beside: Optional[SweepPart]
    if source is Source.ENSEMBLE:
        many = "" if letter.events is None else f"{letter.events} recorded landslides, "
        events = f"{percent(number.share or 0.0)} of {many}{EVENTS}" + "," * bool(many)
        text = f"{lower} {events} stay within, by {runs}" if floor else f"{events} leave no more, by {runs}"
        if number.ensemble and number.ensemble.far and all(
                reason.code is not Code.BEYOND for reason in answer_words.told(number)):
            text += f"; {percent(number.ensemble.far)} go beyond all runs and may leave more than any of these"
        other, beside = Source.SWEEP, number.paper
    else:
        text = f"{lower} those of {runs} leave that leave most" if floor else \
            f"By those of {runs} that leave most" + ", with what chance may add" * has_chance(number)
        other, beside = Source.ENSEMBLE, number.ensemble
    if beside and beside.volume_m3 is not None:
        text += f"; {count_runs_of(number, other)} give {write(f'{VOLUME}, other runs', 'm3', beside.volume_m3)} m3"
    if letter.gap:
        low, high = (write(f"{VOLUME}, {end} of the gap where no run ends", "m3", value)
                     for end, value in zip(("start", "end"), letter.gap))
        text += f"; no run ends where these events do, between {low} and {high} m3, of which the larger counts"
    parts = describe_band_shares(number) if number.high_m3 is not None else ""
    return f"{text}." + (f" The band, as the root of the squares: {parts}." if parts else "")


def describe_band_shares(number: Headline) -> str:
    """What makes the band."""
    return ", ".join(CAUSES.get(one.cause, one.cause) + f" -{three(abs(one.below_m3))}" * bool(one.below_m3) +
                     f" +{three(one.above_m3)}" * bool(one.above_m3) + " m3"
                     for one in number.band if one.below_m3 or one.above_m3)


def describe_change(number: Headline) -> str:
    """Why there is no number, or what would change the one that there is."""
    reasons = [capital(answer_words.client(one)) for one in answer_words.told(number) if one.code not in TOLD]
    if number.kind in (Kind.NUMBER, Kind.NOTHING):
        parts = [one for one in number.band if one.below_m3 or one.above_m3]
        if not reasons and parts and number.volume_m3:
            most = max(parts, key=lambda part: max(part.below_m3, part.above_m3))
            return f"What would narrow the band most: {NARROWS[most.cause]}." if most.cause in NARROWS else ""
        return f"What would change it: {' '.join(reasons)}" if reasons else ""
    why = "How much must be cleared from the road is not known." if number.kind is Kind.WITHHELD else "Why:"
    return f"{why} {' '.join(reasons)}" if reasons else ""


# --- how far ---

def describe_reach(reach: Optional[Reach], write: Write, settings: str = "") -> str:
    """One sentence on how far, and by what rule; settings: of those of an ensemble, where not by their source."""
    if reach is None:
        return "How far it goes is not known: no run leaves a deposit."
    runs = reach.runs + reach.failed
    if reach.cut + reach.failed > UNFINISHED * runs:
        return (f"How far it goes is not known: {reach.cut + reach.failed} of {counted(runs)} "
                f"{'failed or ' * (reach.failed > 0)}had not come to rest at the end.")
    of_ensemble = reach.source == Source.ENSEMBLE.value
    whose = counted(reach.runs, settings if settings and of_ensemble else ALIKE.get(reach.source or "", ""))
    rule = f"by {whose}"
    if reach.events:
        rule = f"{whose} and {EVENTS} count half each; {percent(TAIL)} end before these bounds, {percent(TAIL)} beyond"
    text = f"{describe_distances(reach, write)} {reach.along} from the crown. {capital(rule)}"
    if reach.farther:
        text += f" The two differ by more than their bands: {reach.farther} go farther."
    return text + ("" if reach.events or not reach.why else f" {capital(reach.why)}")


def describe_distances(reach: Reach, write: Write) -> str:
    near, middle, last = (
        describe_beyond(reach, write) if value is None else write_length(reach, value, write, name)
        for value, name in ((reach.near_m, "near end"), (reach.middle_m, "middle"), (reach.far_m, "far end")))
    if near == last:
        return f"It goes {middle}"
    if reach.middle_m is None:
        return f"It goes {'' if near.endswith('or less') else f'{near} or more, '}in half of all cases {middle},"
    return f"It goes about {middle} ({near.removesuffix(' m') if last.endswith(' m') else near} to {last})"


def describe_beyond(reach: Reach, write: Write) -> str:
    end = f" {write('how far, end of the elevation model', 'm', reach.end_m)} m that" if reach.end_m else " way that"
    return f"beyond the{end} the elevation model shows"


def write_length(reach: Reach, value: float, write: Write, name: str) -> str:
    """Nearer than the events tell anything it may be less."""
    text = write(f"how far, {name}", "m", max(value, reach.least_m))
    return f"{text} m{' or less' * (value <= reach.least_m)}"


def describe_roads(letter: Letter, write: Write) -> str:
    """What that means for the road, or for each."""
    road = letter.number.road if letter.number else None
    both = " of both kinds" * bool(letter.number and letter.number.paper and letter.number.ensemble)
    text = describe_road_reach(road, both, write) if road else ""
    if not letter.roads:
        return text
    others = "; ".join(map(describe_road_number, letter.roads[1:]))
    return f"{text} Of {len(letter.roads)} roads this is the worst, {quoted(letter.roads[0].road)}; {others}.".strip()


def describe_road_reach(road: Road, both: str, write: Write) -> str:
    some = f"{road.brought.reach or 'none'} of {counted(road.brought.runs)}{both}"
    if road.behind_m:
        beside = write("road, beside the fall path", "m", road.behind_m)
        return (f"The road lies behind the crown or as high, {beside} m from the fall path, where {EVENTS} do not go; "
                f"{some} reach it.")
    return (f"The road begins after {write('road, near edge', 'm', road.near_m)} m: "
            f"{answer_words.format_shares(road.reached)} of {EVENTS}, and {some}, reach it.")


def describe_road_number(number: Number) -> str:
    events = f" and up to {percent(number.reached)} of known events" if number.reached else ""
    return f"{quoted(number.road)}: {number.text}, {number.reaching or 'none'} of {number.runs} runs{events} reach it"


def quoted(name: str) -> str:
    return f'"{name}"'


def title_runs(study: study_types.Study) -> str:
    """The runs of a page, for its title."""
    number = study.headline
    if not number:
        return describe_alike_runs(study)
    return " and ".join(count_runs_of(number, source) for source in Source
                        if (number.paper if source is Source.SWEEP else number.ensemble))
