"""The page of an infant: one HTML file that shows it in any browser, without a server and without a network."""
