"""The components that come with mimoc, by name: a table for each kind, open to plug-ins."""
