"""Doxygen's input filter: prints the given file as Doxygen reads it.

A header's contents enter the module of its folder (structure.dox): math/model/x.hpp is part of math_model. Every heading
of a README gets an id, and links to READMEs name these ids: launch/README.md#watching-it becomes #page-launch-watching-it.
Doxygen warns of ids that do not exist. Links to files that are not pages, such as messages, become text.
"""

import os
import re
import sys

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEADING = re.compile(r"^```.*?^```|^(#+) (.*?)$", re.M | re.S)  # skips code blocks: their comments look like headings
TEXT = re.compile(r"^ *///<? (?! {3})(.*)$|///< (.*)$", re.M)  # of a docstring, without its code blocks
# Dots that do not end a sentence, but would end the summary: 0 .. N; eq. (error1), (B. Delyon, ...).
DOTS = re.compile(r"(?<!\.)\.\.(?: |$)")
DOT = re.compile(r"(\b[Ee]qs?|\b[A-Z](?=\. [A-Z](?:\.|[\w-]+(?:,| and))))\.(?: |$)")
# A first word such as Motion or Link that does not mean the class of this name.
FIRST_WORD = re.compile(r"(^|[.:] )([A-Z][a-z]+)(?= [a-z])")
LINK = re.compile(r"(!?)\[([^]]*)\]\(([^)]*)\)")


def module(path):
    """The module of a header, by its path in the repository."""
    folders = path.split(os.sep)[1:-1]
    return "external_vehicle" if folders[0] == "include" else "_".join(folders[1:])


def docstring(found):
    """A line of a docstring, as Doxygen understands it."""
    text = found[1] or found[2] or ""
    clear = FIRST_WORD.sub(r"\1%\2", DOT.sub(r"\1.\\ ", DOTS.sub("..&nbsp;", text))) if "\\f" not in text else text
    return found[0][:len(found[0]) - len(text)] + clear


def header(text, path):
    text = TEXT.sub(docstring, text)
    # Replaces the empty line after it, so that line numbers do not change.
    text = re.sub(r"^(namespace platoon \{)\n$", r"\1 /** @addtogroup {}\n@{{ */".format(module(path)), text, flags=re.M)
    return re.sub(r"^\}  // namespace platoon$", r"/** @} */ \g<0>", text, flags=re.M)


def page(path):
    """The id of a README, by its path in the repository; headings append their own."""
    return "page-" + (os.path.basename(os.path.dirname(path)) or "readme")


def heading_id(text):
    """The anchor of a heading on hosts of repositories."""
    return re.sub(r"[^\w -]", "", text.lower()).replace(" ", "-")


def readme(text, path):
    def heading(found):
        if not found[1]:
            return found[0]
        own = page(path) + ("" if len(found[1]) == 1 else "-" + heading_id(found[2]))
        return "{} {{#{}}}".format(found[0], own)

    def link(found):
        image, words, target = found.groups()
        if ":" in target:
            return found[0]
        file, _, anchor = target.partition("#")
        file = os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path
        if image:
            return "![{}]({})".format(words, os.path.basename(file))
        if not file.endswith("README.md"):
            return words
        return "[{}](#{})".format(words, page(file) + ("-" + anchor if anchor else ""))

    return HEADING.sub(heading, LINK.sub(link, text))


def filtered(path):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    path = os.path.relpath(os.path.abspath(path), TOP)
    if path.endswith(".hpp"):
        return header(text, path)
    if path.endswith("README.md"):
        return readme(text, path)
    return text


if __name__ == "__main__":
    sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(filtered(sys.argv[1]))
