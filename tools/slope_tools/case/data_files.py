"""Which files a deck needs in the folder where it runs."""
import os
import re
from typing import Set

from .. import disk
from ..errors import SlopeError
from ..schemas import TEXT, list_of, mapping
from . import decks, run_folders

# what runs, and the tools after them, leave in the deck's folder; a file that the deck reads is copied all the same
OUTPUTS = re.compile(r"^\.|^core|^log\.|\.(restart|dump|lammpstrj|vtp|vts|pvd)(\.gz)?$|\.(yaml|csv|tif)\.new$"
                     r"|\.summary\.yaml$|^report\.(section|numbers)\.csv$|\.(png|jpe?g|svg|pdf|html|tif)$|~$",
                     re.IGNORECASE)


WRITTEN = mapping({}, files=list_of(TEXT, null=True))     # of a summary


def data_files(deck, settings):
    """{path in the run folder: source} of the deck and the data beside it.

    The plain files of the deck's folder, without what runs leave there, and files in folders below that a word of the
    deck or a value names.
    """
    folder = deck.parent
    words, written = decks.named_files(deck)
    words.update(value for several in settings.values() for value in several)
    left: Set[str] = set()
    for summary in run_folders.summaries(folder):
        left.update(run_folders.load_summary(summary, WRITTEN).get("files") or ())
    files = {}
    for path in sorted(folder.iterdir()):
        if not disk.is_utf8(path.name):
            if os.fsencode(path.name).decode("utf-8", "replace") in words:      # as decks.commands() reads it
                raise SlopeError(deck, "must name files in UTF-8: rename it", disk.escape_name(path.name))
            continue
        output = OUTPUTS.search(path.name) or path.name in left or path.name in written
        if path.is_file() and (path.name in words or not output):
            files[path.name] = path
    files[deck.name] = deck
    for word in sorted({*words, *(path for word in words for path in decks.PATHS.findall(word))}):
        if "/" not in word or word.startswith("/") or "$" in word or not (folder / word).is_file():
            continue
        inside = os.path.normpath(word)
        if inside.startswith(".."):
            raise SlopeError(deck, "must find its data in its own folder (a symbolic link will do) or by an absolute "
                             "path", word)
        files[inside] = folder / word
    return files
