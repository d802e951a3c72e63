"""Files that the engine reads and writes beside: .qgraph, .qshapes, volumes, films."""
