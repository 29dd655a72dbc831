"""The one exception for bad input."""
import os


class SlopeError(Exception):
    """Bad input, reported in one line: `where: rule, got value`.

    where is the file and the place in it (`dem.asc: line 8`) or the option (`--cell`); rule says what must hold;
    got is the offending value, if there is one to show. cli.main prints the line and exits with status 2. What files
    hold may be in any of them: a character that moves the cursor becomes a ?, and a long value is cut.
    """

    LONGEST = 500     # characters of a value

    def __init__(self, where: object, rule: str, got: object = None) -> None:
        line = f"{where}: {rule}"
        if got is not None:
            got = str(got)
            line += f", got {got[:self.LONGEST]}{'...' * (len(got) > self.LONGEST)}"
        super().__init__("".join(c if c.isprintable() else "?" for c in " ".join(line.split())))


def not_imported(error: Exception) -> SlopeError:
    """The error of a library that cannot be imported: variables may lead to those of another installation."""
    given = [f"{name}={os.environ[name]}" for name in ("PYTHONPATH", "PYTHONHOME", "LD_LIBRARY_PATH", "LD_PRELOAD")
             if os.environ.get(name)]
    remedy = f"; if it is of another installation, unset {', '.join(given)}" if given else ""
    return SlopeError("the libraries", f"must be those of this Python (Debian's){remedy}", error)
