"""The subcommands of `quadgraph` that the validation brings along."""
