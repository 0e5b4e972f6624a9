"""Formats of compensation tables, one file each; see `vmach.controller_tables.table_formats`."""
