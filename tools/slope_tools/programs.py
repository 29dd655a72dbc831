"""Which LAMMPS program runs which code: --lmp of commands that compare several."""
from .errors import SlopeError
from .study import find_lmp


def lmp_of_each(options, names):
    """The program that --lmp FILE names (default: find_lmp's), and {code: program} of --lmp CODE=FILE; absolute
    paths. names: the codes that may have a program of their own.
    """
    everybody, own = None, {}
    for option in options or ():
        code, equals, file = option.partition("=")
        if not equals:
            if everybody is not None:
                raise SlopeError("--lmp", "must name one program for all, others as CODE=FILE", option)
            everybody = option
        elif code not in names:
            raise SlopeError("--lmp", f"must be FILE, or CODE=FILE with CODE of {', '.join(names)}", option)
        else:
            own[code] = find_lmp(file)
    return find_lmp(everybody), own
