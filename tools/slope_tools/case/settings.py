"""The meaning of --set, --vary, --repeat and --converge: variables of a deck and lists of their values."""
import decimal

from ..errors import SlopeError
from . import deck_ranges, decks

MOST_RUNS = 10_000


def normalise_value(text):
    """A value as a float where it is one, so that 0.1 and 0.10 are one value; else the text."""
    try:
        return float(text)
    except ValueError:
        return text


def middle(several):
    """The value in the middle of a list by size, whatever its order; of values that are no numbers by the order."""
    try:
        return sorted(several, key=float)[len(several) // 2]
    except ValueError:
        return several[len(several) // 2]


def check_names(names, deck, option, options):
    """The names that options NAME=... give, all of them different index variables of the deck; SlopeError otherwise."""
    variables = decks.variables(deck)
    known = {name for name, (style, _) in variables.items() if style == "index"}
    fixes = [words for words in decks.commands(deck) if words[0] == "fix" and words[3:4] == ["deposit/grid"]]
    if len(fixes) != 1:
        raise SlopeError(deck, "must have one fix deposit/grid, which gives the deposit", len(fixes))
    for i, (name, words) in enumerate(zip(names, options)):
        if not name or "=" not in words:
            raise SlopeError(option, "must be NAME=V1,V2,... or NAME=A:B:STEP", words)
        if name not in known:
            style = f"{name} of style {variables[name][0]}" if name in variables else name
            raise SlopeError(option, f"must name an index variable of {deck} ({', '.join(sorted(known)) or 'none'})",
                             style)
        if name in names[:i]:
            raise SlopeError(option, "must name a variable once", f"{name} twice")
    return names


def check_settings(options, deck, option="--set"):
    """{name: [values]} of the options NAME=VALUES, in their order.

    Every name must be an index variable of the deck, and no value may leave the range that the deck has for it.
    """
    names = check_names([words.partition("=")[0] for words in options], deck, option, options)
    checks = deck_ranges.Checks(deck)
    settings = {}
    for name, words in zip(names, options):
        settings[name] = parse_setting_values(words, words.partition("=")[2], option)
        if option != "--set" or len(settings[name]) > 1:
            checks.vary(option, name, words)
        for value in settings[name]:
            checks.value(option, name, value, words)
    return settings


def parse_setting_values(words, text, option="--set"):
    """The values that the right side of an option NAME=VALUES stands for, as text; words: all of it."""
    values = []
    for part in text.split(","):
        ends = part.split(":")
        if not part.strip():
            raise SlopeError(option, "must have no empty value", words)
        try:
            numbers = [decimal.Decimal(end) for end in ends] if len(ends) == 3 else None
        except decimal.InvalidOperation:
            numbers = None
        if numbers is None:
            values.append(part)
            continue
        start, stop, step = numbers
        if not all(end.is_finite() for end in numbers) or step == 0 or (stop - start) / step < 0:
            raise SlopeError(option, "A:B:STEP must have a STEP that leads from A to B", words)
        if (stop - start) / step >= MOST_RUNS:
            raise SlopeError(option, f"must make at most {MOST_RUNS} runs", words)
        values += [format_decimal(start + i * step) for i in range(int((stop - start) / step) + 1)]
    keys = [normalise_value(value) for value in values]
    for i, key in enumerate(keys):
        if key in keys[:i]:
            raise SlopeError(option, "must have every value once", f"{words} with {values[i]} twice")
    return values


def format_decimal(value):
    """A decimal as text, without trailing zeros and, if it is short, without an exponent."""
    value = value.normalize() + 0
    return f"{value:f}" if -12 < value.adjusted() < 12 else str(value)


def one_value_each(settings, option, several):
    """{name: value} of settings of one value each; SlopeError otherwise, which says which options take several."""
    for name, found in settings.items():
        if len(found) > 1:
            raise SlopeError(option, f"must give one value ({several} take several)", f"{name}={','.join(found)}")
    return {name: found[0] for name, found in settings.items()}
