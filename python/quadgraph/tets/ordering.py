"""Cache-local numbering (QuadGraph paper, section 5.1): greedy breadth-first blocks of linked nodes."""

from __future__ import annotations

from collections import deque

import numpy as np

from quadgraph.tets.graph import Graph, first_use

BLOCK = 1024  # r^2 of the paper
WINDOW = 256  # vertices that are sorted by their number of neighbours
_LINE = 16  # 4-byte values in a 64-byte cache line


def breadth_first_blocks(neighbours: np.ndarray, block: int = BLOCK) -> np.ndarray:
    """Order (n,) int64 in which (n, width) `neighbours` are grown into blocks; entries < 0 are no links.

    A block is a breadth-first ball around a seed. The next seed is the oldest node that was seen but not yet taken,
    so that blocks grow beside each other; a new component starts at its lowest index.
    """
    links = neighbours.tolist()
    taken = bytearray(len(links))
    order: list[int] = []
    seen: deque[int] = deque()
    lowest = 0
    while len(order) < len(links):
        room = min(block, len(links) - len(order))
        while room:
            while seen and taken[seen[0]]:
                seen.popleft()
            if not seen:
                while taken[lowest]:
                    lowest += 1
                seen.append(lowest)
            room = _grow(seen, links, taken, order, room)
    return np.array(order, np.int64)


def _grow(seen: deque[int], links: list[list[int]], taken: bytearray, order: list[int], room: int) -> int:
    """Fill one block from the oldest seen node; what its last ring has seen becomes the seeds to come."""
    queue = deque([seen.popleft()])
    taken[queue[0]] = 1
    order.append(queue[0])
    room -= 1
    while queue and room:
        for other in links[queue[0]]:
            if other >= 0 and not taken[other] and room:
                taken[other] = 1
                order.append(other)
                queue.append(other)
                room -= 1
        if room:
            queue.popleft()
    for node in queue:
        seen.extend(other for other in links[node] if other >= 0 and not taken[other])
    return room


def face_neighbours(faces: np.ndarray) -> np.ndarray:
    """(n_f, 3) face across each edge of a closed manifold surface (n_f, 3)."""
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    order = np.lexsort((ends.max(axis=1), ends.min(axis=1))).reshape(-1, 2)
    across = np.empty(len(ends), np.int64)
    across[order[:, 0]], across[order[:, 1]] = order[:, 1] // 3, order[:, 0] // 3
    return across.reshape(-1, 3)


def in_blocks(graph: Graph) -> Graph:
    """Renumber: tets and faces in breadth-first blocks of their own links, vertices by first use and `by_degree`."""
    inner_links = np.where(graph.links < len(graph.tets), graph.links, -1)
    blocks = renumbered(graph, breadth_first_blocks(inner_links), breadth_first_blocks(face_neighbours(graph.faces)))
    return with_vertices(blocks, by_degree(blocks))


def by_degree(graph: Graph, window: int = WINDOW) -> np.ndarray:
    """Order (n_v,) int64 of the vertices in which those with most neighbours come first in every window.

    Rows of linear elements are padded to the longest of 32 neighbouring ones (shaders/solver/solve_shared.h): in the
    order of first use that adds a third, sorted in windows a twentieth. Surface vertices stay first.
    """
    vertex = np.arange(len(graph.vertices))
    on_surface = vertex < graph.surface_vertex_count
    return np.lexsort((vertex, -degrees(graph), vertex // window, ~on_surface))


def degrees(graph: Graph) -> np.ndarray:
    """(n_v,) number of vertices that share an edge with each."""
    count = len(graph.vertices)
    first, second = np.triu_indices(4, 1)
    edges = np.sort(graph.tets.astype(np.int64)[:, np.stack([first, second], axis=1)].reshape(-1, 2), axis=1)
    edges = np.unique(edges[:, 0] * count + edges[:, 1])
    return np.bincount(edges // count, minlength=count) + np.bincount(edges % count, minlength=count)


def at_random(graph: Graph, seed: int = 0) -> Graph:
    """Renumber at random, the baseline that `in_blocks` is measured against; surface vertices still come first."""
    generator = np.random.default_rng(seed)
    shuffled = renumbered(graph, generator.permutation(len(graph.tets)), generator.permutation(len(graph.faces)))
    on_surface, total = shuffled.surface_vertex_count, len(shuffled.vertices)
    order = np.concatenate([generator.permutation(on_surface), on_surface + generator.permutation(total - on_surface)])
    return with_vertices(shuffled, order)


def with_vertices(graph: Graph, order: np.ndarray) -> Graph:
    """Put vertex order[i] at place i; `order` keeps those on the surface first."""
    number = np.argsort(order)
    return Graph(
        graph.vertices[order],
        number[graph.tets],
        number[graph.faces],
        graph.face_tets,
        graph.links,
        graph.inner,
        graph.surface,
        graph.face_kinds,
        _grid_links(graph, number),
        graph.regions,
    )


def _grid_links(graph: Graph, number: np.ndarray) -> np.ndarray | None:
    """Links of a polygrid where vertex i becomes number[i]."""
    if graph.grid_links is None:
        return None
    first = graph.surface_vertex_count
    links = np.empty_like(graph.grid_links)
    links[number[first:] - first] = number[graph.grid_links]
    return links


def renumbered(graph: Graph, tet_order: np.ndarray, face_order: np.ndarray) -> Graph:
    """Put tet tet_order[i] and face face_order[i] at place i; vertices by first use, those of faces first."""
    n_t = len(graph.tets)
    tet_number, face_number = np.argsort(tet_order), np.argsort(face_order)
    number = np.concatenate([tet_number, n_t + face_number])
    tets, faces = graph.tets[tet_order], graph.faces[face_order]
    all_vertices = np.arange(len(graph.vertices))
    vertices, (tets, faces, vertex_number) = first_use(graph.vertices, faces, tets, faces, all_vertices)
    return Graph(
        vertices,
        tets,
        faces,
        tet_number[graph.face_tets[face_order]],
        number[graph.links[tet_order]],
        graph.inner[tet_order],
        graph.surface[face_order],
        None if graph.face_kinds is None else graph.face_kinds[face_order],
        _grid_links(graph, vertex_number),
        None if graph.regions is None else graph.regions[tet_order],
    )


def inner_locality(graph: Graph) -> dict[str, float]:
    """`locality` of the links between inner nodes."""
    inside = graph.links < len(graph.tets)
    return locality(np.where(inside, graph.links, np.arange(len(graph.tets))[:, None]))


def locality(links: np.ndarray, block: int = BLOCK) -> dict[str, float]:
    """How near linked numbers are: mean |i - j|, and 64-byte lines of a float array that `block` rows touch.

    links: (n, width) indices of rows; returns {"mean_distance", "lines_per_block"}, the latter with the rows' own
    lines, on average over the blocks. A row's own index stands for no link.
    """
    rows = np.arange(len(links))[:, None]
    lines = np.concatenate([rows, links], axis=1) // _LINE
    pairs = np.unique((rows // block) * (lines.max() + 1) + lines)
    blocks = -(-len(links) // block)
    distance = np.abs(rows - links)
    return {"mean_distance": float(distance[distance > 0].mean()), "lines_per_block": len(pairs) / blocks}
