"""Captures and their photographs, read and checked."""
