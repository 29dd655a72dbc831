"""What the tests hold of a message: the item, the numbers of the rule and the value, not its prose."""
import re


def pattern(message):
    """A regular expression for a message "ITEM must RULE, got VALUE", as far as one of the form was given.

    The words of the rule and of a remedy after the value may change, if a number or a value is left to hold; a message
    of another form is its whole text.
    """
    parts = re.fullmatch(r"(.+?) must (.+?)(?:, got (.*?)(?:: .*)?)?", message)
    if not parts:
        return re.escape(message)
    item, rule, value = parts.groups()
    # numbers and comparisons; what is in a name, such as x2, is not
    pieces = re.findall(r"(?<![\w.])[-+]?\d[\d.]*(?:e[-+]?\d+)?(?![\w.])|[<>]=?", rule)
    if value is None and not pieces:
        return re.escape(message)
    wanted = [item + " ", *pieces, *([f"got {value}"] if value is not None else [])]
    whole = r"(?!\w|\.\d)" if wanted[-1][-1].isalnum() else ""     # not the 1 of 12
    return ".*?".join(map(re.escape, wanted)) + whole


def says(line, message):
    """Whether a line has the item, the numbers of the rule and the value of a message, see pattern()."""
    return re.search(pattern(message), line) is not None


def is_one(text, message):
    """Whether a text is one line, which begins with what says() looks for."""
    return text.count("\n") == 1 and re.match(pattern(message), text) is not None
