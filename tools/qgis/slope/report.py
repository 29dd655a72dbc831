"""The page on a study or a run: slope report."""
from .algorithm import Algorithm
from .options import Option


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
        Option("SECTION", "--section", "line", "Line of the section"),
        Option("SHOWN", "--run", "text", "Run of the study whose maps are shown", advanced=True),
        Option("LOCAL", "--local", "switch", "The line is in the local metres of the run, not in a CRS", advanced=True),
        Option("OUTPUT", "-o", "new file", "The page", filter="HTML (*.html)"))
    outputs = (("file", "NUMBERS", "Numbers of the page, CSV"), ("file", "SECTION_TABLE", "Heights along the section"))

    def collect(self, asked, results):
        page = asked.output("OUTPUT")
        stem = page.rsplit(".", 1)[0]
        results.put(OUTPUT=page, NUMBERS=f"{stem}.numbers.csv", SECTION_TABLE=f"{stem}.section.csv")
