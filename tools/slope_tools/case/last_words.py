"""Why a run of LAMMPS ended: its own last words, in its log and on the screen, among those of MPI and its launcher."""
import re

from . import logs

BOX = re.compile(r"-{74}")                  # Open MPI's messages stand between two such lines
LAUNCHER = re.compile(r"""
    \[[^\]\s]+(:\d+|@[^\]]*)?\]\s           # [host:pid] of Open MPI, also of a trace; [mpiexec@host] of MPICH
    | application\ called\ MPI_Abort | Abort\(\d+\)\ on\ node
    | =(\s|=) | YOUR\ APPLICATION\ TERMINATED | This\ typically\ refers\ to\ a\ problem\ with\ your
    | Please\ see\ the\ FAQ\ page | mpirun: | mpiexec | prterun | srun: | slurmstepd: | Image\s+PC\s
    """, re.VERBOSE)
# of an exception that LAMMPS' main() catches (it ends with status 1 and leaves no ERROR), or that nobody does
EXCEPTION = re.compile(r"C\+\+ memory allocation failed: |Exception: |fmt::format_error: |JSON library error \d+: "
                       r"|terminate called |\s+what\(\): ")


class Screen:
    """What a run said on the screen since a place in the file: error, exception and last line of LAMMPS; launcher.

    Each is None if there is none; of several errors and of several lines of the launcher the first counts.
    """

    def __init__(self, path, begin=0):
        self.error = self.exception = self.last = self.launcher = None
        try:
            with open(path, "rb") as screen:
                screen.seek(begin)
                lines = screen.read().decode("utf-8", "replace").splitlines()
        except OSError:
            return
        boxed = False
        for line in lines:
            if BOX.fullmatch(line.strip()):
                boxed = not boxed
            elif line.strip(" -\t"):
                self._line(line, boxed)

    def _line(self, line, boxed):
        if is_error(line):      # in whatever company
            self.error = self.error or logs.message(line)
        elif EXCEPTION.match(line):
            if not self.exception or self.exception.startswith("terminate called"):
                self.exception = line.strip()
        elif boxed or LAUNCHER.match(line):
            self.launcher = self.launcher or line.strip()
        else:
            self.last = line.strip()

    def words(self):
        """What says best why LAMMPS ended, '' if nothing was said."""
        return self.error or self.exception or self.last or self.launcher or ""


def is_error(line):
    """Whether it is a line with which LAMMPS ends."""
    return bool(re.match(r"ERROR(?: on proc \d+)?: ", line))


def reason(log, screen):
    """Why a run ended, from its logs.Log and its Screen: the ERROR line of its log, else the last of its output."""
    return log.error or screen.words()


def spoiled_restart(log, screen, crashed):
    """Whether LAMMPS ended because of the restart file from which it was to continue.

    log: logs.Log; screen: Screen; both of what was said since it began. crashed: ended by a signal, but not killed.
    LAMMPS that meets nonsense ends with an ERROR line while it reads, or crashes, or, since 2023, runs out of memory
    and catches that; then the rest of its log is lost, and so is what it was doing.
    """
    if log.reading:
        return True
    if log.error or screen.error or log.thermo:
        return False
    return crashed or bool(screen.exception)
