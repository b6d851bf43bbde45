"""Names of files and other foreign text, as they can be shown in a terminal."""


def printable(text: object) -> str:
    r"""Return a text with all that is not to be printed escaped, such as `\x1b`; line breaks stay."""
    return "".join(each if each.isprintable() or each == "\n" else _escaped(each) for each in str(text))


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")
