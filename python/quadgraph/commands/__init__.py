"""The subcommands of `quadgraph`."""
