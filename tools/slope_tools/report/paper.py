"""A page as a PDF, printed by a browser that is installed: A4 pages with heads and numbers, by the page's style."""
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Optional

from .. import disk
from ..errors import SlopeError

# those that print from the command line; Firefox does not
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge")
PATIENCE = 180      # s
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


def write(page: Path, pdf: Path) -> None:
    """Print a page; the PDF is there whole or not at all. Raises SlopeError with the browser's last words."""
    program = require_browser()
    with tempfile.TemporaryDirectory(prefix="slope", ignore_cleanup_errors=True) as folder:
        printed = Path(folder) / "page.pdf"
        words = [program, *OPTIONS, f"--user-data-dir={folder}/profile", f"--print-to-pdf={printed}",
                 page.absolute().as_uri()]
        if os.geteuid() == 0:       # it refuses to run as root with its sandbox
            words.insert(1, "--no-sandbox")
        try:
            done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                  timeout=PATIENCE, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise SlopeError("--pdf", f"{program} must print {page}", error) from error
        content = printed.read_bytes() if printed.is_file() else b""
        if done.returncode or not content.startswith(b"%PDF"):
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()
            raise SlopeError("--pdf", f"{program} must print {page}", (said or [f"status {done.returncode}"])[-1][:200])
    disk.write(pdf, content)
