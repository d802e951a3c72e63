"""The QuadGraph paper's tables and figures again, its method beside ours in one run (docs/tables.md)."""
