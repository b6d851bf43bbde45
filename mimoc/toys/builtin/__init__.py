"""The toys that come with mimoc."""
