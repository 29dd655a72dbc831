"""What a report shows of a run alone: its volume balance and travel, what was run, and where that comes from."""
import datetime
import re
from typing import Any, List, Optional

from .. import digits, provenance
from ..case import decks
from ..deposits import rest, travel_shares
from ..digits import percent
from ..errors import SlopeError
from ..mobility import offices, run_length
from ..mobility.body import of_arrays
from ..mobility.run_length import LEAST, OF_99, OTHERS
from . import body
from .charts import TERMS
from .data import Data, find_deck
from .numbers import farthest_of, Numbers, UNKNOWN
from .sections import Cell, Columns, Heading, Pairs, Section, Table, Verbatim, marked, verbatim

# a variable of a deck and the comment on it, which has its unit
MEANING = re.compile(r"^\s*variable\s+(\w+)\s+index\s.*?#\s*(.*?)\s*$", re.MULTILINE)


def titled(what, data: Data):
    """A title, with the run where there are several."""
    return f"{what} of the run {data.label(data.result)}" if data.study else what


def balance(data: Data, numbers: Numbers):
    """The section on the volume balance, the travel and the end of the shown run."""
    one, summary = data.result, data.result.summary
    volume, balls, stop = summary["volume"], summary["balls"], summary["stop"]
    release = next((row.release for row in data.compared if row.run in ("", one.name)), None)
    error = (one.deposit.volume - volume["released"] + volume["off_grid"] + volume["lost"]) / volume["released"]
    volumes = [("released (A)", f"{volume['released']:,.1f} m3"),
               ("on the grid of the maps (B)", f"{volume['on_grid']:,.1f} m3"),
               ("off that grid (C)", f"{volume['off_grid']:,.1f} m3"),
               ("lost, left the simulation box (D)", f"{volume['lost']:,.1f} m3, {balls['lost']:d} balls"),
               ("residual A - B - C - D", f"{volume['residual']:.1e} m3"),
               ("thickness x cell area, summed over the raster, less A - C - D", f"{error:.1e} of A"),
               ("the released mass", f"{balls['released']:d} balls; {release.text if release else UNKNOWN}")]
    state = rest.state(summary)
    status = "rest" if state.at_rest else "moving" if summary["moving"] else "doubt"
    deposit = marked(state.text, f"status {status}")
    if "change_rate" in summary:
        deposit += f"; {digits.cents(summary['change_rate'])} of the volume moves to another cell per second"
    end = [("end of the run", f"{stop['time']:.2f} s, step {stop['step']:d}, {stop['reason']}"), ("deposit", deposit),
           ("largest energy of a ball", digits.si(summary["largest"]["max_energy"], "J"))]
    if guards := summary.get("guards"):
        growth = digits.cents(guards["energy_growth"], 1)
        end += [("largest overlap, of the radius", digits.cents(guards["largest_overlap"])),
                ("growth of energy, of the largest kinetic and spring energy", growth),
                ("contacts deeper than 10 %, late neighbor lists",
                 f"{guards['deep_contacts']:d}, {guards['dangerous_builds']:d}")]
    travel = [*travel_rows(data, numbers), *(
        (what, numbers(what, "m", summary["travel"][key]), "")
        for what, key in (("farthest ball at release", "front_at_release"), ("centroid moved", "centroid")))]
    return Section("balance", titled("Volume balance and travel", data), [Columns([
        [Pairs(volumes)],
        [Table("Distance in plan from the highest released ball, and the angle below the horizontal at which it is "
               "seen from there.", ["of the deposit", Cell("distance", "m"), Cell("reach angle", "deg")], travel,
               style="keep"), Pairs(end)]])])


def for_offices(data: Data, ground, numbers: Numbers):
    """The section of what offices ask of the shown run; None where its mass has no fall path."""
    run = data.result
    path = run_length.path_of(run.deposit, run.terrain_path)
    try:
        mass = of_arrays(ground.raster._replace(z=ground.before), ground.slip_depth, "the run")
    except SlopeError:
        return None
    slope = path and offices.slope(mass, path)
    if not (path and slope):
        return None
    blocks = [over_height(slope, offices.measure_office_distances(run.deposit, path), numbers)]
    if data.road is not None:
        edge = offices.at_edge(data.road, ground.raster, ground.max_thickness, ground.max_speed)
        blocks.append(at_edge(edge, body.of_data(data, ground).density, numbers))
    return Section("offices", titled("For offices: distances over the height, pressures", data), blocks)


def over_height(slope: offices.Slope, lengths: List[float], numbers: Numbers) -> Table:
    """Distances (m, of offices.SHARES) over the height."""
    def row(share: float, length: float):
        what, beyond = f"{100 * share:g} % of the volume", max(0.0, length - slope.toe)
        return [what, *(numbers(f"{what}: {name}", unit, value) for name, unit, value in (
            ("reach", "m", length), ("reach over height", "", length / slope.height), ("from the toe", "m", beyond),
            ("from the toe over height", "", beyond / slope.height)))]
    height, twice, zone = (numbers(name, "m", value) for name, value in (
        ("height of the slope", slope.height), ("2 H", offices.HEIGHTS * slope.height),
        ("2 H, at most 50 m", slope.zone)))
    return Table(
        f"Along the fall path, from the crown and from the toe of the body; H: {height} m, from the crown down to that "
        f"toe. Beside it: 2 H is {twice} m; with 50 m at most it is {zone} m (Japan's Sediment Disaster Act for steep "
        "slopes, from their toe).",
        ["within which stays", Cell("reach", "m"), "over H", Cell("from the toe", "m"), "over H"],
        [row(share, length) for share, length in zip(offices.SHARES, lengths)])


def at_edge(edge: offices.Edge, density: Optional[float], numbers: Numbers) -> Table:
    """Depth, speed and pressures; density: bulk, kg/m3."""
    moves, lies = (density and value(density, of) / 1000 for value, of in (
        (offices.of_movement, edge.speed), (offices.of_deposit, edge.depth)))
    return Table(
        "The largest at the edges of the road, not of one time, and what follows with the bulk density rho: pressures "
        "rho v^2, where a wall stops the mass, and rho g h, at the foot of a deposit as of a liquid.",
        [Cell("depth h", "m"), Cell("speed v", "m/s"), Cell("of movement", "kPa"), Cell("of the deposit", "kPa")],
        [[numbers(name, unit, value) for name, unit, value in (
            ("depth at the road's edge", "m", edge.depth), ("speed at the road's edge", "m/s", edge.speed),
            ("pressure of movement, rho v^2", "kPa", moves), ("pressure of the deposit, rho g h", "kPa", lies))]])


def travel_rows(data: Data, numbers: Numbers):
    """Shares of the volume, the length along the fall path and the farthest ball of the shown run: distance, angle."""
    run = data.result
    shares = travel_shares.read_share_columns(run.summary)
    rows = []
    for share in travel_shares.SHARES:
        keys = f"distance_{share}_m", f"reach_{share}_deg"
        rows.append((f"{share} % of the volume", *(numbers(f"{share} %: {what}", unit, shares[key])
                                                   for key, what, unit in zip(keys, ("distance", "reach angle"),
                                                                              ("m", "degrees")))))
    own_length = data.length
    if own_length is not None:
        lobe = ("length along the fall path" if own_length.on_path else "straight length, as there is no fall path") + \
            ", to the farthest lobe of at least"
        rows.append((f"{lobe} {percent(LEAST)}", numbers("length along the fall path", "m", own_length.distance),
                     numbers("length along the fall path: reach angle", "degrees", own_length.angle)))
        rows += [(f"{lobe} {percent(least)}", numbers(f"length by lobes of {percent(least)}", "m", length), "")
                 for least, length in zip(OTHERS, own_length.others) if abs(length - own_length.distance) > 1e-6]
        rows.append(("the same as the crow flies", numbers("straight length", "m", own_length.straight), ""))
        check = shares[travel_shares.DISTANCE]
        rows.append((f"a check of it without a threshold: 99 % over {OF_99:g}",
                     numbers(f"99 % over {OF_99:g}", "m", check and check / OF_99), ""))
    distance, angle = farthest_of(run.summary)
    rows.append(("the one farthest ball", numbers("farthest ball: distance", "m", distance),
                 numbers("farthest ball: reach angle", "degrees", angle)))
    return rows


# --- what was run ---

def deck_of(data: Data):
    """Name and text of the deck of the shown run; texts are empty where it is not known."""
    deck = find_deck(data.result)
    name = data.study.study.deck if data.study else deck.name if deck else data.result.prefix.name
    return name, deck.read_text(encoding="utf-8", errors="replace") if deck else ""


def what_was_run(data: Data):
    """The section of the deck, its variables, and what the log says of the model."""
    run, (name, deck) = data.result, deck_of(data)
    variables = run.row.variables or deck_variables(find_deck(run))
    blocks: List[Any] = []
    for title, lines, style in (
            ("Contact coefficients, as the pair style printed them at the start", run.log.table, "keep"),
            ("Commands of the model, with all variables replaced", run.log.settings, ""),
            ("Response of LAMMPS", run.log.notes, "wrap")):
        blocks += [Heading(title), Verbatim("\n".join(lines), style)] if lines else []
    if variables:
        blocks += [Heading(titled("Variables", data)), Pairs([
            (name, verbatim(value), meaning) for name, value, meaning in with_meanings(variables, deck)])]
    return Section("what", "What was run", [*blocks, Verbatim(deck, folded=f"Deck {name}") if deck else None])


def with_meanings(variables, deck):
    """(name, value, meaning) of variables; the meaning is the deck's comment on them, or a usual one."""
    comments = dict(MEANING.findall(deck))
    return [(name, value, comments.get(name.split(" ")[0]) or TERMS.get(name.split(" ")[0], ""))
            for name, value in variables.items()]


def deck_variables(deck):
    """Index variables of a deck that ran by hand: its defaults, marked as such."""
    return {f"{name} (deck's default)": value for name, value in decks.index_variables(deck).items()} if deck else {}


# --- where it comes from ---

def origin(data: Data, made):
    """The section of programs, machines and checksums; made: when the report was."""
    one = data.result
    summary, begun, marker = one.summary, one.about, one.marker
    packages = sorted({str(row.package) for row in data.finished}) if data.study else []
    several = len(packages) > 1
    started, wall = utc(begun.get("started")), marker.get("wall_seconds")
    inputs = (marker.get("inputs") or {}) if find_deck(one) else {}
    rows = [("SLOPE, as compiled into the program", summary["slope_version"]),
            ("package (git describe)" + ", all runs" * several,
             ", ".join(packages) if several else begun.get("package")),
            ("LAMMPS", summary["lammps_version"]), ("SHA-256 of the program", begun.get("lmp_sha256")),
            ("command", begun.get("command")), ("MPI ranks, time step", f"{summary['ranks']:d}, {summary['dt']:.4g} s"),
            ("run", started and f"{started} to {utc(marker.get('finished'))}, wall time {wall} s"),
            ("machine of the run", of_machine(marker.get("machine"))),
            ("machine of this report", of_machine(provenance.machine())), ("report", made),
            *((f"SHA-256 of {file}", digest) for file, digest in inputs.items())]
    return Section("provenance", "Provenance", [Pairs([row for row in rows if row[1]])])


def of_machine(run):
    return run and f"{run['name']}: {run['processor']}, {run['cores']} cores, {run['system']}"


def utc(text):
    """An ISO time in UTC, to the minute; any other value is returned as it is."""
    try:
        return datetime.datetime.fromisoformat(text).astimezone(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    except (TypeError, ValueError):
        return text
