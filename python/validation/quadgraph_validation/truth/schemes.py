"""Meshes that the engine, or its CPU reference, solves for a study."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.core import load_core
from quadgraph.file import graph_file
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import boundary, moments
from quadgraph_validation.truth.boundary import Boundary
from quadgraph_validation.truth.fresnel import entering_share, transmittance_from_outside

_TOLERANCE = 1e-6  # of the engine's solver, single precision
_LARGEST_FACTOR = 4.0  # by which gathered radiance is scaled


@dataclass(frozen=True)
class Scheme:
    """What is compared: a method, a source and a model of the engine, by the names it uses."""

    method: str
    source: str
    model: str

    @property
    def name(self) -> str:
        """All three in one."""
        return f"{self.method} / {self.source} / {self.model}"

    @property
    def model_of(self) -> moments.ModelOf:
        """This model as the closed forms take it."""
        return {"diffusion": moments.diffusion, "sp3": moments.sp3}[self.model]

    def boundary(self, eta: float) -> Boundary:
        """This boundary condition as the closed forms take it."""
        if self == PUBLISHED:
            return boundary.published(eta)
        return {"diffusion": boundary.diffusion, "sp3": boundary.sp3}[self.model](eta, self.source == "diffuse")


PUBLISHED = Scheme("quadgraph-fdm", "diffuse", "diffusion")
DIFFUSION = Scheme("fem", "buried", "diffusion")
SP3 = Scheme("fem", "buried", "sp3")


@dataclass(frozen=True)
class StudyLight:
    """Irradiance that the surface lets in, (n_f, 3) W/mm^2, and the way it travels outside; None: Lambertian."""

    q: np.ndarray
    direction: tuple[float, float, float] | None


@dataclass(frozen=True)
class Answer:
    """Per outside face, in W/mm^2, (n_f, 3); power in W, (3,), under the names of the engine's report.

    leaving: from faces (n,) and unit outward directions (n, 3) to gathered and scaled radiance of scattered light,
    (n, 3) in W/(mm^2 sr), at their centroids (only fem with the buried source; only until the body's next solve).
    """

    phi: np.ndarray
    exitance: np.ndarray
    unscattered: np.ndarray
    energy: dict[str, np.ndarray]
    clipped: np.ndarray
    leaving: Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class StudyBody:
    """A mesh with the centroids (n_f, 3) mm, outward unit normals and areas (n_f,) mm^2 of its outside faces."""

    mesh: Graph
    centre: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    solve: Callable[[np.ndarray, np.ndarray, float, StudyLight, Scheme], Answer]

    def homogeneous(self, media: list[Medium], eta: float, light: StudyLight, scheme: Scheme) -> Answer:
        """Solve with one medium per channel everywhere."""
        return self.piecewise([media], np.zeros(len(self.mesh.nodes), np.int64), eta, light, scheme)

    def piecewise(
        self, regions: list[list[Medium]], region: np.ndarray, eta: float, light: StudyLight, scheme: Scheme
    ) -> Answer:
        """Solve with the media of regions[region[i]] at node i."""
        sigma_s_prime = np.array([[m.sigma_s_prime for m in channels] for channels in regions])[region]
        sigma_a = np.array([[m.sigma_a for m in channels] for channels in regions])[region]
        return self.solve(sigma_s_prime, sigma_a, eta, light, scheme)

    def mean(self, values: np.ndarray, faces: np.ndarray) -> np.ndarray:
        """Area-weighted mean (3,) of values (n_f, 3) over the chosen faces (n_f,) bool."""
        return self.area[faces] @ values[faces] / self.area[faces].sum()


# Makes a body of a mesh; which of the two solvers stands behind it is the caller's choice.
BodyOf = Callable[[Graph], StudyBody]


def chosen(device: str, reference: bool) -> BodyOf:
    """Bodies of the reference, or of the engine on a device."""
    return on_reference if reference else on_engine(device)


def on_reference(mesh: Graph) -> StudyBody:
    """A body that the CPU reference solves, in double precision."""
    core = load_core()
    with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
        loaded = core.load(graph_file.write(Path(folder) / "study.qgraph", [mesh]))

    def solve(sigma_s_prime: np.ndarray, sigma_a: np.ndarray, eta: float, light: StudyLight, scheme: Scheme) -> Answer:
        result = core.solve_reference(
            loaded,
            0,
            sigma_s_prime,
            sigma_a,
            eta,
            light.q,
            direction=light.direction,
            method=scheme.method,
            source=scheme.source,
            model=scheme.model,
        )

        def leaving(faces: np.ndarray, outward: np.ndarray) -> np.ndarray:
            light_inside = (sigma_s_prime, sigma_a, eta, light.q, light.direction, result["phi"])
            gathered = core.radiance_reference(loaded, 0, *light_inside, faces, outward)
            cosine = np.einsum("ij,ij->i", frames[1][faces], outward)
            return _scaled(mesh, faces, cosine, eta, gathered, result["exitance"])

        return _answer(result["phi_face"], result, result["energy"], result["clipped"], leaving)

    frames = meshes.face_frames(mesh)
    return StudyBody(mesh, *frames, solve)


def on_engine(device: str = "") -> BodyOf:
    """Bodies that the engine solves on the device `device` (docs/devices.md)."""

    def body_of(mesh: Graph) -> StudyBody:
        with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
            engine = load_core().Engine(graph_file.write(Path(folder) / "study.qgraph", [mesh]), device=device)

        def solve(
            sigma_s_prime: np.ndarray, sigma_a: np.ndarray, eta: float, light: StudyLight, scheme: Scheme
        ) -> Answer:
            engine.set_optical(0, sigma_s_prime, sigma_a, eta)
            engine.set_irradiance(0, light.q, light.direction)
            report = engine.solve(
                method=scheme.method,
                source=scheme.source,
                model=scheme.model,
                tolerance=_TOLERANCE,
                max_iterations=100_000,
            )
            field = engine.surface_field()

            def leaving(faces: np.ndarray, outward: np.ndarray) -> np.ndarray:
                return engine.leaving(faces, outward)["radiance"]

            return _answer(field["phi"], field, report["energy"], report["clipped"], leaving)

        return StudyBody(mesh, *meshes.face_frames(mesh), solve)

    return body_of


def _answer(
    phi: np.ndarray,
    field: dict,
    energy: dict,
    clipped: np.ndarray,
    leaving: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> Answer:
    return Answer(
        phi=np.asarray(phi, np.float64),
        exitance=np.asarray(field["exitance"], np.float64),
        unscattered=np.asarray(field["unscattered"], np.float64),
        energy={name: np.array(value) for name, value in energy.items()},
        clipped=np.asarray(clipped, np.float64),
        leaving=leaving,
    )


def _scaled(
    mesh: Graph, faces: np.ndarray, cosine: np.ndarray, eta: float, gathered: dict, exitance: np.ndarray
) -> np.ndarray:
    """Gathered radiance times M / M_gathered at the vertices, at most 4, and what is then missing of M as even.

    The engine takes both as means over a mean free path: the same on a flat body.
    """
    area = meshes.face_frames(mesh)[2] * (mesh.face_kinds == meshes.OPEN)
    corners = mesh.faces.ravel()
    around = np.maximum(np.bincount(corners, np.repeat(area, 3), len(mesh.vertices)), 1e-300)

    def at_vertices(values: np.ndarray) -> np.ndarray:
        sums = [np.bincount(corners, np.repeat(area * column, 3), len(mesh.vertices)) for column in values.T]
        return np.column_stack(sums) / around[:, None]

    wanted, found = at_vertices(exitance), at_vertices(gathered["exitance"])
    factor = np.clip(wanted / np.maximum(found, 1e-300), 0, _LARGEST_FACTOR)
    rest = np.maximum(wanted - factor * found, 0)[mesh.faces[faces]].mean(axis=1)
    even = transmittance_from_outside(cosine, eta) / (np.pi * entering_share(True, eta))
    return factor[mesh.faces[faces]].mean(axis=1) * gathered["radiance"] + rest * even[:, None]
