"""The failures a caller can meet; every message says where, what was found, and what is allowed."""

from quadgraph.base.message import shortened


class QuadGraphError(Exception):
    """Base of all errors that the command line turns into one line and a non-zero exit code; it keeps them short."""

    def __init__(self, message: object = "") -> None:
        super().__init__(shortened(str(message)))


class FormatError(QuadGraphError):
    """A .qgraph file that breaks docs/qgraph-format.md."""


class InputError(QuadGraphError):
    """A mesh, scene, option or array that cannot be used."""


class ToolError(QuadGraphError):
    """A child program (TetGen, the CGAL mesher) that is missing, failed, or ran past its limit."""


class SolverError(QuadGraphError):
    """A linear solve that broke down or diverged."""


class DeviceError(QuadGraphError):
    """A device that is not there, lacks what the engine needs, or failed."""
