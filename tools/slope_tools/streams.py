"""Standard output and error of the program, which a service may close, `| head` leaves and a full disk refuses.

None of that ends the work: what cannot be written is dropped, runs go on, files are complete, and the exit status says
it at the end.
"""
import io
import os
import select
import sys
from typing import Optional, Tuple, cast

NAMES = {"stdout": "standard output", "stderr": "standard error"}


class Stream(io.FileIO):
    """Of a number; once it cannot be written, `failure` says why, and what is written to it is dropped."""
    failure: Optional[OSError] = None

    def write(self, data):
        while self.failure is None:
            try:
                done = cast(Optional[int], super().write(data))
            except OSError as error:
                self.failure = error
            else:
                if done is not None:
                    return done
                select.select([], [self], [])       # it is full for now, and who made it does not want to wait
        return memoryview(data).nbytes


def replace() -> None:
    """Make the streams of this process ones that never fail; one that is closed becomes os.devnull.

    Closed ones must not be left to the files that are opened next, which would receive what programs of C print.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)     # the least number that is free
    for number, name in enumerate(NAMES, 1):
        old = getattr(sys, name) or io.TextIOWrapper(io.BytesIO(), "utf-8")
        setattr(sys, name, io.TextIOWrapper(io.BufferedWriter(Stream(number, "wb", closefd=False)), old.encoding,
                                            "backslashreplace",     # of a terminal that does not have a letter
                                            line_buffering=old.line_buffering, write_through=old.write_through))


def failure() -> Optional[Tuple[str, OSError]]:
    """The name of a stream that could not be written, and why; None if all has been written."""
    for name, what in NAMES.items():
        stream = getattr(sys, name)
        stream.flush()
        if stream.buffer.raw.failure:
            return what, stream.buffer.raw.failure
    return None


def is_terminal(stream) -> bool:
    """Whether a stream, None where Python has none, is a terminal."""
    return stream is not None and stream.isatty()
