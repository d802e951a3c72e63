"""One body on one device: its material, lights and shape, the solve, and pictures of it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal, Self, Unpack, get_args, overload

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.api.coefficients import Coefficients, coefficients_at
from quadgraph.api.deformers import Deformer, as_dict
from quadgraph.api.derivatives import ForwardModel, Views, forward_model
from quadgraph.api.fields import Fluence, SurfaceField, WalkedExitance
from quadgraph.api.lights import Light, as_light
from quadgraph.api.materials import Material, VolumeMaterial
from quadgraph.api.mesh_fields import MeshFields, Part, of_body, of_surface
from quadgraph.api.options import MOTION, Camera, MotionOptions, PictureOptions
from quadgraph.api.picture import Picture
from quadgraph.api.places import as_points, triple
from quadgraph.api.solution import Solution
from quadgraph.api.values import Floats, plain_members
from quadgraph.base.errors import InputError
from quadgraph.base.units import DEFAULT_ETA

if TYPE_CHECKING:
    import meshio
    import pyvista


class Engine:
    """A baked .qgraph on a device. Use it in a `with` block, or call `close`, to free the device's memory.

    The lights are `default_lights` of the body's front until others are set; a material is wanted before `solve`.
    """

    def __init__(self, path: str | Path, *, device: str = "", validation: bool = False) -> None:
        """Load a file. device: cpu, or part of a Vulkan device's name; default: a GPU, else cpu. validation: load the
        validation layer of a Vulkan device. Raises FormatError, InputError, DeviceError.
        """
        self._open: core.Engine | None = core.Engine(Path(path), device, validation)
        self._name = Path(path).name
        self._material: Material | VolumeMaterial | str | None = None
        self._materials: dict[str, Material | str] = {}
        self._placements: dict[str, dict[str, tuple[float, float, float]]] = {}
        self._solution: Solution | None = None
        self.lights = core.default_lights("", "y", self._open.graph.front)

    @classmethod
    def _around(cls, engine: core.Engine, name: str) -> Self:
        """Return one around the engine of a stage, whose scene sets material and lights; `name`: of the body's file."""
        self = cls.__new__(cls)
        self._open, self._name, self._material, self._lights, self._solution = engine, name, None, (), None
        self._materials, self._placements = {}, {}
        return self

    def __repr__(self) -> str:
        """Return body, material, lights, method and device in one line."""
        if self._open is None:
            return f"Engine({self._name}, closed)"
        levels, (low, high) = self._open.graph.levels, self.box
        parts = [f"{' x '.join(f'{each:.4g}' for each in high - low)} mm"]
        parts += [f"{len(levels[0].tets):,} tets, {len(levels)} level{'s' * (len(levels) > 1)}"] if levels else []
        if self._materials:
            parts.append(f"materials of {', '.join(self._materials)}")
        elif (material := self._material) is not None:
            parts.append(f"material {material}" if isinstance(material, str) else f"a {type(material).__name__}")
        parts += [f"{len(self._lights)} light{'s' * (len(self._lights) != 1)}"] if self._lights else []
        parts += [f"solved by {self._solution.method}"] if self._solution else []
        return f"Engine({self._name}: {', '.join(parts)}; {self.device})"

    @property
    def _engine(self) -> core.Engine:
        if self._open is None:
            raise InputError("the engine is closed")
        return self._open

    def close(self) -> None:
        """Free the device's memory; whatever is asked afterwards raises InputError. Pictures and arrays stay."""
        self._open = None

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close."""
        self.close()

    @property
    def material(self) -> Material | VolumeMaterial | str | None:
        """What was set last: a `Material`, a `VolumeMaterial`, or a text as --material takes it. Raises InputError."""
        return self._material

    @material.setter
    def material(self, material: Material | VolumeMaterial | str) -> None:
        if isinstance(material, VolumeMaterial):
            material.set_on(self._engine)
        else:
            self._engine.set_material(_material_text(material))
        self._material, self._materials = material, {}

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies in the file; none of a file of one body."""
        return tuple(self._engine.graph.bodies)

    @property
    def hosts(self) -> dict[str, str]:
        """Of each of `bodies` that lies within another's solid and shares its surface with it, the name of that one."""
        names = self.bodies
        found = zip(names, self._engine.graph.hosts, strict=True)
        return {name: names[host] for name, host in found if names[host] != name}

    @property
    def materials(self) -> dict[str, Material | str]:
        """What was set for bodies by their names, each a `Material` or a text as --material takes it.

        To set them, a mapping: bodies that it does not name have `material`, which is wanted then. To set `material`
        sets all bodies. One of `hosts` may have an index of refraction of its own; the report of a solve says where the
        method leaves that out. Raises InputError, also for a body that the file does not have.
        """
        return dict(self._materials)

    @materials.setter
    def materials(self, materials: Mapping[str, Material | str]) -> None:
        others, missing = self._material, [name for name in self.bodies if name not in materials]
        if missing and not isinstance(others, Material | str):
            raise InputError(f"materials: none for {', '.join(missing)}; name them too, or set a material before")
        texts = {name: _material_text(material) for name, material in materials.items()}
        # Without others, what stands for them is of no use to anyone.
        rest = _material_text(others) if isinstance(others, Material | str) else next(iter(texts.values()), "")
        self._engine.set_materials(texts, rest)
        self._materials = dict(materials)

    def set_coefficients(self, function: Coefficients, eta: float = DEFAULT_ETA) -> None:
        """Take coefficients from a function in place of a material (not with shortest-path, which wants a grid).

        function: given points of the body at rest, (n, 3) float32 mm, returns sigma_s_prime and sigma_a, 1/mm, each one
        number, (n,), (n, 3), or (3,) for all points; it is called once for every level, at the middles of tets and
        outside faces, and once at other points of the finest tets, by which the error of one value in each is told.
        `VolumeMaterial.from_function` makes a grid of it. Raises InputError, and sets nothing, for other shapes and for
        numbers that are negative or not finite.
        """
        if np.ndim(eta) or np.asarray(eta).dtype.kind not in "fiub":
            raise InputError(f"eta: {type(eta).__name__} found, a number is wanted")
        graph = self._engine.graph
        found = [coefficients_at(function, np.array(level.nodes)) for level in graph.levels]
        elsewhere = coefficients_at(function, core.points_in_tets(graph, 0)) if found else None
        for number, coefficients in enumerate(found):
            self._engine.set_optical(number, *coefficients, float(eta), elsewhere if number == 0 else None)
        self._material, self._materials = None, {}

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights; to set them, typed ones or texts as --light takes them. Raises InputError."""
        return self._lights

    @lights.setter
    def lights(self, lights: Iterable[Light | str]) -> None:
        wanted = tuple(map(as_light, lights))
        self._engine.set_lights([light.text for light in wanted])
        self._lights = wanted

    def set_deformation(self, steps: Sequence[Deformer | Mapping[str, Any]]) -> None:
        """Move the body by these steps from where it lies in the file; [] puts it back exactly.

        Material and what the body sees of itself follow. Raises InputError, and moves nothing.
        """
        self._engine.set_deformation([as_dict(step) for step in steps])
        self._solution = None

    @property
    def placements(self) -> dict[str, dict[str, tuple[float, float, float]]]:
        """Where `place_body` has put bodies, by their names: "position", mm, and "rotation", degrees."""
        return {name: dict(pose) for name, pose in self._placements.items()}

    def place_body(
        self,
        name: str,
        *,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Put one of `bodies` elsewhere: turned about the middle of its box, degrees about the axes x, y and z in this
        order, then moved, mm, from where it lies in the file; without either it lies there again.

        A deformation comes after it. Those within a body go with it, and by themselves nowhere (`hosts`). Shadows, what
        bodies see of each other and the light between them follow at the next solve, which says where bodies overlap.
        Raises InputError, and moves nothing.
        """
        pose = {"position": triple("position", position), "rotation": triple("rotation", rotation)}
        wanted = {**self._placements, name: pose}
        self._engine.set_placements(json.dumps({"placements": wanted}))
        self._placements, self._solution = wanted, None

    def set_edits(self, edits: Sequence[Mapping[str, Any]]) -> None:
        """Change the material in places, by edits or layers of them (docs/scene.md, "Edits"). Raises InputError."""
        core.set_edits(self._engine, json.dumps({"edits": [plain_members(edit) for edit in edits]}))

    def set_normal_map(self, normal_map: Mapping[str, Any] | None) -> None:
        """Let light enter by a normal map of a scene; None: by the file's own. Raises InputError."""
        picture = {} if normal_map is None else {"normal_map": plain_members(normal_map)}
        core.set_normal_map(self._engine, json.dumps({"picture": picture}))

    def set_light_roughness(self, alpha: float | None) -> None:
        """Let light in and out by a GGX alpha, 0 at first; None: the material's, as scenes. Raises InputError."""
        self._engine.set_light_roughness(alpha)

    def set_cuts(self, cuts: Sequence[Mapping[str, Any]]) -> None:
        """Cut pieces away, with shortest-path alone (docs/shortest-path.md, "Cuts"). Raises InputError."""
        self._engine.set_cuts(json.dumps([plain_members(cut) for cut in cuts]))

    def solve(self, *, motion: bool = False, **options: Unpack[MotionOptions]) -> Solution:
        """Solve for the present material, lights and shape.

        options: of `SolveOptions`, and of `MotionOptions`, by default those of a scene; motion: with less work, as the
        window does while something changes (docs/window.md). Raises InputError, SolverError, and TypeError for a motion
        option of another type.
        """
        given = plain_members(options)
        given.setdefault("correction", _usual_correction())
        core.check_scene(json.dumps({"solver": {name: given[name] for name in given.keys() - MOTION}}))
        path = {f"path_{name}": value for name, value in given.pop("path", {}).items()}
        return self._take(self._engine.solve(motion=motion, **given, **path))

    def _take(self, report: dict[str, Any]) -> Solution:
        self._solution = Solution.from_report(report)
        return self._solution

    @property
    def solution(self) -> Solution | None:
        """What the last solve did; None before one, and after the body was moved."""
        return self._solution

    def surface(self) -> SurfaceField:
        """Return the last solution on the surface. Raises InputError before a solve, and after shortest-path."""
        return SurfaceField(**self._engine.surface_field())

    def walked_exitance(self) -> WalkedExitance:
        """Return what the random walks found that certified the last solve. Raises InputError where none did."""
        return WalkedExitance(*core.walked_exitance(self._engine))

    def fluence(self) -> Fluence:
        """Return the last solution in the body, at the unknowns of its method.

        Raises InputError before a solve, after shortest-path, and where an error was met on a coarser level.
        """
        return Fluence(*core.fluence(self._engine, self._solved_inside()))

    def fluence_at(self, points: npt.ArrayLike) -> Floats:
        """Return the fluence of scattered light, W/mm^2, at points (..., 3), mm, of the shape as it is shown: (..., 3).

        Linear between the vertices of tets with fem and polygrids, one value a tet with quadgraph-fv and
        quadgraph-fdm; NaN outside the body. Raises InputError as `fluence`, and for points of another shape.
        """
        method, places = self._solved_inside(), as_points(points)
        return core.fluence_at(self._engine, method, places.reshape(-1, 3)).reshape(places.shape)

    def to_meshio(self, part: Part = "body") -> meshio.Mesh:
        """Return the last solution on the mesh of the shape as it is shown, mm, as meshio has it; it writes .vtu files.

        part: "body", the tets, with `fluence` of scattered light, W/mm^2, in cells (the mean of each) and at points (a
        method with one value a tet: the mean of the tets around, weighted by their volumes), and `sigma_s_prime` and
        `sigma_a`, 1/mm, in cells, as the solve had them; or "surface", the outside triangles, with `q`, `phi`,
        `exitance` and `unscattered` of `SurfaceField` in cells. All are (n, 3), red, green, blue. Raises InputError as
        `fluence`, for another part, and without the package: pip install 'quadgraph[meshio]'.
        """
        return self._fields(part).to_meshio()

    @overload
    def to_pyvista(self, part: Literal["body"] = "body") -> pyvista.UnstructuredGrid: ...
    @overload
    def to_pyvista(self, part: Literal["surface"]) -> pyvista.PolyData: ...

    def to_pyvista(self, part: Part = "body") -> pyvista.UnstructuredGrid | pyvista.PolyData:
        """Return what `to_meshio` does as PyVista, and so VTK, has it: an unstructured grid of tets, or for "surface" a
        mesh of triangles.

        Raises InputError as `to_meshio`; the package is had by pip install 'quadgraph[pyvista]'.
        """
        return self._fields(part).to_pyvista()

    def _fields(self, part: Part) -> MeshFields:
        """Mesh and fields of a part. Raises InputError."""
        if not isinstance(part, str) or part not in get_args(Part):
            found = repr(part) if isinstance(part, str) else type(part).__name__
            raise InputError(f"part: {found} found, {' or '.join(map(repr, get_args(Part)))} allowed")
        level = self._engine.graph.levels[0]
        if part == "surface":
            surface = self.surface()
            return of_surface(core.solved_tets(self._engine)[0], np.array(level.faces), surface)
        fluence = self.fluence()
        vertices, scattering, absorption = core.solved_tets(self._engine)
        return of_body(vertices, np.array(level.tets), fluence.values, scattering, absorption)

    def forward_model(
        self,
        *,
        level: int = 0,
        sigma_s_prime: npt.ArrayLike | None = None,
        sigma_a: npt.ArrayLike | None = None,
        power: npt.ArrayLike | None = None,
        views: Views | None = None,
        model: Literal["sp3", "diffusion"] = "sp3",
        bounces: bool | None = None,
        tolerance: float = 1e-10,
    ) -> ForwardModel:
        """Return the light that leaves as a function of coefficients and powers, with exact derivatives.

        Solved anew on one level of the body at rest, for the light of the last solve. sigma_s_prime, sigma_a: (n_t, 3)
        1/mm, in place of those of the last solve; power: (beams, 3), factors of the beams that its light is made of, in
        the order of the lights, 1 by default; bounces: with light that leaves one part and enters another, which one
        level of a file knows; by default on that level; tolerance: of solves and bounces. Raises InputError before a
        solve, for a deformed or coated body, for bodies of different indices of refraction, for bounces on another
        level, for a ray that starts at no open face or goes into the body, and for other shapes and values;
        SolverError where a solve does not end.
        """
        parameters = (sigma_s_prime, sigma_a, power)
        return forward_model(self._engine, level, parameters, views, model, bounces, tolerance)

    def _solved_inside(self) -> str:
        """The method of the last solve, if it left fluence in the tets. Raises InputError."""
        if self._solution is None:
            raise InputError("fluence: nothing was solved since the body was loaded or moved")
        if self._solution.path is not None:
            raise InputError("fluence: the method shortest-path has none in the body")
        if self._solution.finest > 0:
            raise InputError("fluence: with an error as target the finest level was not solved")
        return self._solution.method

    def render(self, camera: Camera | str | None = None, **picture: Unpack[PictureOptions]) -> Picture:
        """Return a picture of the last solve.

        camera: None for the front, or a text azimuth,elevation[,distance] in degrees and mm. With `converge` it is the
        mean of more solves, until that error is reached or cannot be (`Picture.convergence`), and `solution` is the
        last of them. Raises InputError before a solve, for an option that is not allowed, and for `converge` where the
        error of the picture is not known.
        """
        return self._render({} if camera is None or isinstance(camera, str) else camera, picture, camera)

    def _render(self, camera: Mapping[str, Any], picture: Mapping[str, Any], text: object) -> Picture:
        options, around = plain_members(picture), plain_members(camera)
        members = json.dumps({"camera": around, "picture": options})
        layers = core.render(self._engine, members, text if isinstance(text, str) else "")
        if layers.convergence:
            self._take(layers.convergence["solve"])
        return Picture(layers, self._engine.metadata, options)

    def body_at(
        self, x: float, y: float, camera: Camera | str | None = None, **picture: Unpack[PictureOptions]
    ) -> str | None:
        """Return the name of the body that such a picture, as `render` takes it, shows at (x, y), pixels right and down
        from its corner: one of `bodies`, "" of a file of one body, None beside them. Raises InputError.
        """
        around = {} if camera is None or isinstance(camera, str) else plain_members(camera)
        members = json.dumps({"camera": around, "picture": plain_members(picture)})
        return core.body_at(self._engine, float(x), float(y), members, camera if isinstance(camera, str) else "")

    @property
    def box(self) -> tuple[Floats, Floats]:
        """The lowest and the highest corner, (3,) mm each, of the box around the body at rest."""
        vertices = self._engine.graph.display["vertices"]
        return vertices.min(axis=0), vertices.max(axis=0)

    @property
    def device(self) -> str:
        """The device's name and its driver's."""
        return f"{self._engine.device_name}, {self._engine.driver}"

    @property
    def device_bytes(self) -> int:
        """Memory that is taken on the device, bytes."""
        return self._engine.device_bytes

    @property
    def times_ms(self) -> dict[str, float]:
        """Milliseconds on the device of the passes of the last motion, light, solve and picture, by name."""
        times: dict[str, float] = {}
        for each in self._engine.passes:
            times[each["name"]] = times.get(each["name"], 0.0) + each["time_ms"]
        return times


def _material_text(material: Material | str) -> str:
    return material.text if isinstance(material, Material) else material


@cache
def _usual_correction() -> bool:
    """Whether solves of a scene are corrected where it does not say."""
    return bool(next(option.default for option in core.scene_options() if option.name == "correction"))
