"""XML files of instruments, read without what could hurt."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from vmach.importers.source_file import SourceFile

__all__ = ["local", "xml_root"]


def xml_root(source: SourceFile) -> ET.Element:
    """The root of a document; names keep their namespaces.

    Raises
    ------
    InputError
        It is no XML, with the line; or it defines entities, which instruments never do.
    """
    if re.search(r"<!(DOCTYPE|ENTITY)", source.text[:10_000]):
        raise source.error("has a document type", line=1, accepted="XML without one")
    try:
        return ET.fromstring(re.sub(r"^\s*<\?xml[^>]*\?>", "", source.text))
    except (ET.ParseError, ValueError) as error:
        line = error.position[0] if isinstance(error, ET.ParseError) else 1
        raise source.error(f"is no XML: {error}", line=line, accepted="a whole document") from None
    except RecursionError:
        raise source.error("is nested too deeply", line=1, accepted="a report") from None


def local(element: ET.Element) -> str:
    """The name of an element without its namespace."""
    return element.tag.rsplit("}", 1)[-1]
