"""XML of a stranger as a tree of plain elements: no entities, no outside references, names without their namespace."""

import re
from collections.abc import Iterator
from xml.etree.ElementTree import Element, ParseError
from xml.sax.saxutils import escape, quoteattr

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from guidance_app.boundary import BoundaryError
from guidance_app.exchange.asking import briefly
from guidance_app.language import sentence

__all__ = ["Element", "children", "first", "local_name", "parsed", "quoted", "text_of", "written_text"]

_not_in_xml = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]").sub
DEEPEST = 200
"""Elements inside elements; files of this field stay below 20."""


def parsed(content: bytes, what: str) -> Element:
    """The root element. Raises ``BoundaryError``; ``what`` names the kind of file in its sentence."""
    try:
        root = fromstring(content.lstrip(b"\xef\xbb\xbf \t\r\n"), forbid_dtd=True)
    except DefusedXmlException as error:
        msg = sentence("it declares a document type or entities, which no {what} needs: it is not opened", what=what)
        raise BoundaryError(msg) from error
    except (ParseError, ValueError, LookupError) as error:
        msg = sentence("it is not sound XML, so not {what} ({reason})", what=what, reason=briefly(error))
        raise BoundaryError(msg) from error
    if not isinstance(root, Element) or _depth_exceeds(root, DEEPEST):
        msg = sentence("it is nested too deeply to be {what}", what=what)
        raise BoundaryError(msg)
    return root


def _depth_exceeds(root: Element, limit: int) -> bool:
    level = [root]
    for _ in range(limit):
        level = [child for element in level for child in element]
        if not level:
            return False
    return True


def local_name(element: Element) -> str:
    """The name without namespace; '' for a comment."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def children(element: Element, *names: str) -> Iterator[Element]:
    """The children of these names."""
    return (child for child in element if local_name(child) in names)


def first(element: Element, *path: str) -> Element | None:
    """The first descendant along a path of names; None without one."""
    found: Element | None = element
    for name in path:
        found = None if found is None else next(children(found, name), None)
    return found


def written_text(text: str) -> str:
    """The text as it may stand in XML, which has no place for control characters."""
    return escape(_not_in_xml(" ", text))


def quoted(text: str) -> str:
    """The same as the value of an attribute, with its quotes."""
    return quoteattr(_not_in_xml(" ", text))


def text_of(element: Element | None) -> str:
    """The element's own text without the spaces around it; '' for None."""
    return (element.text or "").strip() if element is not None else ""
