"""The page on a study or a run: slope report."""
from .algorithm import Algorithm
from .options import Option, of


class Report(Algorithm):
    """slope report"""

    command = "report"
    title = "Report"
    about = """
    One self-contained HTML page on a study or a run: maps, section, tables, volumes (m3), warnings.

    The section is along the path of the mass, or along a line layer. Beside the page: the heights along the
    section (m) and all numbers, as CSV."""
    options = (
        Option("FOLDER", "", "folder", "Folder of a study or of a run", needed=True),
        of("report", "section", "Line of the section", kind="line"),
        of("report", "shown", "Run of the study whose maps are shown", advanced=True),
        of("report", "local", "The line is in the local metres of the run, not in a CRS", advanced=True),
        of("report", "output", "The page", kind="new file", filter="HTML (*.html)"))
    outputs = (("file", "NUMBERS", "Numbers of the page, CSV"), ("file", "SECTION_TABLE", "Heights along the section"))

    def collect(self, asked, results):
        page = asked.output("OUTPUT")
        stem = page.rsplit(".", 1)[0]
        results.put(OUTPUT=page, NUMBERS=f"{stem}.numbers.csv", SECTION_TABLE=f"{stem}.section.csv")
