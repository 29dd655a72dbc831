"""slope study: one deck over the product of lists of its variables, several runs at a time; a table and maps over all.

Order of the work: check the deck and the settings, plan the runs (repeats.py), make their folders and run what is not
finished (jobs.py), collect (results.py), evaluate (outcome.py); of a site one number of both studies (headline.py).
"""
import argparse
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence

from ..case import decks
from ..case.settings import check_settings, one_value_each
from ..ensembles import known_events, known_study, sample
from ..errors import SlopeError
from ..options import flag, option, positional, several
from ..runs import repeats
from ..sites import site_choices, site_deck, site_roads, site_scenarios
from ..sites.site_bodies import VARIABLE
from ..sites.site_choices import Site
from ..sites.site_sections import OfMass
from ..studies import ahead, results, road_numbers, site_ground, site_study, size_runs, study
from ..studies.road_numbers import Made
from ..studies.study import OfAKind, RunsFailed, check_more_than, check_thresholds, perform
from ..tables import headline, intensity, study_types
from . import known_arguments, road_arguments
from .run_arguments import DECK, Intensity, Repeats, Runs, Sample, setup_of

PAGES = {site_study.STUDY: "paper.html", site_study.ENSEMBLE: "ensemble.html"}     # beside report.html
THICKNESSES = "0.1,0.5,1"      # of the maps of exceedance, m; the parser has None, as for all that a site refuses
OF_A_ROAD = ("road", *road_arguments.OPTIONS, "cut_angle", "mesh", "local")
NOT_OF_A_SITE = ("set", "repeat", "vary", "sample", *OF_A_ROAD, "equally_good", "output", "exceed", "left_out",
                 *OfAKind._fields)
OPTIONS = {"output": "-o", "left_out": "--except"}
DESCRIPTION = "Run one deck for all combinations of values of its variables, or for an ensemble."
EPILOG = """\
units: metres, seconds, m3 of ground (bulk); thresholds of --exceed in metres.

example: six runs, as many at a time as there are cores; the same command continues after an interruption:
  tools/slope study inputs/20_embankment/in.embankment --set rolling=0:0.1:0.05 --set friction=25,30 -o out

with a conservative volume that counts the chance: every combination three times, from other offsets of the lattice:
  tools/slope study in.collapse --set rolling=0,0.1 --repeat xoffset=0.25,0.5 --road road.geojson -o out

an ensemble: 64 runs with values drawn from distributions, the probability of a volume, the variables that matter:
  tools/slope study in.collapse --sample 64 --vary friction=20:40 --vary rolling=triangular:0:0:0.2 \\
      --road road.geojson -o out

the same, weighted so that the runs end where known events of this volume and height did:
  tools/slope study in.collapse --sample 64 --known rock_avalanches --vary friction=5:35 --vary rolling=0:0.2 -o out

the whole chain, from an earthquake to how often the road is blocked, of a site made with `slope site --slips`:
  tools/slope study mine --sample 64 --vary friction=25:35 --vary rolling=0:0.1 --fragility fragility --more-than 500

everything of a site that `slope site ... -o mine` made, with its report: a sweep of rolling resistances, with repeats
and sizes of balls, and an ensemble that is weighted by known events; the larger volume of both counts:
  tools/slope study mine

Every run has a folder of its own in DIR, and is not repeated once it is finished. Over all runs: DIR/study.csv,
DIR/combinations.csv (mean and scatter), DIR/study.yaml, and the maps envelope_* (largest thickness) and exceedance_*
(share of the runs above a thickness).
"""


@dataclass(frozen=True, kw_only=True)
class Request(Sample, known_arguments.Known, Repeats, Intensity, Runs):
    method: str = ""        # of a site's study, in words
    weigh: bool = False     # by the known events of a site, also without --known
    around: Optional[Site] = None       # in whose folder the deck is
    wide: Mapping[str, Any] = field(default_factory=dict)       # {variable: its range outside of the given one}
    roads: Sequence[Mapping[str, Any]] = ()     # of a site with several, whose worst is asked
    deck: Path = positional(f"{DECK}; or a folder made by `slope site`: its standard study is run", metavar="DECK|SITE")
    set: List[str] = several(
        "values of an index variable of the deck; A:B:STEP stands for A, A + STEP, ... up to B",
        metavar="NAME=V1,V2,...")
    known: Optional[str] = known_arguments.known_option(
        "weight the runs of an ensemble so that they end where known events of this volume and height do: EVENTS.csv",
        "--known", "--mobility")
    fragility: Optional[Path] = option(
        "of a site with several bodies, with --sample: what `slope fragility` wrote; how likely which volume reaches "
        "the road at a peak acceleration, and per year", metavar="FOLDER")
    paper: bool = flag(
        "of a site: the sweep alone, the largest volume over the rolling resistances")
    levels: Optional[str] = option(
        "sizes of balls: of a site how many, each of half the diameter of the one before (default: as time allows); of "
        "a deck diameters, d=D1,D2,...: all points run with the first, some with the others; results are of the last",
        metavar="N|d=D1,D2,...")
    minutes: Optional[float] = option(
        "of a site: that the study may take on this machine, which decides how many points run, and with finer "
        "balls (default: site.yaml's, else 10, or up to 60 for a bound)", metavar="T")
    fine: Optional[str] = option(argparse.SUPPRESS)
    exceed: Optional[str] = option("thicknesses of the maps of exceedance, m (default 0.1,0.5,1)", metavar="T1,T2,...")
    exceed_speed: Optional[str] = option(
        "speeds of the maps of exceedance of an ensemble, m/s (default 5)", metavar="V1,V2,...")
    exceed_energy: Optional[str] = option("energies of a ball for the same, J (default 100000)", metavar="E1,E2,...")
    of: Optional[str] = option(
        "quantity of the hazard curve of an ensemble, a column of study.csv (default: remove_on_road_m3; without a "
        "road distance_99_m)", metavar="NAME")


def run_study(args: Request) -> None:
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    if args.fine is not None:
        raise SlopeError("--fine", "must not be given any more: --levels says how many sizes of balls there are (1: "
                         "one; of a deck --levels d=5,2.5,1.25)", args.fine)
    args = replace(args, given=args)
    if args.deck.is_dir() and (args.output is None or (args.deck / site_choices.NAME).exists()):
        with study.alone(args.deck, args.dry_run or not (args.deck / site_choices.NAME).is_file()):
            return run_folder(args)
    for name in ("paper", "minutes"):
        if all(getattr(args, name) is not none for none in (None, False)):
            raise SlopeError(f"--{name}", "must be given with the folder of a site", args.deck)
    place = args.deck.parent
    run_deck(replace(args, around=site_choices.load_site(place) if (place / site_choices.NAME).is_file() else None))


def run_folder(args: Request) -> None:
    """The studies of a site's folder: of its road, or of each of several, and of the worst as if it were alone."""
    check_request(args)
    site = site_choices.load_site(args.deck)
    made = road_numbers.evaluate_all_roads(site, not args.dry_run, setup_of(args).tell, lambda site, several,
                                           quiet: run_site_of(
        replace(args, roads=several, quiet=quiet), site))
    above = site_scenarios.site_of(args.deck) or args.deck
    if made.abouts and site_scenarios.list_scenarios(above):
        from ..scenarios import page        # with pictures: half a second
        print(page.refresh(above))
    if made.failed:
        raise made.failed


def check_request(args: Request) -> None:
    """Raise SlopeError if options are given that the study of a site, or its ensemble, does not have."""
    if args.sample is not None or args.fit is not None:
        if args.paper:
            raise SlopeError("--paper", "must not be given with --sample or --from, which make an ensemble")
        return refuse(args, OF_A_ROAD)
    if args.fragility is not None:
        raise SlopeError("--sample", "must be given with --fragility: how many runs")
    return refuse(args, NOT_OF_A_SITE)


def run_site_of(args: Request, site: Site) -> Made:
    """The study of a site, of the road that is asked: a sweep, and an ensemble weighted by known events."""
    if args.sample is not None or args.fit is not None:
        return run_site_ensemble(args, site)
    site_study.check_site(site)
    why = "" if args.paper else known_study.why_not(args.deck) if site.choices.study.points else known_study.NONE
    if args.paper or why:
        condition_of(replace(args, around=site))        # refuses what has no meaning here
        method = f"{known_study.SWEEP}; {why}" if why else known_study.ASKED
        say(args, site, method, 0)
        return make_site_study(args, site, method)
    points = ahead.choose_points(site, setup_of(args), sizes_of(args))
    say(args, site, f"{known_study.WEIGHTED}, which --paper makes alone", points)
    return run_both(args, site, points)


def run_both(args: Request, asked: Site, points: int) -> Made:
    """The sweep and the ensemble of a site, the number that both give, and a report of each.

    One of both is never the site's: what both study.yaml say of it, or that there are none, stands until both are there
    anew.
    """
    site, before = site_roads.results(asked), site_study.digests(asked)
    planned = site_study.plan_site_study(asked, setup_of(args))
    site_study.make_site_runs(planned)
    if site_study.digests(asked) != before:
        raise SlopeError(asked.folder, f"must not change while its study is made: {site_deck.NAME} and its data are "
                         "not those of the runs so far; the same command again, with --anew")
    beside = site_study.Beside(planned, site_study.wanted(asked, planned, sizes_of(args), points))
    failed: Optional[Exception] = None
    try:
        weighted = run_deck(of_ensemble(replace(args, sample=points, known=None, weigh=True), asked,
                                        known_study.WEIGHTED), beside)
    except RunsFailed as error:     # the others count
        if error.found is None:
            raise SlopeError(asked.folder, "must have an ensemble for its number, --paper makes the sweep alone: "
                             f"{error}") from None
        failed, weighted = error, error.found
    if args.dry_run or weighted is None:
        return Made((), None)
    sweep = site_study.collect_site_results(asked, planned, known_study.BESIDE, lambda _: beside.found, args.roads,
                                            alone=False, made=True)
    failed = sweep.failed or failed
    assert sweep.about
    made = headline.conclude({site / site_study.STUDY: sweep.about, site / site_study.ENSEMBLE: weighted}, args.given)
    results.write_abouts(made)
    (governs, first), *others = made.items()
    for folder, study_ in others:
        write_site_report(folder, site / PAGES[folder.name], study_, asked, film=False, quiet=args.quiet)
    if not args.quiet:
        print("\n".join(results.tell_letter(first)))
    write_site_report(governs, site / road_numbers.PAGE, first, asked, quiet=args.quiet)
    return Made(list(made.values()), failed)


def sizes_of(args: Request) -> site_study.Asked:
    return site_study.parse_asked(args.levels, args.minutes)


def say(args: Request, site: Site, method: str, points: int) -> None:
    """How the study of a site is made, what its grounds hold, which runs are there; points: of the ensemble."""
    if args.roads or site.road not in ("", *site_roads.names(site)[:1]):
        return      # said for the first road
    print("\n".join([method, *site_ground.describe_grounds(site, others=True),
                     ahead.look_ahead(site, setup_of(args), points, sizes_of(args)).text]), flush=True)


def run_deck(args: Request, beside: Optional[site_study.Beside] = None) -> Optional[study_types.Study]:
    """The runs of a deck; what study.yaml says of them, None of a dry run; beside: of an ensemble of a site."""
    if args.output is None and not args.deck.exists():
        raise SlopeError(args.deck, "must be a deck or the folder of a site, there is none of that name")
    if args.output is None:
        raise SlopeError("-o", "must be given, the study's folder")
    args, chain = chain_of(args)
    settings = check_settings(args.set, args.deck)
    repeated = check_settings(args.repeat, args.deck, "--repeat")
    repeats.check_repeats(list(repeated), args.equally_good)
    thresholds = check_thresholds(THICKNESSES if args.exceed is None else args.exceed)
    defaults = decks.index_variables(args.deck)
    many = args.sample is not None or bool(args.vary) or args.fit is not None
    check_fit(args)
    args = replace(args, **OfAKind(*(getattr(args, name) for name in OfAKind._fields)).settled(
        sample=many)._asdict())
    check_more_than(args.more_than or (), args.intensity, settings, bool(args.road))
    condition = condition_of(args)
    if many:
        return make_ensemble(args, settings, repeated, thresholds, defaults, condition, chain, beside)
    if not settings:
        raise SlopeError("--set", "must be given, or --sample with --vary")
    todo = repeats.plan_repeats(args.output, settings, repeated, defaults)
    intensity.check_intensity(args.intensity, settings, bool(args.road))
    setup = setup_of(args)
    wanted = size_runs.of_deck(args.levels, args.deck, len(todo), [*settings, *repeated])
    todo = size_runs.at_first(setup, todo, wanted)
    questions = results.Questions(settings, repeated, thresholds, None, args.intensity, args.more_than or (),
                                  known=known_of(args))

    def collect(_, work):
        at = size_runs.settle(setup, work, [one for one in todo if not one.error], wanted)
        return results.collect_results(setup, questions._replace(sizes=at, notes=at.warnings), todo, work)

    return perform(setup, {**settings, **repeated, **(wanted.settings if wanted else {})}, todo, collect)


def condition_of(args: Request) -> Optional[known_events.Condition]:
    """What --known and its company ask for; SlopeError if some are there without it."""
    choice = known_arguments.choice_of(args.known, args.left_out, args.confined, args.around) \
        if args.known is not None or args.weigh else None
    folder = args.around.folder if args.around else None
    return study.condition_of(choice, args.known, folder, args.left_out, args.confined)


def known_of(args: Request) -> Mapping[str, Any]:
    """With which known events the runs of a site's deck are compared."""
    return asdict(args.around.choices.known) if args.around else {}


def check_fit(args: Request) -> None:
    """Raise SlopeError if --from is given with what says otherwise where the runs lie, or how they count."""
    for name in ("vary", "design", "seed", "known"):
        if args.fit is not None and getattr(args, name) not in (None, []):
            raise SlopeError(f"--{name}", "must not be given with --from: a calibration has said which values are "
                             "equally good", " ".join(args.vary) if name == "vary" else getattr(args, name))


def chain_of(args: Request):
    """The request in which the bodies vary, too, and what --fragility asks for; None without it."""
    if args.fragility is None:
        return args, None
    from ..seismic import chain_files, fragility_files      # scipy
    for name, given in (("known", args.known), ("from", args.fit), ("of", args.of)):
        if given is not None:
            raise SlopeError(f"--{name}", "must not be given with --fragility, whose runs are of several bodies "
                             "and of the volume on the road", given)
    if args.sample is None or args.site is None or args.around is None:
        raise SlopeError("--fragility", "must be given with the folder of a site and --sample", args.fragility)
    if not args.road:
        raise SlopeError("--fragility", "needs a site with a road: what counts is the volume on it", args.fragility)
    for words in (*args.vary, *args.set):
        if words.startswith(f"{VARIABLE}="):
            raise SlopeError("--vary", f"must not have {VARIABLE}, which --fragility draws", words)
    found = chain_files.check_chain(fragility_files.read_fragility(args.fragility),
                                    args.around.found.bodies, args.site, args.more_than or ())
    fixed, drawn = chain_files.options(found)
    return replace(args, set=[*args.set, *fixed], vary=[*args.vary, *drawn], more_than=None), found


def make_site_study(args: Request, site: Site, method: str) -> Made:
    """The standard study of a site's folder, and the report."""
    done = site_study.run_site_study(site, setup_of(args), method, sizes_of(args), args.roads)
    if done.study and done.about:
        write_site_report(done.study, site_roads.results(site) / road_numbers.PAGE, done.about, site, quiet=args.quiet)
    return Made([done.about] if done.about else (), done.failed)


def refuse(args: Request, names, where="") -> None:
    """Raise SlopeError if one of these options, which a site decides on, is given; where: with what, None may be."""
    for name in names:
        value = getattr(args, name)
        if value is not None and value is not False and value not in ("", []):
            first = value[0] if isinstance(value, list) else value
            raise SlopeError(OPTIONS.get(name, f"--{name.replace('_', '-')}"), "must not be given with "
                             + (where or f"the folder of a site: {args.deck / 'site.yaml'} says what is run"
                                f"{road_arguments.otherwise(args)}"),
                             None if first is True else f"{first:g}" if isinstance(first, float) else first)


def write_site_report(folder: Path, page: Path, study_: study_types.Study, site: Site, film=True, quiet=False) -> None:
    """The page on a study, of which study.yaml says this, unless it is there; one of several roads has no film."""
    from ..report import document
    from ..report.heading import Asked
    asked = Asked(folder, film=page.with_suffix(".mp4") if film and not site.road else None, study=study_,
                  site=site.content)
    said = document.update(asked, page)
    if not quiet:
        print("\n".join(said))


def run_site_ensemble(args: Request, site: Site) -> Made:
    """An ensemble of a site's deck with its road, in a folder of the site's, and the report."""
    site_study.check_site(site)
    wanted, beside = of_ensemble(args, site), None
    if args.fit:
        refuse(args, ("levels", "minutes"), "--from: its runs have the balls for which its values were found")
    else:
        assert args.sample is not None
        beside = site_study.Beside(None, site_study.wanted(site, site_study.plan_site_study(site, setup_of(args)),
                                                           sizes_of(args), args.sample, alone=True))
    about = run_deck(wanted, beside)
    if about:
        assert wanted.output is not None
        write_site_report(wanted.output, site_roads.results(site) / PAGES[site_study.ENSEMBLE], about, site,
                          quiet=args.quiet)
    return Made([about] if about else (), None, PAGES[site_study.ENSEMBLE])


def of_ensemble(args: Request, asked: Site, method="") -> Request:
    """The request with a site's deck, its road, and a folder of the site's."""
    if args.output and asked.road:
        raise SlopeError("-o", "must not be given with a site of several roads, each of which has its folder",
                         args.output)
    site, choices = asked.folder, asked.choices
    vary = args.vary or ([] if args.fit else [*of_fragility(choices), site_choices.CHANCE] if args.fragility
                         else [*known_study.VARY, site_choices.CHANCE])
    return replace(args, deck=site / site_deck.NAME, site=site, around=asked, method=method,
                   set=[*args.set, *not_varied(args, choices, vary)],
                   output=args.output or site_roads.results(asked) / site_study.ENSEMBLE,
                   wide={} if args.vary or args.fit or args.fragility else known_study.WIDE,
                   vary=vary, **road_arguments.list_road_options(asked))


def not_varied(args: Request, choices: OfMass, vary) -> List[str]:
    """--set of what a site has a list of and an ensemble does not vary."""
    names = {words.partition("=")[0] for words in (*vary, *args.set, *args.repeat)}
    if args.fit:
        from ..fitting import calibrated
        names |= calibrated.texts_of(args.fit).keys()
    return [f"{name}={value}" for name, value in site_choices.not_varied(choices, names).items()]


def of_fragility(choices: OfMass) -> List[str]:
    """--vary of a site's chain, unless it is given, beside what is chance: the rolling resistances of its study."""
    rolling = choices.study.rolling
    return [f"rolling={min(rolling):.10g}:{max(rolling):.10g}"] * (min(rolling) < max(rolling))


def make_ensemble(args: Request, settings, repeated, thresholds, defaults, condition, chain=None,
                  beside: Optional[site_study.Beside] = None) -> Optional[study_types.Study]:
    """The runs of --sample; what study.yaml says of them; beside: of a site, whose points have finer balls together."""
    from ..ensembles import ensemble, ensemble_maps
    from ..fitting import calibrated
    from ..studies import ensemble_study
    if args.sample is None and args.fit is None:
        raise SlopeError("--sample", "must be given with --vary: how many runs")
    fixed = one_value_each(settings, "--set", "--vary")
    plan: sample.Sample
    if args.fit:
        plan = calibrated.sample(args.fit, args.sample, args.deck, fixed, repeated)
    else:
        assert args.sample is not None and args.design is not None and args.seed is not None        # settled()
        plan = sample.check_sample(args.sample, args.design, args.seed, args.vary, args.deck, fixed,
                                   repeated).widened(args.wide)
    levels = ensemble_maps.Thresholds(thresholds, check_thresholds(args.exceed_speed, "--exceed-speed", "speeds"),
                                      check_thresholds(args.exceed_energy, "--exceed-energy", "energies"))
    of = ensemble.check_quantity(args.of, args.road is not None)
    setup = setup_of(args)
    questions = results.Questions({}, repeated, thresholds, ensemble.Order(plan, of, levels, condition), site=args.site,
                                  method=args.method, chain=chain, known=known_of(args), roads=args.roads,
                                  alone=not args.weigh)
    return ensemble_study.run_ensemble(setup, questions, fixed, defaults, args.levels, beside)
