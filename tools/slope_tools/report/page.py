"""All that a report shows, read, computed and drawn: what stands on top, and the sections in their order."""
from .. import provenance
from ..animation import film, frames, view
from ..plots.ground import Ground
from ..plots.section import Section
from ..studies import letter
from ..tables import quantities
from ..tables.quantities import On
from . import (body, chain_part, client_part, convergence_part, ensemble_part, heading, intensity_part, limits_part,
               mobility_part, reference, road_part, run_part, study_part)
from .data import Data
from .heading import Asked
from .maps_part import Maps
from .numbers import Numbers, cards, sweep_card
from .sections import Picture
from .structures_part import Structures
from .warnings import findings, rank_warnings


class Page:
    """A page: data, ground, section, findings, warnings (level, text), and numbers."""

    def __init__(self, asked: Asked):
        self.data = Data(asked.folder, asked.shown, asked.study, asked.site)
        self.ground = Ground(self.data)
        self.section = Section(self.data, self.ground, asked.section, asked.local)
        self.reference = reference.read_reference(asked.reference, quantities.known(On.ASKED, self.data.compared)) \
            if asked.reference else None
        path = convergence_part.find(asked.converge)
        self.sizes = path and convergence_part.Sizes(path)
        self.findings = findings(self.data, self.ground)
        self.warnings = rank_warnings(self.findings, self.data.names())
        self.numbers = Numbers()
        self.heading = heading.heading(asked.folder, {name: getattr(asked, name) for name in heading.FIELDS},
                                       self.data.site)
        self.frames, self.no_frames = frames.read_frames(self.data.result)
        self.film_file, self.film = asked.film, film.Film(None, "")

    def content(self):
        """What the template takes."""
        data, ground, numbers = self.data, self.ground, self.numbers
        maps = Maps(data, ground, self.section)
        if self.film_file:
            self.film = film.film(data, ground, self.section, maps.layers, self.frames, self.film_file.name)
        of_run, made = maps.of_run(), run_part.utc(provenance.now())
        answers = sweep_card(data, numbers), ensemble_part.ensemble_card(data, numbers)
        top = {"made": made, "study": data.study, "summary": data.result.summary, "repeats": data.repeats,
               "varied": [key for key, several in data.settings.items() if len(several) > 1],
               "heading": self.heading, "body": body.of_data(data, ground), "warnings": self.warnings,
               "answer": answers[0], "of_ensemble": answers[1], "cards": cards(data, numbers),
               "map": of_run["deposit"], "section": Picture(*self.section.picture()),
               "view": view.make_view_content(data, ground, self.section, self.frames, self.no_frames, self.film.text),
               "place": ground.raster.crs is not None, "limits": limits_part.make_limits_section(data, ground, numbers),
               **self.what()}
        sections = [
            *ensemble_part.sections(data, numbers, maps),
            study_part.make_study_section(data, numbers, self.reference, maps),
            mobility_part.mapped(data, numbers),
            road_part.make_roads_section(data),
            road_part.make_road_section(data, numbers, maps),
            limits_part.zones_of_ground(data, numbers),
            chain_part.make_chain_section(data, numbers),
            intensity_part.make_intensity_section(data, numbers),
            Structures(data, numbers, ground).section(),
            self.sizes and self.sizes.section(numbers),
            reference.make_reference_section(self.reference, data, numbers),
            maps.section(of_run),
            run_part.balance(data, numbers),
            run_part.for_offices(data, ground, numbers),
            run_part.what_was_run(data),
            run_part.origin(data, made)]
        client = client_part.make_client_content(data, ground, numbers, self.findings, len(self.warnings))
        return {**top, "client": client, "sections": [one for one in sections if one]}

    def what(self):
        """Name, title, and purpose: the first line of the deck, whose others are for those who run it."""
        data, first = self.data, run_part.deck_of(self.data)[1].split("\n", 1)[0]
        name = self.heading["project"] or data.folder.absolute().name
        runs = letter.title_runs(data.study) if data.study else "one run"
        purpose = first.lstrip("# ").removesuffix("; made by slope site, yours to change") if first[:1] == "#" else ""
        return {"name": name, "title": f"Slope collapse: {name}", "what": f"Slope collapse, {runs}", "purpose": purpose}
