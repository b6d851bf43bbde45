"""Other systems' environments, by their names and keywords, on mimoc's runtime."""
