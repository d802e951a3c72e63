"""The studies behind docs/accuracy.md: what was measured, as a record for JSON, and as tables for people."""
