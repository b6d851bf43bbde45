"""A plug-in for mimoc: a sense, a task, a source of toys and a policy."""
