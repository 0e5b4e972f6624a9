"""Files of instruments and controls made the project's own: error tables, readings, points."""

from vmach.importers.catalogue import catalogue
from vmach.importers.importer import Imported, Importer, Section
from vmach.importers.importing import import_files
from vmach.importers.questions import Questions

__all__ = ["Imported", "Importer", "Questions", "Section", "catalogue", "import_files"]
