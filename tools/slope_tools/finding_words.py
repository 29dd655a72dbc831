"""The words of all findings: one table. A test renders each of them.

Numbers stand in braces: a float has three digits where nothing else is asked for, `cubic` is a volume with its unit.
"""
from typing import Dict, NamedTuple, Union

# how grave: of the whole result, or of a part of it; an assumption of the model, which no list of warnings has
WARNING, NOTE, LIMIT = "warning", "note", "limit"
OTHER = "other"         # of the kinds that no reader tells apart, and of what older files say


class Words(NamedTuple):
    """Of a kind; client: for the first page of a report, without words of the tools; {who}: the runs."""
    text: str
    level: str = WARNING
    client: str = ""


NOT_BODY = "{who} released a mass that may not be the body: {released:cubic}{of_body}."
LOST = "{who} lost mass over the edge, {up_to}{volume:cubic}: enlarge the terrain{add}."
LEFT = ("{up_to}{volume} m3 ({percent:.2g} % of the released volume) left the grid or the box and are not on the maps"
        "{where}")
AT_REST = "not at rest at the end{among}: {end}, at {time:.1f} s"
DOUBTFUL = "the released mass is doubtful: "

WORDS: Dict[str, Union[str, Words]] = {
    OTHER: "{text}",
    # those of the first page, the heaviest first
    "failed": Words("failed: {error}", client="{who} failed and are not in the numbers."),
    "in motion": Words(f"{AT_REST}. More than 10 % of the volume is in motion: these numbers are not those of a "
                       "deposit", client="{who} ended with more than a tenth of the mass in motion: the numbers are "
                                         "not those of a deposit."),
    "lost much": Words(f"{LEFT}, and how far they went is unknown: enlarge the terrain and the box{{add}}",
                       client=LOST),
    "energy of balls": "energy is that of one ball of the model{size}, and an eighth with balls half as large: of a "
                       "mass these zones are no classes of intensity; those of speed and thickness are",
    "observation missed": Words("no calibrated values reproduce what was observed: the closest are {times:.1f} times "
                                "as far from it as chance and tolerance explain", client=(
                                    "The model was calibrated with a past event that it does not reproduce.")),
    "bulk factor": Words(f"{DOUBTFUL}the bulk factor {{factor:.3g}} is {{off}} {{side}} {{usual}}: {{why}}", NOTE,
                         "{who} released a doubtful mass, {released:cubic}{of_body}: {why}."),
    "body volume": Words(f"{DOUBTFUL}it is {{off}} {{side}} than the body of {{body:,.0f}} m3", NOTE, NOT_BODY),
    "balls removed": Words(f"{DOUBTFUL}{{off}} of the balls were removed at the start, and the body that the others "
                           "represent is unknown (fix deposit/grid ... bulk region)", NOTE, NOT_BODY),
    "road on body": Words("{file}: {part} lies on the body, and goes with it: the volume to remove does "
                          "not tell what it takes to build the road anew", client=(
                              "{Part} lies on the mass that is released, and goes with it: what it takes "
                              "to build it anew is not in the volume.")),
    "soft": Words("the contacts are soft for the weight on them, K {number:,.0f} instead of {limit:,.0f} and more: "
                  "volumes and distances may be some percent too large (choosing parameters, stiffness)", NOTE),
    "large": Words("{millions} million m3: masses of {limit:g} million m3 and more are known to run farther than "
                   "laboratory friction suggests; the run-out is not conservative unless known events weigh the "
                   "runs, or the friction was calibrated with a past event of that size (slope calibrate)", NOTE,
                   "Masses of {limit:g} million m\u00b3 and more are known to run farther than laboratory friction "
                   "suggests: the reach is not conservative unless a past event was used to calibrate it."),
    "moving": Words(AT_REST, NOTE,
                    "{who} ended before the whole mass was at rest: it may go a little farther."),
    "no repeats": Words("no run was repeated: the scatter by chance is unknown", LIMIT,
                        "No run was repeated: how much chance changes the numbers, usually several percent, is "
                        "unknown."),
    "no sizes": Words("the effect of smaller balls is unknown", LIMIT,
                      "What a finer model would change is unknown."),
    "few balls high": Words("{name} is {height:#.3g} m high, {balls:.2g} of the model's balls: the loads on it are "
                            "those of single balls, and rough", LIMIT,
                            "{name} is low for so coarse a model: the forces on it are rough."),
    "cut below ground": Words("{percent:.0f} % of it ({volume:,.6g} m3 in the run {run}) lies where the cut surface is "
                              "below the ground before the collapse. The hillside is about as steep as the cut of "
                              "{angle:g} degrees there, or steeper, so that all of the deposit on it is counted; a "
                              "steeper cut angle gives less", NOTE,
                              "{percent:.0f} % of the volume to remove lies where the hillside is as steep as the cut "
                              "or steeper: a steeper cut gives less."),
    "thin": Words("the body is {balls:.1f} balls thick on average, below {limit:g}, with the finest ones: the "
                  "numbers will be rough; use more balls (--balls, --minutes)", client=(
                      "The model is coarse for so thin a body: the numbers are rough.")),
    "lost": Words(LEFT, NOTE, LOST),
    "slip assumed": Words("the slip surface is given, not computed", LIMIT,
                          "The slip surface is an assumption: whether, and how likely, the slope fails is not said "
                          "here."),
    # of runs
    "balance": Words("the volume in the thickness raster differs from released - off the grid - lost by {share:.1e} of "
                     "the released volume", NOTE),
    "LAMMPS": Words("LAMMPS: {line}", NOTE),
    "programs": "the runs are of different programs: {what} {which}",
    # of the files of a GIS
    "pits": "{cells} cells of {mark} lie at least {depth:.4g} m {side} all cells beside them, the first "
            "at {east:.10g} {north:.10g}: NODATA that the file does not declare? {remedy}",
    "no such cell": "--nodata {value}: no cell of the input has that value; its heights are {low:.6g} to {high:.6g} m",
    "picture": "all heights are whole numbers from {low:g} to {high:g}, as the values of a picture: is it a hillshade?",
    "in feet": "the ground falls by {degrees:.0f} degrees on average: are the heights in feet? Then --z-unit ft, which "
               "makes it {in_feet:.0f}",
    "no ground's slope": "the ground falls by {degrees:.0f} degrees on average, {in_feet:.0f} if it is in feet: are "
                         "these heights, and the cells in metres?",
    "stretched": "a metre in {crs} is {metres:.3f} m on the ground: choose a local CRS",
    "grid north": "north of {crs} is {degrees:.0f} degrees {side} of north here: bearings are from the grid's north; "
                  "choose a local CRS, such as a UTM zone, where they shall be from north",
    "tiles differ": "{file}: its heights differ by up to {largest:.1f} m from those of the files before it, which "
                    "count, at east {east:.10g}, north {north:.10g}; by {median:.2g} m at the median of {cells} cells",
    "step between tiles": "{file}: its heights are {median:+.1f} m off those of {other} where the two meet, at the "
                          "median of {pairs} pairs of cells, as at east {east:.10g}, north {north:.10g}: have they one "
                          "datum?",
    "CRS of terrain": "{file} has no CRS: taken to be in that of the terrain{remedy}",
    "local raster": "{file} has neither origin nor CRS: taken to be in the terrain's local metres",
    "survey raster": "{file} has neither origin nor CRS: taken to be in coordinates of the survey; --local if it is in "
                     "the terrain's local metres",
    "datums": "tiles of {datums} are mixed and not converted: {what} may differ where they meet",
    "cut to input": "--bounds reaches beyond the input, {extent}: cut to it",
    "outside": "{file}: {percent:.2g} % of the area lies outside of {terrain}",
    "zones overlap": "{file}: zones overlap on {area:,.0f} m2: the later feature counts there",
    "zone covered": "{file}: zone {zone} lies below later features and counts nowhere",
    "no geometry": "{feature} has no geometry ({without} of {features} have none): left out",
    "no line": "{file}: {kinds} in it, where a line is asked for: left out",
    "roads meet": "{file}: roads that meet, or nearly do, are studied each by itself, and a cut through both takes "
                  "more than the larger number: {places}; is it one road? Then join its lines",
    "drawn twice": "{file}: {percent:.3g} % of the length of its lines is drawn more than once, or there and back: "
                   "taken once",
    "file name": "{file}: LAMMPS cannot read {characters} in the name of a file: rename it before it goes into a deck",
    "swapped": "--release and --road may be swapped, the road lies above the release area: {grounds}",
    # of a body
    "bulges": "the ground bulges above the line from toe to shoulder, and so does the {shape}: a smaller polygon, or "
              "--shape slbl?",
    "no way out": "the plane dips {dip:.3g} degrees towards {direction:.3g}, where the ground falls by {ground:.3g}: "
                  "it does not come out of the ground below the body, which cannot slide out; a smaller --dip, or "
                  "another --direction?",
    "little": "the base level {form}takes {percent:.0f} % of the polygon, {depth:.3g} m deep on average: is this the "
              "intended body? A larger depth or a smaller polygon gives another one",
    "no body": "{polygon} gets no body, {why}: nothing is released there",
    "own depth": "{file}: the attribute {attribute} says how deep its features are ({depths}): --depth {depth:g} is "
                 "that of {which}",
    "shared": "{file}: the attribute {attribute} says how deep its features are ({depths}): --volume {volume:.6g} is "
              "shared in their proportion, with mean depths of {factor:.3g} times these",
    "unused depth": "{file}: the attribute {attribute} says how deep its features are ({depths}), which does not count "
                    "with {by}: --shape slab, or slbl, has it",
    "in a pit": "{percent:.0f} % of the body lies below its own lowest ground, and cannot slide out: it is up to "
                "{depth:.3g} m deep where the ground falls by {fall:.3g} m; are these metres? A smaller depth or "
                "volume, or a larger area?",
    "cliff": "the ground of the body falls by {degrees:.0f} degrees on average: a cliff, or heights in feet "
             "({in_feet:.0f} degrees)? slope terrain and site have --z-unit",
    "few cells": "the body covers {cells} cells of {cell:g} m: use a finer terrain",
    "hollow": "the slip surface has a closed hollow, {depth:.3g} m deep, out of which the mass cannot slide: {remedy}",
    "unknown inside": "{file} has no value on {area:,.0f} m2 inside the body: nothing is released there; fill them if "
                      "this ground slid",
    "rim": "the body is {depth:.3g} m deep at the rim of its area, where it ends in a wall: {remedy}",
    "beyond toe": "the slip surface comes out beyond the toe: {area:,.0f} m2 of the body lie on level ground at its "
                  "foot, up to {depth:.3g} m deep, over which it slides without the ground's friction; is a shallower "
                  "body meant, or one that ends at the toe?",
    "above ground": "the slip surface lies above the ground on {area:,.0f} m2 of the polygon, by up to {height:.3g} m: "
                    "nothing is released there; is another surface meant, or a smaller polygon?",
    "other thickness": Words("the calibrated values were found with {found:.2g} balls over the thickness of the body, "
                             "these runs have {here:.2g}, and values belong to the size of the balls: calibrate with "
                             "these"),
    "other settings": Words("the calibrated values were found with {found}, these runs have {here}, and belong to it: "
                            "give the same (--set), or calibrate with these"),
    "under road": "{file}: the slip surface comes out under the road, up to {depth:.3g} m below {area:,.0f} m2 of it, "
                  "where the ground's friction does not act; is that the body you mean?",
    "shift": "beside the body {file} lies {metres:.3g} m {side} the terrain (median), which counts in the depths: "
             "vertical datums are not compared, are they the same?",
    "parts": "the body is in {parts} parts that do not touch, of {volumes} m3{rest}: is that the body you mean?",
    "several bodies": "several bodies that do not touch: the fall path, along which runs and known events are "
                      "measured, is that of the largest, {volume:,.0f} m3; which events reach a road is that of the "
                      "body of which most do; all are events of the volume of all, {all:,.0f} m3. One site for each "
                      "body?",
    # of a body and its balls
    "no program": "no LAMMPS program (LMP, --lmp, build/lmp): no trial run, time and speeds are unknown",
    "left terrain": "{percent:.2g} % of the mass left the terrain in the trial run: use an elevation model that is "
                    "larger, or has no hole there",
    "narrow road": "{file}: the road is about {width:.3g} m wide, {balls:.2g} balls of {d:g} m and {cells:.2g} cells "
                   "of {cell:g} m: narrower than a ball or two cells, so what lies on it is a guess: use {remedy}",
    "high wall": "--height {height:g}: is it in m, above the ground? Walls and dams are rarely higher than {limit:g} m",
    "low wall": "{name}: the wall is {height:.3g} m high, less than a ball of {d:.3g} m: what it holds, and the force "
                "on it, are of single balls, not of a mass: use {remedy}",
    "few across": "the body is about {across:.2g} cells of {cell:.3g} m across, below {limit:g}: its surface and "
                  "volume are rough; use a finer elevation model",
    "not at rest": "the trial run was not at rest after {seconds:.0f} s: the run time of the study is a guess",
    "first look": Words("the body is {balls:.1f} balls thick at most, below {limit:g}, with the finest ones: a "
                        "first look; to repeat it, use more balls (--balls, --minutes)", NOTE),
    "small angle": "{option} {degrees:g}: is it in degrees? A coefficient of {degrees:g} is {meant:.3g} degrees",
    "large rolling": "{option} {rolling:g}: is it a coefficient? More than {limit:g} stands for bodies that do not "
                     "roll",
    # of a run and its road, in the metres of its terrain
    "moves": "{file}: the mass was still moving at {seconds:g} s: these are not final numbers",
    "not counted": "{file}: {volume:.6g} m3 of the mass left the grid or the box and are not counted",
    "no terrain": "no --terrain and no {file}: no CRS, coordinates are the local metres of the run",
    "no CRS": Words("{file} has no CRS: coordinates are {coordinates}", NOTE),
    "cut off": "{file}: {percent:.3g} % of the polygon lies outside of the grid of the run: cut off",
    "chainage from the edge": "the road's polygons turn back beyond the grid, where their middle is not followed: "
                              "chainage begins at the grid's edge; draw the road as a line",
    "edge without ground": "{file}: {percent:.3g} % of the road's edge lies on cells without a height: the cut rises "
                           "there from the height of the nearest ground or edge, the lower one",
    "no ground": "{volume:,.0f} m3 lie on cells without ground, beside the road: not in the volume to remove",
    "outside of grid": "{file}: {area:.6g} m2 of it lie outside of the grid of the run: counted as false negative",
    "nowhere thicker": "{file} is nowhere thicker than {threshold:g} m",
    "no base": "no {file}, as of a run by an older version: no ground without the body",
    # of where balls came to
    "not arrived": "{file}: {moving} of {balls} balls are faster than {speed:g} m/s: they have not arrived",
    "missing": "{file}: {missing} of {balls} balls of the start are not there: shares of the run-out count them as "
               "beyond all others, all else leaves them out",
    "beyond limits": "{option} {low:g} {high:g}: {outside} of {balls} balls lie beyond these limits",
    # of a slope's stability: bodies of a search, one that failed, fragility
    "in kPa": "--cohesion {value:g}: is it in Pa? Values in kPa are a thousand times smaller",
    "in kN": "--density {value:g}: is it in kg/m3? Values in kN/m3 are about a hundred times smaller",
    "bedrock": "body {body}: --bedrock has no value below {percent:.3g} % of its cells",
    "water table": "body {body}: --water-table has no value below {percent:.3g} % of its cells, which are dry",
    "layer": "body {body}: --layer {file} has no value below {percent:.3g} % of its cells, which are of the strength "
             "above",
    "columns": "body {body} has {value:.0f} cells of the terrain, fewer than {limit:g}: its numbers are rough",
    "terrain": "body {body} is within {limit:g} cells of the edge of the terrain or of cells without a height: a "
               "larger terrain may have a lower factor",
    "within": "body {body} is at the edge of --within: beyond it the factor may be lower",
    "volume low": "body {body} has the least volume that is allowed, {limit:.6g} m3: a smaller body may have a lower "
                  "factor",
    "volume high": "body {body} has the largest volume that is allowed, {limit:.6g} m3: a larger body may have a lower "
                   "factor",
    "depth low": "body {body} has the least depth that is allowed, {limit:.6g} m: a shallower body may have a lower "
                 "factor",
    "depth high": "body {body} has the largest depth that is allowed, {limit:.6g} m: a deeper body may have a lower "
                  "factor",
    "flat": "body {body} is nearly a plane, radius {value:.4g} m for a length of {limit:.4g} m: at the edge of a "
            "search of spheres",
    "wide": "body {body} is {value:.3g} times as wide as a sphere, which is a limit of the search: another width may "
            "have a lower factor",
    "fails": "body {body} has a factor of {value:.3f}, below 1: with these numbers it does not stand",
    "few columns": "the body has {cells} cells, fewer than {limit}: the line is rough",
    "narrow": "{alone} of the body's {cells} cells have no neighbour in it on one axis, and the dip of the nearest "
              "cell that has: the line is rough",
    "no sphere": "the body is no sphere, and the line depends on the axis of moments: a far one changes the cohesion "
                 "by {percent:+.0f} % without friction",
    "pseudo-static": "pseudo-static: a body that is at F < 1 for an instant with {factor:g} times the peak counts as "
                     "failed, which is {judged}",
    "motion across": "{file}: along the direction of sliding{body}, {bearing:.0f} degrees, its largest acceleration is "
                     "{percent:.0f} % of its peak: it hardly shakes the body; are both horizontal components in it?",
    "one record": "one record: how much records differ is not seen, beta_r is 0",
    "at rest": "{which}: {percent:.2g} % of the strengths fail without an earthquake{makes}: if the slope stands, they "
               "are not its own; raise the lower bounds of the strengths",
    "peaks": "{which}: at {peak:g} gal, the {end} of --peaks, {percent:.2g} % fail, and half of the strengths at "
             "{half:.0f} gal: give {remedy} peaks",
    "no fit": "{which}: no lognormal fit, the peaks show fewer than three probabilities between 0 and 1",
    "fit is off": "{which}: the lognormal fit is off by up to {difference:.2f}",
    "HCLPF": "{which}: at the HCLPF {percent:.2g} % fail, the lognormal fit says {fitted:.2g} %: it is too favourable "
             "there",
    "before the curve": "{which}: {percent:.2g} % of its frequency is of strengths that fail below the hazard curve's "
                        "first peak, so that it fails more often: give a curve from {least:.3g} gal on",
    "beyond the curve": "{which}: peaks above the hazard curve's last may add up to {per_year:.2g} failures per year",
    # of a study
    "ranks": "{runs} runs of {ranks} ranks at a time on {cores} cores: they slow each other down",
    "no effect": Words("{which} has no effect{on}, to the last digit: {then}", NOTE),
    # why the number of a study is withheld
    "balls on the road": Words("on the road lies the volume of {balls}, fewer than {bound:g}", client=(
        "Too few of the model's balls come to lie on the road itself for a volume.")),
    "known events": Words("no run reaches {bound} m, as half of known events of this volume and height do; {longest}",
                          client="No run goes as far as half of known events of this volume and height."),
    "left the terrain": Words("{percent:.2g} % of the released volume left the terrain before, beside or on the road, "
                              "more than {most:g} %{where}", client=(
                                  "A part of the mass left the elevation model before it had passed the road, and is "
                                  "not counted.")),
    "runs not at rest or failed": Words("{number} of {bound} runs failed or are not at rest at the end, more than "
                                        "{most:g} %", client=(
                                            "More than a tenth of the runs failed, or had not come to rest when they "
                                            "ended.")),
    "rule": "{study}: withheld by the rule {rule}",
    # why it is a floor, and why no more runs were added
    "known beyond runs": "{far} of known events of this volume and height go farther than all {runs} runs that they "
                         "weigh, and may leave more; of these runs the largest leaves {most} to remove",
    "road not reached": "known events reach the road and no run does: how much they leave these runs do not show",
    "some runs reach": "{reach} runs bring something to the road{left}",
    "one scatter reaches": "{shares} of them reach the road, as their scatter is taken: only the larger of two "
                           "estimates says more than 10 %",
    "terrain ends": Words("the terrain shows the first {path} of the way, and {share} of known events go on: take a "
                          "larger terrain", client=(
                              "The elevation model ends where {share} of known events go on.")),
    "range ends": Words("no values within the ranges{ends} are expected to go farther: give wider ranges", client=(
        "No values within the ranges that were tried are expected to go farther.")),
    "no more runs": Words("{points} runs were added towards longer ones; a larger --sample allows more", client=(
        "{points} runs were added towards longer ones, and no more.")),
    "too few runs": Words("the runs are too few to tell which parameters go farther: take more points", client=(
        "The runs are too few to tell which settings go farther.")),
    "size of balls": "what a finer model would change is not known: this one has {sizes}, and three tell it",
    "size of balls grows": "the last refinement of the model raised the volume by {grown}: a finer one may bring much "
                           "more",
    # caveats on the volume to remove
    "single run": Words("nothing was varied: it comes from a single run", NOTE),
    "end of range": Words("it lies at the end of the range of {variable}, {low:g} to {high:g}", NOTE),
    "no chance": Words("without repeats (--repeat) the scatter by chance is unknown", NOTE),
    "more than released": Words("it is more than the {released:,.6g} m3 that are released, which is impossible: the "
                                "scatter or the effect of size is too uncertain to give a number", NOTE),
    "two outcomes": Words("{few} of the {runs} runs of {combination} have less than {percent:g} % of the volume of the "
                          "others, which the scatter by chance does not describe ({why})", NOTE),
    "hardly reaches": Words("{few} of the {runs} runs of {combination} have less than {percent:g} % of the volume of "
                            "the others, which the scatter by chance does not describe (the mass came down in these, "
                            "too, and hardly reached the road)", NOTE),
    "more in a run": Words("{run} gave more, {volume:,.6g} m3", NOTE),
    "scatters more": Words("its runs scatter more than the others, by {mine:,.6g} instead of {others:,.6g} m3: the "
                           "common scatter may be too small for it", NOTE),
    "fails at times": Words("at {variable} {values} the slope fails in some runs and stands in others: the scatter is "
                            "that between the two, not that of a volume; use the probabilities at each intensity",
                            NOTE),
    "reaches at times": Words("at {variable} {values} the mass reaches the road in some runs only: the scatter is that "
                              "between the two, not that of a volume; use the probabilities at each intensity", NOTE),
    "other mass": Words("the mapped deposit holds {percent:.0f} % {which} than is released, {mapped:,.0f} m3 of "
                        "{released:,.0f}: thicknesses and volumes cannot agree everywhere", NOTE),
    "not repeated": Words("the scatter is that of {repeated} alone: {offsets} of the deck not repeated", NOTE),
    "half step": Words("half the time step, rolling {rolling}: {volume} m3 instead of {mean} to remove{by}; {more} "
                       "than chance explains, {chance} m3", NOTE),
    # on an ensemble, one by known events, a chain
    "failed points": Words("{failed} of {runs} runs failed: the estimates exclude them, and the bounds allow any value "
                           "for them{wide}", NOTE),
    "unbounded": Words("{finished} runs do not bound the {shares} quantile from above: {quantity}", NOTE),
    "emulator": Words("{quantity}: {verdict}", NOTE),
    "no event": Words("{text}", NOTE),
    "few lengths": Words("fewer than two runs have a deposit", NOTE),
    "events beyond": Words("no run goes beyond {length}; {share} of known events do: they count as exceeding every "
                           "value; {remedy}", NOTE),
    "events before": Words("no run ends before {length}; {share} of known events do: they count as the shortest "
                           "runs, in the bounds as anything", NOTE),
    "gap": Words("between {low} and {high} no run ends; {share} of known events do: they count as the runs on either "
                 "side", NOTE),
    "few effective": Words("the weighted runs say as much as {effective:.0f} runs of equal weight: take more points",
                           NOTE),
    "no length": Words("{failed} of {runs} runs have no length (they failed, or left no deposit): the bounds allow any "
                       "value for them", NOTE),
    "lengths lost": Words("{lost} of {runs} runs lost more than {percent:g} % of their volume over the edge: their "
                          "lengths, and so the weights, are those of what stayed; take a larger terrain", NOTE),
    "outside of set": "{text}; that set says nothing of this mass",
    "second opinion": "{name}, whose friction falls with the volume, has the mass end after {near} to {far}, {events} "
                      "after {known_near} to {known_far}: nothing in common, {farther} go farther",
    "path ends": "the path leaves the terrain after {length}, where {share} of known events go on: take a larger "
                 "terrain",
    "body without run": Words("body {body} has no finished run: all of it, {volume:,.0f} m3, counts as on the road; "
                              "more points (--sample)", NOTE),
    "body beyond the curve": Words("body {body} has no run, as it hardly fails below the hazard curve's last peak: all "
                                   "of it, {volume:,.0f} m3, counts as on the road; a curve with larger peaks", NOTE),
    "more per year": Words("peaks above the hazard curve's last may add up to {per_year:.2g} per year to more than "
                           "{volume:,.6g} m3", NOTE),
    "body size": Words("no run of body {body} has the finest balls: it is corrected by what other bodies tell; more "
                       "points with finer balls (--minutes)", NOTE),
    "chain size": Words("what finer balls would change, and so how often the road is blocked, is not known", NOTE),
    # on a calibration
    "failed fits": Words("{failed} of {runs} runs failed and are left out: {which}", NOTE),
    # of sites of single blocks
    "blocks on level ground": "the release area falls by {slope:.1f} degrees, less than {limit:g}: blocks hardly move",
    "blocks below cell": Words("the blocks, {size:g} m, are smaller than the cells of the terrain, {cell:g} m: steps "
                               "and ledges that throw them are not in it", NOTE),
    "blocks left": "{left:,} of {blocks:,} blocks left the terrain{without}: how far they go is not known, and what is "
                   "said of it is the least; use a larger elevation model",
    "blocks moving": "{moving:,} of {blocks:,} blocks still moved at the end of their run: what is said of reach is "
                     "the least; a longer model.duration in site.yaml",
    "blocks still": Words("{still:,} of {blocks:,} blocks stay where they begin, within {limit:g} diameters, held by "
                          "the roughness of the ground, more of them the flatter it is: they count in all shares",
                          NOTE),
    "blocks too fast": "contacts overlap by up to {percent:.0f} % of the radius: a larger model.speed in site.yaml",
    "lost fits": Words("{lost} of {runs} runs lost up to {volume:,.0f} m3 over the edge of the terrain or the box: how "
                       "far they went is unknown, and they are left out; use a larger one", NOTE),
    "underdetermined": Words("{known} cannot determine {asked} variables", NOTE),
    "no scatter": Words("too few runs to measure the scatter by chance of {which}: the region may be too narrow", NOTE),
    "one lattice": Words("the balls of all runs begin alike, {offsets} not being repeated: the scatter by chance "
                         "(s) lacks what another start changes, and the region may be too narrow or beside the truth",
                         NOTE),
}


def words_of(kind: str) -> Words:
    found = WORDS[kind]
    return found if isinstance(found, Words) else Words(found)
