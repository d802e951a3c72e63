"""Speed against accuracy: scenes x methods to milliseconds a frame and errors against both truths (docs/chart.md)."""
