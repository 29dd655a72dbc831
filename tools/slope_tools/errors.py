"""The one exception for bad input."""


class SlopeError(Exception):
    """Bad input, told in one line: `where: rule, got value`.

    where is the file and the place in it (`dem.asc: line 8`) or the option (`--cell`); rule says what must hold;
    got is the offending value, if there is one to show. cli.main prints the line and exits with status 2.
    """

    def __init__(self, where, rule, got=None):
        line = f"{where}: {rule}" if got is None else f"{where}: {rule}, got {got}"
        super().__init__(" ".join(line.split()))
