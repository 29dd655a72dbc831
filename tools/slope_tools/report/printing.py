"""A page as a PDF, printed by a browser that is installed: A4 pages with heads and numbers, by the page's style."""
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import List, Optional, Tuple

from .. import disk, processes
from ..errors import SlopeError

# those that print from the command line; Firefox does not
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge")
PATIENCE = 300      # s; a page with a 3-D view takes some seconds of a processor that does nothing else
# the 3-D view is drawn without a graphics card
OPTIONS = ("--headless", "--disable-extensions", "--use-gl=angle", "--use-angle=swiftshader",
           "--enable-unsafe-swiftshader", "--no-first-run", "--no-pdf-header-footer")


def browser() -> Optional[str]:
    """The program of a browser that prints; None where none is installed."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def require_browser() -> str:
    """It; SlopeError where there is none."""
    found = browser()
    if found is None:
        raise SlopeError("--pdf", f"needs a browser that prints, {' or '.join(BROWSERS[::2])}: install one (Debian: "
                         "chromium), or print the page from any browser", "none on PATH")
    return found


def print_page(page: Path, pdf: Path) -> None:
    """Print a page; the PDF is there whole or not at all. Raises SlopeError with the browser's last words."""
    program = require_browser()
    with tempfile.TemporaryDirectory(prefix="slope", ignore_cleanup_errors=True) as folder:
        printed = Path(folder) / "page.pdf"
        words = [program, *OPTIONS, f"--user-data-dir={folder}/profile", f"--print-to-pdf={printed}",
                 page.absolute().as_uri()]
        if os.geteuid() == 0:       # it refuses to run as root with its sandbox
            words.insert(1, "--no-sandbox")
        status, last_words = run_browser(words, Path(folder))
        content = printed.read_bytes() if printed.is_file() else b""
        if status is None:
            raise SlopeError("--pdf", f"{program} must print {page} within {PATIENCE:g} s: try again when less runs on "
                             "this machine, or print the page from any browser", "nothing by then")
        if status or not content.startswith(b"%PDF"):
            raise SlopeError("--pdf", f"{program} must print {page}", last_words or f"status {status}")
    disk.write_file(pdf, content)


def run_browser(words: List[str], folder: Path) -> Tuple[Optional[int], str]:
    """Run a browser: its status, None if it had to be ended, and its last words. No process of it is left."""
    with open(folder / "said", "wb") as screen:     # a pipe would wait for processes that the browser leaves
        try:
            process = processes.start(words, folder, screen)
        except OSError as error:
            return 1, str(error)
        try:
            status: Optional[int] = process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            status = None
        finally:
            processes.stop_session(process)
    said = (folder / "said").read_bytes().decode("utf-8", "replace").strip().splitlines()
    return status, said[-1][:200] if said else ""
