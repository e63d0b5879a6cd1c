"""Outputs as tables: by the models of a known process, by their values of an unknown one."""

from safestart.processes.tables.columns import Kind as Kind
from safestart.processes.tables.rows import Rows as Rows
from safestart.processes.tables.rows import tables_of as tables_of
from safestart.processes.tables.typed import TypedTable as TypedTable
from safestart.processes.tables.typed import typed_tables as typed_tables
