"""MIMo and BabyBench: their models read into specs, and MIMo's environments on mimoc's runtime."""
