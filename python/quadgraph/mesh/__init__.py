"""Triangle surfaces: read, repaired, simplified, and mapped to what is displayed."""
